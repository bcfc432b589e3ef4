//! The linear law, and small loads under any law.

use super::subject::{Compared, Relation, Subject};
use crate::answer::{Answer, View, answer, relative};
use crate::build;
use crate::scene::{Law, Place, Push, Scene};
use mtled::Vector3;

const LINEAR: &str = "The discrete equations of the linear law are linear; Newton's method ends at \
                      1e-12 of the largest force, times a condition of up to 1e5";
const NEARLY_LINEAR: &str = "Terms of second order in the strain, some 1e-5 here, times the square of the \
                             slenderness, some 10, times ten for the law's own curvature";
/// Factor by which loads are made small.
const SMALL: f64 = 1e-4;

pub(crate) const RELATIONS: &[Relation] = &[
    Relation {
        name: "reversed",
        claim: "Reversed loads of the linear law reverse the displacements",
        bound: 1e-6,
        reason: LINEAR,
        compare: |subject| {
            let other = scaled(&linear(&subject.scene)?, -1.0);
            let view = View { length: -1.0, force: -1.0, ..View::default() };
            // Moments are about displaced places, and thus not linear.
            only_displacements(subject, &other, &view)
        },
    },
    Relation {
        name: "added_up",
        claim: "Displacements of the linear law add up as loads do",
        bound: 1e-6,
        reason: LINEAR,
        compare: |subject| {
            let scene = linear(&subject.scene)?;
            let (mut first, mut second) = (scene.clone(), scene.clone());
            first.pushes = scene.pushes.first().copied().into_iter().collect();
            second.pushes = scene.pushes.iter().skip(1).copied().collect();
            first.holds.iter_mut().for_each(|hold| hold.to = still(&hold.to));
            let [whole, first, second] = [&scene, &first, &second].map(solved);
            let (whole, first, second) = (whole?, first?, second?);
            let sum = first.displacements().into_iter().zip(second.displacements());
            let sum: Vec<Vector3> = sum.map(|(a, b)| a + b).collect();
            Some(Compared::Difference(relative(&whole.displacements(), &sum, 0.0)))
        },
    },
    Relation {
        name: "reciprocal",
        claim: "Two loads of the linear law do the same work on each other's displacements",
        bound: 1e-6,
        reason: LINEAR,
        compare: reciprocal,
    },
    Relation {
        name: "small_and_reversed",
        claim: "Under any law small loads reversed reverse the displacements",
        bound: 1e-2,
        reason: NEARLY_LINEAR,
        compare: |subject| {
            let scene = &subject.scene;
            if !becomes_linear(scene) {
                return None;
            }
            let [plus, minus] = [SMALL, -SMALL].map(|by| solved_small(&scaled(scene, by)));
            let minus = minus?.displacements().iter().map(|u| -u).collect::<Vec<_>>();
            Some(Compared::Difference(relative(&plus?.displacements(), &minus, 0.0)))
        },
    },
    Relation {
        name: "small_and_linear",
        claim: "Under small loads every law moves like the linear one of its moduli",
        bound: 1e-2,
        reason: NEARLY_LINEAR,
        compare: |subject| {
            let scene = &subject.scene;
            let other = scene.has_patches() || scene.law.has_fibres() || scene.memory.is_some();
            if !becomes_linear(scene) || other {
                return None;
            }
            let small = scaled(scene, SMALL);
            let hooke = Scene { law: Law::Linear, ..small.clone() };
            let (own, hooke) = (solved_small(&small)?, solved_small(&hooke)?);
            let difference = relative(&own.displacements(), &hooke.displacements(), 0.0);
            (scene.law != Law::Linear).then_some(Compared::Difference(difference))
        },
    },
];

/// Whether a scene is linear in the limit of small loads.
fn becomes_linear(scene: &Scene) -> bool {
    let turns = scene.holds.iter().any(|hold| matches!(hold.to, Place::Turned(..)));
    let switches = scene.law == Law::Sheets;
    scene.is_static() && scene.obstacle.is_none() && !turns && !switches
}

