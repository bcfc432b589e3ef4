//! Fluids in holes, and half of a hole.
#![allow(non_snake_case)]

use super::subject::{Compared, Relation, Subject};
use crate::answer::{Answer, View, answer, difference, steady};
use crate::build::{self, Frame};
use crate::scene::{Filling, Form, Scene};
use mtled::geometry::{Selector, Shape};
use mtled::problem::{Cavity, Pressure, Problem};
use mtled::{Discretisation, Model, Vector3};

pub(crate) const RELATIONS: &[Relation] = &[
    Relation {
        name: "pressure_of_a_fluid",
        claim: "The pressure that a fluid finds, stated as a load on the same walls, moves the body alike",
        bound: 1e-6,
        reason: "The equations are the same; Newton's method ends at 1e-12 of the largest force, times a \
                 condition of up to 1e5",
        compare: as_pressure,
    },
    Relation {
        name: "inflow_that_is_taken",
        claim: "A hole takes in what a fluid that hardly yields is given",
        bound: 1e-6,
        reason: "p = κ (V₀ + inflow − V)/V₀ with κ of 1e9 times the stiffness, and a p of no more than \
                 that stiffness",
        compare: taken,
    },
    Relation {
        name: "half_of_a_hole",
        claim: "Half of a body, cut through its hole, has half of the hole's volume",
        bound: 1e-6,
        reason: "The walls of a box are the union of their panels, whatever the cloud; areas are closed \
                 to 1e-11",
        compare: half,
    },
];

/// The scene with a hole and a fluid in it, where the end alone decides.
fn filled(scene: &Scene, filling: Filling) -> Option<Scene> {
    let fit = matches!(scene.form, Form::Box | Form::Hollow | Form::Chamber)
        && scene.is_static()
        && !scene.depends_on_way();
    fit.then(|| hollow(&Scene { filling: Some(filling), ..scene.clone() }))
}

/// With a hole, if it has none, whose walls are as thick as a spacing and more.
fn hollow(scene: &Scene) -> Scene {
    let form = if scene.form == Form::Box { Form::Hollow } else { scene.form };
    let least = if scene.components() == 2 { 8 } else { 5 };
    let edges = scene.edges.map(|edge| edge.max(0.8));
    Scene { form, edges, spacings: scene.spacings.max(least), ..scene.clone() }
}

fn as_pressure(subject: &Subject) -> Option<Compared> {
    let filling = Filling { bulk_modulus: 10.0, inflow: 0.1 };
    let filled = filled(&subject.scene, subject.scene.filling.unwrap_or(filling))?;
    let first = steady(build::problem(&filled).ok()?)?;
    let pressure = state(&first).1;
    let mut other = first.problem.clone();
    let cavity = other.loads.cavities.first_mut()?;
    let fluid = cavity.fluid.take()?;
    let part = cavity.part.clone();
    let (name, amplitude) = ("as the fluid".into(), fluid.amplitude);
    other.loads.pressures.push(Pressure { name, part, pressure, amplitude });
    Some(match answer(other) {
        Err(error) => Compared::Refused(error.to_string()),
        Ok(other) if other.is_doubtful() => Compared::Undecided("unstable under a pressure".into()),
        Ok(other) => Compared::Difference(difference(&first, &other, &View::default())),
    })
}

/// Volume \[m³\] and pressure \[Pa\] of the hole at the end.
fn state(answer: &Answer) -> (f64, f64) {
    let model = &answer.simulation.model;
    let u = &answer.simulation.state.displacement;
    let state = model.following.cavities[0].state(answer.problem.motion.end(), u, model.components);
    (state.volume, state.pressure)
}

fn taken(subject: &Subject) -> Option<Compared> {
    let filled = filled(&subject.scene, Filling { bulk_modulus: 1e9, inflow: 0.05 })?;
    let answer = steady(build::problem(&filled).ok()?)?;
    let before = answer.simulation.model.following.cavities[0].volume_at_rest();
    let given = answer.problem.loads.cavities[0].fluid.as_ref()?.inflow;
    Some(Compared::Difference((state(&answer).0 - before - given).abs() / before))
}

/// Twice the volume of the hole in the lower half along x, against that in the whole.
fn half(subject: &Subject) -> Option<Compared> {
    let scene = hollow(&Scene { form: Form::Chamber, ..subject.scene.clone() });
    let fit = matches!(subject.scene.form, Form::Box | Form::Hollow | Form::Chamber);
    let bare = Scene { holds: Vec::new(), pushes: Vec::new(), bed: None, obstacle: None, ..scene };
    let mut problem = build::problem(&Scene { filling: None, ..bare.clone() }).ok()?;
    let whole = volume_at_rest(&problem)?;
    let frame = Frame::home(&bare);
    let middle = frame.point(&frame.middle());
    let beyond = Shape::HalfSpace { point: middle, normal: -Vector3::x() };
    let cut = Selector::Inside { shape: beyond.clone(), tolerance: frame.tolerance };
    problem.body = Shape::Difference(Box::new(problem.body), Box::new(beyond));
    let cavity: &mut Cavity = problem.loads.cavities.first_mut()?;
    cavity.opening = Some(middle);
    let not = Selector::Not(Box::new(cut));
    cavity.part = Selector::Intersection(vec![cavity.part.clone(), not]);
    fit.then(|| {
        Some(match volume_at_rest(&problem) {
            Some(half) => Compared::Difference((2.0 * half / whole - 1.0).abs()),
            None => Compared::Refused("half of the hole is none".into()),
        })
    })?
}

/// Volume of the hole \[m³\].
fn volume_at_rest(problem: &Problem) -> Option<f64> {
    let discretisation = Discretisation::new(problem).ok()?;
    let model = Model::new(problem, &discretisation).ok()?;
    Some(model.following.cavities.first()?.volume_at_rest())
}
