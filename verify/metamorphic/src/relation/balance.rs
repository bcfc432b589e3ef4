//! What was asked and what was done: forces, moments, prescribed values, volume; and what free
//! motion conserves.
#![allow(non_snake_case)]

use super::subject::{Compared, Relation, Subject};
use crate::answer::{finished, force_scale, relative, sum};
use crate::build;
use crate::scene::{Form, Gradients, Law, Part, Push, Scene, Way};
use mtled::Vector3;
use mtled::algebra::tensor::vector_at;
use mtled::motion::energy::Energies;
use mtled::motion::observe;
use mtled::motion::step::{add_following, external_force};
use mtled::problem::{self, Problem};
use mtled::{Continue, Observer, Simulation};

pub(crate) const RELATIONS: &[Relation] = &[
    Relation {
        name: "forces_add_up",
        claim: "At rest reactions, loads and contact forces add up to nothing",
        bound: 1e-6,
        reason: "Internal forces sum to zero to round-off; Newton's method ends at 1e-12 of the \
                 largest force at each of some hundred nodes",
        compare: |subject| Some(Compared::Difference(imbalance(subject)?.0)),
    },
    Relation {
        name: "moments_add_up",
        claim: "At rest the moments of reactions, loads and contact forces add up to nothing",
        bound: 1e-6,
        reason: "Internal forces of an objective law have no moment where gradients reproduce \
                 linear fields, to 1e-11; Newton's method ends at 1e-12 of the largest force",
        compare: |subject| {
            let objective = subject.scene.law != Law::Linear;
            objective.then(|| Some(Compared::Difference(imbalance(subject)?.1)))?
        },
    },
    Relation {
        name: "prescribed_values_are_taken",
        claim: "At the end every prescribed node is where its condition says",
        bound: 1e-9,
        reason: "Constraints are solved directly; 1e-16 times a condition of some 1e4",
        compare: prescribed,
    },
    Relation {
        name: "volume_of_the_body",
        claim: "Quadrature weights add up to the volume by formula",
        bound: 0.12,
        reason: "Panels of half a spacing inscribe a curved face to (h/4R)², and radii are three quarters \
                 of a spacing and more; flat faces are exact",
        compare: |subject| {
            let volume = build::closed_form_volume(&subject.scene)?;
            Some(relative_to(subject.base.simulation.discretisation.volume(), volume))
        },
    },
    Relation {
        name: "volume_of_a_flat_body",
        claim: "The same for bodies with flat faces and consistent gradients, of which nothing is held as a \
                volume",
        bound: 1e-4,
        reason: "Weights are scaled to the volume that the points of the boundary enclose; a polygon \
                 or a box is the union of its panels, but on held faces shares of panels stand at \
                 nodes and not at their centroids: 3e-5 were seen with three nodes along an edge",
        compare: |subject| {
            let scene = &subject.scene;
            let flat = matches!(scene.form, Form::Box | Form::Corner | Form::Wedge)
                && scene.gradients != Gradients::Plain
                && subject.base.simulation.discretisation.held.is_none();
            let volume = build::closed_form_volume(&subject.scene)?;
            flat.then(|| relative_to(subject.base.simulation.discretisation.volume(), volume))
        },
    },
    Relation {
        name: "weight_of_the_body",
        claim: "Nodal masses add up to density times the volume of the quadrature",
        bound: 1e-9,
        reason: "Shape functions sum to one at every point",
        compare: |subject| {
            let simulation = &subject.base.simulation;
            let mass: f64 = simulation.model.lumped_mass.iter().sum();
            Some(relative_to(mass, subject.scene.density * simulation.discretisation.volume()))
        },
    },
    Relation {
        name: "traction_on_a_face",
        claim: "A traction on a whole face has its area times the stress as its resultant",
        bound: 1e-6,
        reason: "The panels of a box are its faces, and shape functions sum to one",
        compare: traction,
    },
    Relation {
        name: "momentum",
        claim: "A free body keeps its momentum",
        bound: 1e-9,
        reason: "Internal forces sum to zero to round-off in each of some thousand steps",
        compare: |subject| Some(Compared::Difference(free_motion(subject)?.momentum)),
    },
    Relation {
        name: "angular_momentum",
        claim: "A free body of an objective law keeps its angular momentum",
        bound: 1e-7,
        reason: "Central differences keep it exactly; gradients reproduce linear fields to 1e-11 \
                 in each of some thousand steps",
        compare: |subject| {
            let objective = subject.scene.law != Law::Linear;
            objective.then(|| Some(Compared::Difference(free_motion(subject)?.angular)))?
        },
    },
    Relation {
        name: "energy",
        claim: "A free, undamped body keeps its energy",
        bound: 0.08,
        reason: "Central differences keep another energy, which differs by up to (ω Δt)²/2 of that of \
                 each mode: 0.08 of that of the fastest at a fifth of the critical step",
        compare: |subject| {
            // Of the energy at the start, which that of active fibres is no part of.
            let passive = subject.scene.tension.is_none();
            passive.then(|| Some(Compared::Difference(free_motion(subject)?.energy)))?
        },
    },
];

