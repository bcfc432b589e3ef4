//! Obstacles that move or rub.
#![allow(non_snake_case)]

use super::subject::{Compared, Relation, Subject, against};
use crate::answer::{View, answer, reaction_difference, relative, steady};
use crate::build;
use crate::scene::{Drift, Place, Rubs, Scene, Wall};
use mtled::Vector3;
use mtled::problem::{Field, Motion, Prescribed, Relaxation};

pub(crate) const RELATIONS: &[Relation] = &[
    Relation {
        name: "obstacle_or_body_that_moves",
        claim: "Whether an obstacle moves against a body or the body against it, the body is pressed alike",
        bound: 1e-6,
        reason: "Contact knows the distance alone; Newton's method ends at 1e-12 of the largest force, times \
                 a condition of up to 1e5",
        compare: moved_instead,
    },
    Relation {
        name: "friction_of_nothing",
        claim: "Friction with a coefficient of 0 is none",
        bound: 1e-9,
        reason: "The same forces; what is subtracted for sliding is 0",
        compare: |subject| rubbed(&subject.scene, Rubs::Free, Rubs::Coulomb(0.0)),
    },
    Relation {
        name: "friction_without_bound",
        claim: "With a coefficient of a million nodes stick",
        bound: 1e-6,
        reason: "No force along the surface is a million times the one that pushes",
        compare: |subject| rubbed(&subject.scene, Rubs::Sticks, Rubs::Coulomb(1e6)),
    },
];

/// A floor, of scenes that have none.
const FLOOR: Wall = Wall { round: false, gap: 0.05, drift: None, rubs: Rubs::Free };

/// The scene with an obstacle that moves without a rotation and without friction, where all that is
/// fixed in space besides are conditions.
fn drifting(scene: &Scene) -> Option<Scene> {
    let wall = scene.obstacle.unwrap_or(FLOOR);
    if !scene.is_static() || scene.bed.is_some() || scene.holds.is_empty() {
        return None;
    }
    let by = wall.drift.unwrap_or_else(|| rises(&wall)).by;
    let drift = Some(Drift { by, turn: 0.0 });
    Some(Scene { obstacle: Some(Wall { drift, rubs: Rubs::Free, ..wall }), ..scene.clone() })
}

/// Upwards until it meets the body, and along it.
fn rises(wall: &Wall) -> Drift {
    Drift { by: [0.03, wall.gap + 0.04, 0.0], turn: 0.0 }
}

fn moved_instead(subject: &Subject) -> Option<Compared> {
    let scene = drifting(&subject.scene)?;
    // A rotation with a shift on top takes another way, which memory knows.
    let turns = scene.holds.iter().any(|hold| matches!(hold.to, Place::Turned(..)));
    if scene.memory.is_some() && turns {
        return None;
    }
    let by = scene.size * Vector3::from(scene.obstacle?.drift?.by);
    let base = steady(build::problem(&scene).ok()?)?;
    let mut other = base.problem.clone();
    other.obstacles.iter_mut().for_each(|obstacle| obstacle.motions.clear());
    for condition in &mut other.conditions {
        condition.prescribed = shifted(condition.prescribed.clone(), -by);
    }
    let moved = match answer(other) {
        Err(error) => return Some(Compared::Refused(error.to_string())),
        Ok(moved) if moved.is_doubtful() => {
            return Some(Compared::Undecided("unstable when moved".into()));
        }
        Ok(moved) => moved,
    };
    let expected: Vec<Vector3> = base.displacements().iter().map(|u| u - by).collect();
    let u = relative(&moved.displacements(), &expected, 0.0);
    let about = [Vector3::zeros(), -by];
    let forces = reaction_difference(&base, &moved, &View { about, ..View::default() });
    Some(Compared::Difference(if u.is_nan() { u } else { u.max(forces) }))
}

/// With a shift on top at amplitude 1 \[m\].
fn shifted(prescribed: Prescribed, by: Vector3) -> Prescribed {
    match prescribed {
        Prescribed::Displacement(values) => {
            Prescribed::Displacement([0, 1, 2].map(|k| values[k].map(|value| value + by[k])))
        }
        Prescribed::Rotation { point, axis, angle } => {
            let turn = mtled::algebra::tensor::rotation(&axis, angle);
            Prescribed::Field(Field::of(move |X: &Vector3| turn * (X - point) + point - X + by))
        }
        Prescribed::Field(field) => {
            Prescribed::Field(Field::of(move |X: &Vector3| field.at(X) + by))
        }
    }
}

/// Most steps of relaxation.
const MOST_STEPS: usize = 20_000;

/// A scene with an obstacle that rubs in one way and in another: in motion, or by relaxation, which
/// follows what rubs.
fn rubbed(scene: &Scene, one: Rubs, other: Rubs) -> Option<Compared> {
    // Relaxation takes a second.
    let wall = scene.obstacle.or_else(|| (!scene.is_static()).then_some(FLOOR))?;
    let drift = Some(wall.drift.unwrap_or_else(|| rises(&wall)));
    let problem = |rubs: Rubs| {
        let obstacle = Some(Wall { rubs, drift, ..wall });
        let scene = Scene { obstacle, memory: None, ..scene.clone() };
        let mut problem = build::problem(&scene).ok()?;
        if scene.is_static() {
            let max_steps = MOST_STEPS;
            problem.motion = Motion::Relaxed(Relaxation { max_steps, ..Relaxation::default() });
        }
        Some(problem)
    };
    let first = steady(problem(one)?)?;
    Some(against(&first, problem(other)?, &View::default()))
}
