//! Springs all over a part of the boundary.
#![allow(non_snake_case)]

use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::audit::Kind;
use mtled::geometry::{Selector, Shape};
use mtled::material::*;
use mtled::model::Model;
use mtled::model::rigid_motions::free_rigid_motions;
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::motion::step::add_following;
use mtled::problem::*;

fn spring(part: Selector, normal: f64, tangential: f64) -> Spring {
    Spring { name: "bed".into(), part, normal, tangential }
}

/// A block of ν = 0 on a bed, pressed from above: its stress is uniform.
fn pressed_block(normal: f64, tangential: f64, traction: Vector3) -> Problem {
    let mut problem = cube(5);
    let constants = ElasticConstants::from_young_poisson(3000.0, 0.0).unwrap();
    problem.regions[0].material.law = Law::LinearElastic(LinearElastic::new(constants));
    problem.recipe = Recipe::with_spacing(EDGE / 5.0);
    problem.conditions = Vec::new();
    problem.loads.springs = vec![spring(face(2, 0.0), normal, tangential)];
    problem.loads.tractions = vec![Traction {
        name: "top".into(),
        part: face(2, EDGE),
        traction: Field::Uniform(traction),
        amplitude: Amplitude::Constant,
    }];
    problem
}

fn solved(problem: &Problem) -> (Model, State) {
    let (_, model) = build(problem);
    let mut state = State::new(&model);
    simulate(&model, &problem.motion, &mut state, &mut Unobserved).unwrap();
    (model, state)
}

#[test]
fn a_block_on_a_bed_sinks_as_far_as_its_pressure_over_the_stiffness() {
    let (k, t, E) = (2e4, -30.0, 3000.0);
    let mut problem = pressed_block(k, 1e3, Vector3::z() * t);
    let relaxed = Relaxation { tolerance: 1e-7, ..Relaxation::default() };
    let motions = [
        Motion::Newton(Newton { tolerance: 1e-10, ..Newton::default() }),
        Motion::Relaxed(relaxed),
    ];
    for motion in motions {
        problem.motion = motion;
        let (model, state) = solved(&problem);
        for (node, X) in model.positions.iter().enumerate() {
            let expected = Vector3::z() * (t / k + t * X.z / E);
            let found = vector_at(&state.displacement, node, 3);
            assert!((found - expected).norm() < 1e-4 * (t / k).abs(), "{X}: {found} {expected}");
        }
        let force = model.following.springs[0].resultant(&state.displacement, 3);
        assert!((force.z + t * EDGE * EDGE).abs() < 1e-5 * t.abs() * EDGE * EDGE, "{force}");
    }
}

#[test]
fn a_shift_of_a_body_meets_area_times_stiffness_along_and_across_the_surface() {
    let (k, s) = (3e4, 7e3);
    let problem = pressed_block(k, s, Vector3::zeros());
    let (_, model) = build(&problem);
    let shift = Vector3::new(1e-3, -2e-3, 3e-3);
    let mut force = vec![0.0; model.size()];
    add_following(&model, 0.0, &field(&model, |_| shift), &mut force);
    let found: Vector3 = (0..model.positions.len()).map(|n| vector_at(&force, n, 3)).sum();
    let expected = -EDGE * EDGE * Vector3::new(s * shift.x, s * shift.y, k * shift.z);
    assert!((found - expected).norm() < 1e-12 * expected.norm(), "{found} {expected}");
}

#[test]
fn springs_along_the_normal_of_a_ball_hold_its_shifts_and_leave_its_turns() {
    let mut problem = pressed_block(1e4, 0.0, Vector3::zeros());
    problem.body = Shape::Sphere { centre: Vector3::zeros(), radius: 0.5 * EDGE };
    problem.loads.tractions.clear();
    problem.loads.springs = vec![spring(Selector::All, 1e4, 0.0)];
    let (_, model) = build(&problem);
    assert_eq!(free_rigid_motions(&model, 0.0, &vec![0.0; model.size()]), 3);
    problem.loads.springs[0].tangential = 10.0;
    let (_, model) = build(&problem);
    assert_eq!(free_rigid_motions(&model, 0.0, &vec![0.0; model.size()]), 0);
}

#[test]
fn springs_that_hold_no_axis_leave_a_pushed_body_without_equilibrium() {
    let mut problem = pressed_block(1e4, 0.0, Vector3::x());
    problem.motion = Motion::Newton(Newton::default());
    let (_, model) = build(&problem);
    let ran = simulate(&model, &problem.motion, &mut State::new(&model), &mut Unobserved);
    let refused = matches!(ran, Err(mtled::error::Error::NothingHolds { axis: 'x', .. }));
    assert!(refused, "{ran:?}");
}

#[test]
fn a_motion_on_springs_a_thousand_times_as_stiff_as_the_body_keeps_its_energy() {
    let mut problem = pressed_block(3e7, 3e7, Vector3::z() * -30.0);
    problem.motion = dynamic(0.05, 0.0, 0.0);
    if let Motion::Dynamic { step, .. } = &mut problem.motion {
        step.fixed = None;
    }
    let (_, model) = build(&problem);
    let (mut state, mut recorder) = (State::new(&model), Recorder::default());
    simulate(&model, &problem.motion, &mut state, &mut recorder).unwrap();
    let most = recorder.energies.iter().map(|e| e.external_work.abs()).fold(0.0, f64::max);
    let drift = recorder.energies.iter().map(|e| e.balance().abs()).fold(0.0, f64::max);
    assert!(drift < 0.02 * most, "{drift} of {most}");
}

#[test]
fn a_spring_without_stiffness_or_with_a_negative_one_is_refused_by_its_field() {
    for (normal, tangential, field) in [(0.0, 0.0, "normal"), (1.0, -1.0, "tangential")] {
        let problem = pressed_block(normal, tangential, Vector3::zeros());
        let found = problem.check();
        assert_eq!(found[0].field, format!("loads.springs[0].{field}"), "{found:?}");
    }
}

#[test]
fn the_audit_is_silent_on_a_bed_and_doubts_one_that_is_softer_than_stated() {
    let problem = pressed_block(2e4, 1e3, Vector3::z() * -30.0);
    let problem = Problem { motion: Motion::Newton(Newton::default()), ..problem };
    let solved = statics::solve_by(&problem, problem.motion.clone());
    assert_eq!(statics::doubts(&problem, &solved), []);
    let mut stated = problem.clone();
    stated.loads.springs[0].normal *= 1.05;
    assert!(statics::doubts(&stated, &solved).contains(&Kind::LoadForce));
}