fn relative_to(value: f64, exact: f64) -> Compared {
    Compared::Difference((value - exact).abs() / exact.abs())
}

/// Unbalanced force and moment over the largest force and its moment over the body \[–\].
fn imbalance(subject: &Subject) -> Option<(f64, f64)> {
    let (scene, answer) = (&subject.scene, &subject.base);
    if !scene.is_static() {
        return None;
    }
    let model = &answer.simulation.model;
    let about = model.positions[0];
    let mut total = sum(&answer.reactions(&about));
    let u = answer.displacements();
    let d = model.components;
    let mut add = |place: &Vector3, force: &Vector3| {
        total.force += force;
        total.moment += (place - about).cross(force);
    };
    // Of loads, springs and fluids.
    let (end, mut outer) = (answer.problem.motion.end(), vec![0.0; model.size()]);
    external_force(model, end, &mut outer);
    add_following(model, end, &answer.simulation.state.displacement, &mut outer);
    for (node, X) in model.positions.iter().enumerate() {
        add(&(X + u[node]), &vector_at(&outer, node, d));
    }
    let contacts = answer.simulation.state.contact_forces();
    let touching: Vec<Vector3> =
        contacts.iter().map(|contact| model.positions[contact.node as usize]).collect();
    let moved = answer.simulation.displacements_at(&touching).ok()?;
    for ((contact, X), u) in contacts.iter().zip(&touching).zip(moved) {
        add(&(X + u), &contact.force);
    }
    let scale = force_scale(answer);
    Some((total.force.norm() / scale, total.moment.norm() / (scale * model.extent)))
}

/// Largest distance of a held node from where it is prescribed, over the largest displacement.
fn prescribed(subject: &Subject) -> Option<Compared> {
    let answer = &subject.base;
    let model = &answer.simulation.model;
    let end = answer.simulation.state.time.max(answer.problem.motion.end());
    // In a motion conditions are met at the time of the state.
    let time = if subject.scene.is_static() { end } else { answer.simulation.state.time };
    let rows = model.constraints.prescribed_nodes(time, model.components, &model.positions);
    if rows.is_empty() || subject.scene.has_releases() {
        return None;
    }
    let places: Vec<Vector3> = rows.iter().map(|row| model.positions[row.0 as usize]).collect();
    let field = if subject.scene.direct {
        rows.iter().map(|row| answer.displacements()[row.0 as usize]).collect()
    } else {
        answer.simulation.displacements_at(&places).ok()?
    };
    let asked: Vec<Vector3> = rows.iter().map(|row| row.1).collect();
    let floor = answer.largest();
    Some(Compared::Difference(relative(&asked, &field, floor)))
}

