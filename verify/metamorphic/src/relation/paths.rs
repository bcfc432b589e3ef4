//! Other ways to the same equilibrium.

use super::subject::{Compared, Relation, Subject};
use crate::answer::View;
use crate::scene::{Place, Scene};
use mtled::problem::{
    Amplitude, EssentialCondition, Motion, Newton, Problem, Relaxation, RelaxationMass,
};

const UNIQUE: &str = "An elastic body that does not buckle has one equilibrium near rest, whatever \
                      the way; Newton's method ends at 1e-12 of the largest force, times a condition \
                      of up to 1e5";
/// Of relaxation \[–\].
const TOLERANCE: f64 = 1e-6;
/// A second of a small body; most need some hundred.
const MOST_STEPS: usize = 20_000;

/// Relaxation that gives up in time.
fn relaxation(mass: RelaxationMass) -> Relaxation {
    Relaxation { tolerance: TOLERANCE, max_steps: MOST_STEPS, mass, ..Relaxation::default() }
}

pub const RELATIONS: &[Relation] = &[
    Relation {
        name: "newton_against_relaxation",
        claim: "Newton's method and relaxation end at the same place",
        bound: 1e-4,
        reason: "Relaxation ends at an estimated 1e-6 of the largest displacement; forces are a \
                 hundred times as sensitive as the displacement",
        compare: |subject| {
            is_smooth(&subject.scene)
                .then(|| relaxed(subject, Motion::Relaxed(relaxation(RelaxationMass::Stiffness))))?
        },
    },
    Relation {
        name: "relaxation_with_other_masses",
        claim: "Relaxation with the masses of the body ends where Newton's method does",
        bound: 1e-4,
        reason: "As before; masses do not act at rest",
        compare: |subject| {
            is_smooth(&subject.scene)
                .then(|| relaxed(subject, Motion::Relaxed(relaxation(RelaxationMass::Lumped))))?
        },
    },
    Relation {
        name: "chosen_by_itself",
        claim: "The method that the program chooses ends where Newton's method does",
        bound: 1e-4,
        reason: "It is Newton's method to 0.01 of the tolerance, 1e-6, or relaxation to it",
        compare: |subject| {
            is_smooth(&subject.scene)
                .then(|| relaxed(subject, Motion::Static(relaxation(RelaxationMass::Stiffness))))?
        },
    },
    Relation {
        name: "load_along_another_curve",
        claim: "Where loads grow along another curve, they end at the same place",
        bound: 1e-6,
        reason: UNIQUE,
        compare: |subject| {
            is_smooth(&subject.scene).then(|| {
                let curve = Amplitude::Table(vec![(0.0, 0.0), (0.3, 0.7), (0.6, 0.4), (1.0, 1.0)]);
                subject.with(with_curve(subject.problem(), &curve), &View::default())
            })?
        },
    },
    Relation {
        name: "all_at_once",
        claim: "Loads that are complete from the start end at the same place",
        bound: 1e-6,
        reason: UNIQUE,
        compare: |subject| {
            is_smooth(&subject.scene).then(|| {
                let at_once = with_curve(subject.problem(), &Amplitude::Constant);
                // What is there from the start cannot be taken in parts.
                Some(match subject.with(at_once, &View::default())? {
                    Compared::Refused(why) if why.contains("no equilibrium") => {
                        Compared::Undecided(why)
                    }
                    compared => compared,
                })
            })?
        },
    },
    Relation {
        name: "longer_curve",
        claim: "A load curve of another length ends at the same place",
        bound: 1e-6,
        reason: UNIQUE,
        compare: |subject| {
            is_smooth(&subject.scene).then(|| {
                let curve = Amplitude::Linear { duration: 100.0 };
                let mut other = with_curve(subject.problem(), &curve);
                let tolerance = crate::build::RESIDUAL;
                other.motion =
                    Motion::Newton(Newton { load_end: 100.0, tolerance, ..Newton::default() });
                subject.with(other, &View::default())
            })?
        },
    },
];

/// Whether the equilibrium does not depend on the way: contact is without friction here, but
/// rotations of more than a quarter turn may be wound up differently.
fn is_smooth(scene: &Scene) -> bool {
    let wound = |to: &Place| matches!(to, Place::Turned(_, angle) if angle.abs() > 1.5);
    scene.is_static() && !scene.holds.iter().any(|hold| wound(&hold.to))
}

/// With another method, which may say that it has not converged, or that the cloud hardly resists
/// some motions: whether those are a twentieth of what they should be hangs on the masses.
fn relaxed(subject: &Subject, motion: Motion) -> Option<Compared> {
    let mut other = subject.problem();
    other.motion = motion;
    Some(match subject.with(other, &View::default())? {
        Compared::Refused(why) if why.contains("not converged") || why.contains("hourglassing") => {
            Compared::Undecided(why)
        }
        compared => compared,
    })
}

fn with_curve(mut problem: Problem, curve: &Amplitude) -> Problem {
    let set = |amplitude: &mut Amplitude| *amplitude = curve.clone();
    let conditions: &mut Vec<EssentialCondition> = &mut problem.conditions;
    conditions.iter_mut().for_each(|condition| set(&mut condition.amplitude));
    let loads = &mut problem.loads;
    loads.body_forces.iter_mut().for_each(|load| set(&mut load.amplitude));
    loads.tractions.iter_mut().for_each(|load| set(&mut load.amplitude));
    loads.pressures.iter_mut().for_each(|load| set(&mut load.amplitude));
    problem
}
