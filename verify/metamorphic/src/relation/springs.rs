//! Springs on the surface, from ones that hardly hold a body to ones that hold it fast.

use super::subject::{Compared, Relation, Subject, with_nodes};
use crate::answer::{Answer, relative, steady};
use crate::build;
use crate::scene::{Bed, Hold, Law, Part, Place, Push, Scene};
use mtled::motion::step::{add_following, external_force};
use mtled::{Discretisation, Error, MassKind, Model, NaturalModes, body_at_rest};
use std::f64::consts::TAU;

/// Stiffness times size over that of the body, of springs that hold nearly fast. Far stiffer ones
/// hold the field at more points than there are nodes, and with it the nodes behind \[–\].
const STIFF: f64 = 300.0;
/// Spacings along the longest edge up to which two discretisations of a held surface are too far
/// apart to be compared.
const COARSE: u32 = 3;
/// Of springs on which the body swings as if it were rigid \[–\].
const SOFT: f64 = 1e-9;

pub(crate) const RELATIONS: &[Relation] = &[
    Relation {
        name: "springs_that_hold",
        claim: "Springs 300 times as stiff as the body hold a surface nearly as a condition does",
        bound: 0.3,
        reason: "A part of 1/300 of the displacement is left, ten times that in bending; springs act at \
                 points of panels and conditions at nodes, another discretisation of the same order; at \
                 three spacings the two differed by 0.37 with a quadratic basis",
        compare: |subject| {
            // Where a part ends within a face, it ends at a node or at its outline.
            let flat = |hold: &Hold| matches!(hold.part, Part::End { depth, .. } if depth < 1e-3);
            let is_resolved = subject.scene.spacings > COARSE;
            if !is_resolved || !subject.scene.holds.first().is_some_and(flat) {
                return None;
            }
            let held = subject.given()?;
            let problem = build::problem(&on_springs(&subject.scene, STIFF)?).ok()?;
            let problem = with_nodes(problem, held.positions().to_vec());
            let by_springs = steady(problem)?;
            let u = [held, &by_springs].map(Answer::displacements);
            Some(Compared::Difference(relative(&u[0], &u[1], 0.0)))
        },
    },
    Relation {
        name: "ever_softer_springs",
        claim: "The softer the springs, the more work do loads on a body of the linear law, and by ever less",
        bound: 1e-6,
        reason: "The work is a growing, concave function of the inverse of the stiffness, whatever the \
                 discretisation; Newton's method ends at 1e-12 of the largest force, times a condition \
                 of up to 1e5",
        compare: softer,
    },
    Relation {
        name: "frequency_on_springs",
        claim: "The lowest vibration of a free body on soft springs has the stiffness of the springs and no other",
        bound: 1e-3,
        reason: "The body's own frequencies are 1e4 times as high, so that it moves as if it were rigid and strains \
                 have 1e-8 of the energy; frequencies are found to 1e-6",
        compare: |subject| swings(&subject.scene),
    },
];

/// The scene with springs instead of its first condition, where that is to stay at rest.
fn on_springs(scene: &Scene, stiffness: f64) -> Option<Scene> {
    let mut scene = scene.clone();
    let first = *scene.holds.first()?;
    let whole = !first.inner && first.to == Place::Still;
    let alone = scene.bed.is_none() && scene.obstacle.is_none() && scene.memory.is_none();
    if !scene.is_static() || !whole || !alone || matches!(first.part, Part::Spot { .. }) {
        return None;
    }
    scene.holds.remove(0);
    scene.bed = Some(Bed { part: first.part, normal: stiffness, tangential: stiffness });
    Some(scene)
}

/// By how much the work of loads on springs of a tenth, a fifth and a third of the stiffness falls, or
/// grows faster than in a line, over the largest of it.
fn softer(subject: &Subject) -> Option<Compared> {
    let scene = Scene { law: Law::Linear, filling: None, tension: None, ..subject.scene.clone() };
    let follows = |push: &Push| matches!(push, Push::Pressure(..));
    let moved = |hold: &Hold| !matches!(hold.to, Place::Still | Place::Roller(_));
    if scene.pushes.iter().any(follows) || scene.holds.iter().any(moved) {
        return None;
    }
    let work = |inverse: f64| {
        let answer = steady(build::problem(&on_springs(&scene, 1.0 / inverse)?).ok()?)?;
        let (model, end) = (&answer.simulation.model, answer.problem.motion.end());
        let mut force = vec![0.0; model.size()];
        external_force(model, end, &mut force);
        let parts = force.iter().zip(&answer.simulation.state.displacement);
        Some(parts.map(|(f, u)| f * u).sum::<f64>())
    };
    let (stiff, middle, soft) = (work(0.1)?, work(0.2)?, work(0.3)?);
    let falls = f64::max(stiff - middle, middle - soft);
    let faster = 0.5 * (stiff + soft) - middle;
    (soft > 0.0).then(|| Compared::Difference(falls.max(faster).max(0.0) / soft))
}

/// The square of the lowest frequency of the body on soft springs, against their stiffness in that
/// motion.
fn swings(scene: &Scene) -> Option<Compared> {
    let part = scene.bed.map_or(Part::Whole, |bed| bed.part);
    let on_springs = Scene {
        holds: Vec::new(),
        bed: Some(Bed { part, normal: 2.0 * SOFT, tangential: SOFT }),
        filling: None,
        tension: None,
        ..scene.clone()
    };
    let problem = body_at_rest(&build::problem(&on_springs).ok()?);
    let discretisation = Discretisation::new(&problem).ok()?;
    let model = match Model::new(&problem, &discretisation) {
        Ok(model) => model,
        Err(error) => return Some(without_modes(scene, error)),
    };
    let asked = (1, MassKind::Lumped);
    let found = NaturalModes::find(&problem, &discretisation, &model, asked, &mut |_| true);
    let found = match found {
        Ok(found) => found,
        Err(error) => return Some(without_modes(scene, error)),
    };
    // φᵀ M φ is 1.
    let mode = found.modes.first()?;
    let mut force = vec![0.0; model.size()];
    add_following(&model, 0.0, &mode.motion, &mut force);
    let stiffness: f64 = mode.motion.iter().zip(&force).map(|(u, f)| -u * f).sum();
    let square = (TAU * mode.frequency).powi(2);
    Some(Compared::Difference((square / stiffness - 1.0).abs()))
}

/// Newton's method solves a scene whose lumped masses are not all positive.
fn without_modes(scene: &Scene, error: Error) -> Compared {
    match error {
        Error::MasslessNode { .. } if scene.is_static() => Compared::Undecided(error.to_string()),
        error => Compared::Refused(error.to_string()),
    }
}