/// A traction on an end of the box, its part wider than the face.
fn traction(subject: &Subject) -> Option<Compared> {
    let scene = &subject.scene;
    if scene.form != Form::Box || scene.components() == 2 {
        return None;
    }
    let part = Part::End { axis: 0, upper: true, depth: 1e-8 };
    let stress = [0.01, 0.02, -0.01];
    let loaded = Scene { pushes: vec![Push::Traction(part, stress)], ..scene.clone() };
    let simulation = Simulation::new(&build::problem(&loaded).ok()?).ok()?;
    let force = &simulation.model.loads.first()?.force;
    let resultant = force.chunks_exact(3).map(Vector3::from_column_slice).sum::<Vector3>();
    let area = scene.edges[1] * scene.edges[2] * scene.size * scene.size;
    let exact = area * scene.young_modulus * Vector3::from(stress);
    Some(Compared::Difference((resultant - exact).norm() / exact.norm()))
}

/// Changes of what a free motion conserves, over its size \[–\].
#[derive(Debug, Clone, Copy)]
struct Conserved {
    momentum: f64,
    angular: f64,
    energy: f64,
}

/// The scene without all that holds and pushes it, its halves thrown in different directions.
fn free_motion(subject: &Subject) -> Option<Conserved> {
    let scene = &subject.scene;
    if scene.is_static() {
        return None;
    }
    let half = Part::End { axis: 1, upper: true, depth: 0.487 };
    let free = Scene {
        way: Way::Motion { end: 1.5, damping: 0.0 },
        obstacle: None,
        holds: Vec::new(),
        bed: None,
        filling: None,
        pushes: vec![
            Push::Throw(half, [0.05, 0.02, 0.0]),
            Push::Throw(Part::Whole, [-0.01, 0.03, 0.0]),
        ],
        ..scene.clone()
    };
    let mut problem: Problem = build::problem(&free).ok()?;
    if let problem::Motion::Dynamic { step, .. } = &mut problem.motion {
        step.safety_factor = SMALL_STEP;
    }
    let simulation = Simulation::new(&problem).ok()?;
    let start = Motion::of(&simulation, 0.0);
    let mut watch = Watch::default();
    let end = finished(problem, simulation, &mut watch).ok()?;
    if end.is_doubtful() {
        return None;
    }
    let after = Motion::of(&end.simulation, 1.0);
    let speed = free.size / free.wave_time();
    let momentum = speed * end.simulation.model.lumped_mass.iter().sum::<f64>() * 0.1;
    let arm = end.simulation.model.extent;
    Some(Conserved {
        momentum: (after.momentum - start.momentum).norm() / momentum,
        angular: (after.angular - start.angular).norm() / (momentum * arm),
        energy: watch.drift(),
    })
}

/// Momentum \[kg m/s\] and angular momentum about the origin \[kg m²/s\].
struct Motion {
    momentum: Vector3,
    angular: Vector3,
}

impl Motion {
    /// With the places at the time of the velocities' `later` end: any time in a step gives the
    /// same angular momentum, but for round-off.
    fn of(simulation: &Simulation, later: f64) -> Motion {
        let (model, state) = (&simulation.model, &simulation.state);
        let d = model.components;
        let mut sum = Motion { momentum: Vector3::zeros(), angular: Vector3::zeros() };
        for (node, X) in model.positions.iter().enumerate() {
            let mass = model.inertia[node];
            let v = Vector3::from_fn(|k, _| if k < d { state.velocity[d * node + k] } else { 0.0 });
            let x = X + later * state.displacement_of(node, d);
            sum.momentum += mass * v;
            sum.angular += mass * x.cross(&v);
        }
        sum
    }
}

/// Step over the critical one \[–\].
const SMALL_STEP: f64 = 0.2;

/// Looks at energies.
#[derive(Debug, Default)]
struct Watch {
    first: Option<Energies>,
    largest: f64,
}

impl Watch {
    /// Largest change of the sum of energies over that at the start \[–\].
    fn drift(&self) -> f64 {
        self.first.map_or(f64::NAN, |first| self.largest / first.balance().abs())
    }
}

impl Observer for Watch {
    fn observe(&mut self, view: &mut observe::View) -> Continue {
        let energies = view.energies();
        let first = *self.first.get_or_insert(energies);
        self.largest = self.largest.max((energies.balance() - first.balance()).abs());
        Continue::Yes
    }

    fn tracks_work(&self) -> bool {
        true
    }
}
