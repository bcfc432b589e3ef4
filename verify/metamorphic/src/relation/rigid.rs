//! Rigid motions on top of a solution.
#![allow(non_snake_case)]

use super::subject::{Compared, Relation, Subject};
use crate::answer::{View, answer, reaction_difference, relative};
use crate::scene::{Law, Place, Push};
use mtled::Vector3;
use mtled::algebra::tensor::{Matrix3, rotation};
use mtled::problem::{Field, Prescribed, Problem};

const OBJECTIVE: &str = "Stresses and energies do not know a rigid motion of the body; Newton's method \
                         ends at 1e-12 of the largest force, times a condition of up to 1e5";
/// Rotation \[rad\].
const ANGLE: f64 = 0.6;

pub(crate) const RELATIONS: &[Relation] = &[
    Relation {
        name: "everything_shifted",
        claim: "A translation on top of every prescribed displacement moves the body by it",
        bound: 1e-6,
        reason: OBJECTIVE,
        compare: |subject| on_top(subject, Matrix3::identity(), false),
    },
    Relation {
        name: "shifted_past_an_obstacle",
        claim: "The same beside an obstacle that the body never comes near",
        bound: 1e-6,
        reason: OBJECTIVE,
        compare: |subject| on_top(subject, Matrix3::identity(), true),
    },
    Relation {
        name: "everything_turned",
        claim: "A rotation on top of every prescribed displacement turns the body by it",
        bound: 1e-6,
        reason: OBJECTIVE,
        compare: |subject| {
            let dead = |push: &Push| !matches!(push, Push::Pressure(..));
            let scene = &subject.scene;
            if scene.law == Law::Linear || scene.pushes.iter().any(dead) {
                return None;
            }
            on_top(subject, rotation(&Vector3::z(), ANGLE), false)
        },
    },
];

/// Every condition with x' = R x + s, where all of them prescribe all components.
fn on_top(subject: &Subject, turn: Matrix3, beside_obstacle: bool) -> Option<Compared> {
    let scene = &subject.scene;
    let whole = |to: &Place| !matches!(to, Place::Roller(_));
    let all_whole = scene.holds.iter().all(|hold| whole(&hold.to));
    if !scene.is_static() || scene.obstacle.is_some() || scene.holds.is_empty() || !all_whole {
        return None;
    }
    // Springs are fixed in space, and memory has another history where a rotation grows.
    let turns = scene.holds.iter().any(|hold| matches!(hold.to, Place::Turned(..)));
    let other_way = turns || turn != Matrix3::identity();
    if scene.bed.is_some() || scene.memory.is_some() && other_way {
        return None;
    }
    let size = scene.size;
    let shift = match scene.components() {
        2 => Vector3::new(0.31 * size, 0.17 * size, 0.0),
        _ => Vector3::new(0.31 * size, 0.17 * size, -0.23 * size),
    };
    let mut other = moved_on_top(subject.problem(), turn, shift);
    if beside_obstacle {
        let point = Vector3::new(0.0, -7.0 * size, 0.0);
        let far = mtled::Shape::HalfSpace { point, normal: Vector3::y() };
        other.obstacles.push(crate::build::solid("far", far));
    }
    let moved = match answer(other) {
        Err(error) => return Some(Compared::Refused(error.to_string())),
        Ok(moved) if moved.is_doubtful() => {
            return Some(Compared::Undecided("unstable when moved".into()));
        }
        Ok(moved) => moved,
    };
    let base = &subject.base;
    let expected: Vec<Vector3> = (base.positions().iter().zip(base.displacements()))
        .map(|(X, u)| turn * (X + u) + shift - X)
        .collect();
    let u = relative(&moved.displacements(), &expected, 0.0);
    let about = [Vector3::zeros(), shift];
    let view = View { turn, about, ..View::default() };
    let forces = reaction_difference(base, &moved, &view);
    Some(Compared::Difference(if u.is_nan() { u } else { u.max(forces) }))
}

fn moved_on_top(mut problem: Problem, turn: Matrix3, shift: Vector3) -> Problem {
    for condition in &mut problem.conditions {
        let end = condition.amplitude.at(1.0);
        let field = field_of(&condition.prescribed, end);
        let composed = move |X: &Vector3| turn * (X + field(X)) + shift - X;
        condition.prescribed = Prescribed::Field(Field::of(composed));
    }
    problem
}

type Displacement = Box<dyn Fn(&Vector3) -> Vector3 + Send + Sync>;

/// The displacement at an amplitude \[m\].
fn field_of(prescribed: &Prescribed, amplitude: f64) -> Displacement {
    match prescribed.clone() {
        Prescribed::Displacement(values) => {
            let u = Vector3::from_fn(|k, _| values[k].unwrap_or(0.0));
            Box::new(move |_| amplitude * u)
        }
        Prescribed::Rotation { point, axis, angle } => {
            let turn = rotation(&axis, amplitude * angle) - Matrix3::identity();
            Box::new(move |X| turn * (X - point))
        }
        Prescribed::Field(field) => Box::new(move |X| amplitude * field.at(X)),
    }
}