fn still(to: &Place) -> Place {
    match to {
        Place::By(_) | Place::Bent(_) => Place::Still,
        other => *other,
    }
}

/// The scene with the linear law, where everything else in it is linear.
fn linear(scene: &Scene) -> Option<Scene> {
    let follows = |push: &Push| matches!(push, Push::Pressure(..));
    let turns = scene.holds.iter().any(|hold| matches!(hold.to, Place::Turned(..)));
    let nonlinear = scene.obstacle.is_some() || turns || scene.pushes.iter().any(follows);
    let more = scene.filling.is_some() || scene.tension.is_some() || scene.memory.is_some();
    (scene.is_static() && !nonlinear && !more).then(|| Scene { law: Law::Linear, ..scene.clone() })
}

/// Loads and prescribed displacements times a factor.
fn scaled(scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    let times = |v: &mut [f64; 3]| v.iter_mut().for_each(|c| *c *= factor);
    for hold in &mut scene.holds {
        match &mut hold.to {
            Place::By(by) => times(by),
            Place::Bent(by) => *by *= factor,
            Place::Still | Place::Roller(_) | Place::Turned(..) => {}
        }
    }
    if let Some(filling) = &mut scene.filling {
        filling.inflow *= factor;
    }
    if let Some(tension) = &mut scene.tension {
        *tension *= factor;
    }
    for push in &mut scene.pushes {
        match push {
            Push::Gravity(v) | Push::Pull(_, v) | Push::Traction(_, v) | Push::Throw(_, v) => {
                times(v);
            }
            Push::Pressure(_, p) => *p *= factor,
        }
    }
    scene
}

/// The answer to a scene, if it has one.
fn solved(scene: &Scene) -> Option<Answer> {
    answer(build::problem(scene).ok()?).ok()
}

/// The answer to a scene of small loads, whose forces are no more than round-off of the
/// stiffness to as many digits as loads are small.
fn solved_small(scene: &Scene) -> Option<Answer> {
    let mut problem = build::problem(scene).ok()?;
    problem.motion = build::newton(1.0, build::RESIDUAL / SMALL);
    answer(problem).ok()
}

fn only_displacements(subject: &Subject, other: &Scene, view: &View) -> Option<Compared> {
    let (first, other) = (solved(&linear(&subject.scene)?)?, solved(other)?);
    let seen: Vec<Vector3> = other.displacements().iter().map(|u| u / view.length).collect();
    Some(Compared::Difference(relative(&first.displacements(), &seen, 0.0)))
}

/// The first load on the displacements of the others, and the other way round.
fn reciprocal(subject: &Subject) -> Option<Compared> {
    let mut scene = linear(&subject.scene)?;
    scene.holds.iter_mut().for_each(|hold| hold.to = still(&hold.to));
    scene.pushes.extend([Push::Gravity([0.03, 0.05, 0.0]), Push::Gravity([0.02, -0.05, 0.0])]);
    let only = |n: usize| {
        let pushes = scene.pushes[n..=n].to_vec();
        solved(&Scene { pushes, ..scene.clone() })
    };
    let (first, second) = (only(0)?, only(1)?);
    // What a load does on the other's displacements, and the sum of the sizes of its parts: on
    // what is held they cancel.
    let work = |load: &Answer, on: &Answer| {
        let force = &load.simulation.model.loads.first()?.force;
        let parts = force.iter().zip(&on.simulation.state.displacement).map(|(f, u)| f * u);
        Some(parts.fold((0.0, 0.0), |(sum, sizes), part| (sum + part, sizes + part.abs())))
    };
    let (there, size) = work(&first, &second)?;
    let (back, other_size) = work(&second, &first)?;
    let size = f64::max(size, other_size);
    (size > 0.0).then(|| Compared::Difference((there - back).abs() / size))
}
