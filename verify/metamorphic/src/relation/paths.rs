//! Other ways to the same equilibrium.

use super::subject::{Compared, Relation, Subject};
use crate::answer::{View, steady};
use crate::build::{self, RESIDUAL, newton};
use crate::scene::{Law, Place, Scene};
use mtled::problem::{Amplitude, EssentialCondition, Motion, Problem, Relaxation, RelaxationMass};

const UNIQUE: &str = "An elastic body that does not buckle has one equilibrium near rest, whatever \
                      the way; Newton's method ends at 1e-12 of the largest force, times a condition \
                      of up to 1e5";
/// Of relaxation \[–\].
const TOLERANCE: f64 = 1e-6;
/// Of Newton's method where its work is counted \[–\].
const OF_WORK: f64 = 1e-8;
/// A second of a small body; most need some hundred.
const MOST_STEPS: usize = 20_000;

/// Relaxation that gives up in time.
fn relaxation(mass: RelaxationMass) -> Relaxation {
    Relaxation { tolerance: TOLERANCE, max_steps: MOST_STEPS, mass, ..Relaxation::default() }
}

pub(crate) const RELATIONS: &[Relation] = &[
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
            let jumps = subject.scene.obstacle.is_some_and(|wall| wall.drift.is_some());
            (is_smooth(&subject.scene) && !jumps).then(|| {
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
                other.motion = newton(100.0, RESIDUAL);
                subject.with(other, &View::default())
            })?
        },
    },
    Relation {
        name: "work_near_the_limit",
        claim: "In a plane Newton's method takes no more products at ν = 0.4999 than thrice those at 0.49",
        bound: 2.0,
        reason: "Pressures are unknowns beside the displacements, so that products do not grow with the bulk \
                 modulus, and bodies of a hundred nodes need few at 0.49; once it took 35 times as many",
        compare: near_the_limit,
    },
];

/// Products with the tangent of a nearly incompressible plane body, over those of one that is less
/// so, less one \[–\].
fn near_the_limit(subject: &Subject) -> Option<Compared> {
    let scene = &subject.scene;
    let plain = Scene { law: Law::Isochoric, projected: true, tension: None, ..scene.clone() };
    let fit = scene.components() == 2 && is_smooth(scene);
    let products = |poisson_ratio: f64| {
        let scene = Scene { poisson_ratio, ..plain.clone() };
        let mut problem = build::problem(&scene).ok()?;
        problem.motion = newton(1.0, OF_WORK);
        let answer = steady(problem)?;
        Some(answer.summary.newton?.products as f64)
    };
    fit.then(|| Some(Compared::Difference(products(0.4999)? / products(0.49)? - 1.0)))?
}

/// Whether the equilibrium does not depend on the way, as with friction and memory; rotations of
/// more than a quarter turn may be wound up differently.
fn is_smooth(scene: &Scene) -> bool {
    let wound = |to: &Place| matches!(to, Place::Turned(_, angle) if angle.abs() > 1.5);
    scene.is_static() && !scene.depends_on_way() && !scene.holds.iter().any(|hold| wound(&hold.to))
}

/// With another method, which may say that it has not converged, that a lumped mass is not positive,
/// of which Newton's method needs none, or that the cloud hardly resists some motions: whether those are
/// a twentieth of what they should be hangs on the masses.
fn relaxed(subject: &Subject, motion: Motion) -> Option<Compared> {
    let mut other = subject.problem();
    other.motion = motion;
    let proves_nothing = ["not converged", "hourglassing", "lumped mass"];
    Some(match subject.with(other, &View::default())? {
        Compared::Refused(why) if proves_nothing.iter().any(|part| why.contains(part)) => {
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
    let fluids = loads.cavities.iter_mut().filter_map(|cavity| cavity.fluid.as_mut());
    fluids.for_each(|fluid| set(&mut fluid.amplitude));
    let motions = problem.obstacles.iter_mut().flat_map(|obstacle| &mut obstacle.motions);
    motions.for_each(|motion| set(&mut motion.amplitude));
    let pulls = problem.regions.iter_mut().filter_map(|region| region.active.as_mut());
    pulls.for_each(|active| set(&mut active.amplitude));
    problem
}
