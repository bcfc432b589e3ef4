//! Newton's method, its choice, and the stability of static solutions.
#![allow(non_snake_case)]

use crate::common::statics::*;
use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::error::Error;
use mtled::geometry::{Selector, Shape};
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::motion::summary::Summary;
use mtled::problem::*;
use std::f64::consts::PI;

#[test]
fn newton_reaches_the_solution_of_relaxation_with_its_reactions() {
    let nearly_incompressible = |problem| {
        let mut problem = with_law(leaning(problem), neo_hookean(3000.0, 0.49));
        problem.recipe.volumetric_projection = VolumetricProjection::Patches;
        problem
    };
    for problem in [
        leaning(jittered(cube(4), 0.2, 1)),
        collocated(leaning(jittered(cube(4), 0.2, 1))),
        collocated(nearly_incompressible(jittered(square(6), 0.2, 1))),
    ] {
        let exact = solve_by(&problem, newton());
        let counts = exact.summary.newton.unwrap();
        assert!(counts.residual <= 1e-10, "{counts:?}");
        let relaxed = solve_to(&problem, 1e-7);
        let error = difference(&relaxed.state.displacement, &exact.state.displacement);
        assert!(error <= 1e-7, "{error:e}");
        for (a, b) in relaxed.recorder.reactions.iter().zip(&exact.recorder.reactions) {
            let error = (a.force - b.force).norm() / b.force.norm();
            assert!(
                error < 1e-5 && (a.moment - b.moment).norm() < 1e-5 * b.moment.norm(),
                "{error:e}"
            );
        }
    }
}

#[test]
fn a_tolerance_below_round_off_ends_in_an_equilibrium_that_says_so() {
    // Strains of 1e-7: F = 1 + Grad u has round-off of 1e-9 of them.
    let mut problem = collocated(leaning(jittered(cube(4), 0.2, 1)));
    problem.loads = Loads::default();
    let aside = Prescribed::Displacement([Some(1e-7 * EDGE), Some(0.0), None]);
    problem.conditions[1].prescribed = aside;
    let by = |tolerance| {
        solve_by(&problem, Motion::Newton(Newton { load_end: 1.0, tolerance, ..Newton::default() }))
    };
    let counts = by(1e-14).summary.newton.unwrap();
    assert!(counts.up_to_round_off && counts.increments == 1, "{counts:?}");
    assert!(counts.residual > 1e-14 && counts.residual < 1e-8, "{counts:?}");
    assert!(!by(1e-6).summary.newton.unwrap().up_to_round_off);
}

#[test]
fn from_a_relaxed_state_newton_needs_one_increment() {
    let mut solved = solve(&collocated(leaning(jittered(cube(4), 0.2, 1))));
    let before = solved.state.displacement.clone();
    let summary = simulate(&solved.model, &newton(), &mut solved.state, &mut Unobserved).unwrap();
    let counts = summary.newton.unwrap();
    assert!(counts.increments == 1 && counts.iterations <= 4, "{counts:?}");
    assert!(difference(&before, &solved.state.displacement) <= TOLERANCE);
}

#[test]
fn the_works_of_newton_sum_to_the_strain_energy_of_the_solution() {
    let solved = solve_by(&collocated(leaning(jittered(cube(4), 0.2, 1))), newton());
    let last = solved.recorder.energies.last().unwrap();
    assert!(last.strain > 0.0 && last.kinetic == 0.0);
    assert!(last.balance().abs() < 1e-12 * last.strain, "{last:?}");
}

#[test]
fn newton_converges_for_a_rotation_that_needs_no_force() {
    let mut problem = collocated(cube(3));
    let mut turned = condition("boundary", Selector::All, [None; 3]);
    let axis = Vector3::new(1.0, 2.0, 2.0) / 3.0;
    turned.prescribed = Prescribed::Rotation { point: Vector3::zeros(), axis, angle: 1.0 };
    turned.amplitude = Amplitude::Linear { duration: 1.0 };
    problem.conditions = vec![turned];
    let solved = solve_by(&problem, newton());
    let u = &solved.state.displacement;
    let f = forces(&solved.model, u);
    assert!(largest(&f) < 1e-11 * largest(&solved.model.stiffness) * largest(u));
}

/// The end of a turn beyond half a turn is nearer by the other way round.
#[test]
fn a_bar_is_twisted_by_all_turns_that_its_end_makes() {
    let length = 8.0 * EDGE;
    let centre = Vector3::new(0.5 * EDGE, 0.5 * EDGE, length);
    let energy = |angle: f64| {
        let mut problem = collocated(cube(3));
        problem.body = Shape::Box { min: Vector3::zeros(), max: Vector3::new(EDGE, EDGE, length) };
        let mut turned = condition("end", face(2, length), [None; 3]);
        turned.prescribed = Prescribed::Rotation { point: centre, axis: Vector3::z(), angle };
        turned.amplitude = Amplitude::Linear { duration: 1.0 };
        problem.conditions = vec![condition("foot", face(2, 0.0), [Some(0.0); 3]), turned];
        solve_by(&problem, newton()).recorder.energies.last().unwrap().strain
    };
    let turn = 2.0 * PI;
    let [half, whole, one_and_a_half] = [0.5, 1.0, 1.5].map(|turns| energy(turns * turn));
    assert!(whole > 3.0 * half && one_and_a_half > 1.8 * whole, "{half} {whole} {one_and_a_half}");
}

/// A block of a law that softens in compression, under more than it can carry \[m/s²\].
fn run_crushed(weight: f64, motion: Motion) -> (State, Result<Summary, Error>) {
    let mut problem = square(3);
    problem.conditions.push(condition("base", face(1, 0.0), [Some(0.0); 3]));
    gravity(&mut problem, Vector3::new(0.0, -weight, 0.0));
    problem = with_law(problem, objective_laws()[3]);
    problem.motion = motion;
    let (_, model) = build(&problem);
    let mut state = State::new(&model);
    let run = simulate(&model, &problem.motion, &mut state, &mut Unobserved);
    (state, run)
}

#[test]
fn a_load_without_equilibrium_ends_in_an_error_with_the_load_reached() {
    let (_, run) = run_crushed(1e5, newton());
    let Err(Error::NoEquilibrium { reached, iterations, .. }) = run else { panic!("{run:?}") };
    assert!(reached < 1.0 && iterations > 0);
}

#[test]
fn where_relaxation_diverges_the_equilibrium_that_newton_came_to_is_kept() {
    let (kept, run) = run_crushed(1e3, automatic());
    let Err(Error::NeitherSolver { reached, then }) = run else { panic!("{run:?}") };
    assert!(
        reached > 0.0 && matches!(*then, Error::Inverted { .. } | Error::Diverged { .. }),
        "{then}"
    );
    let settings = Motion::Newton(Relaxation::default().newton());
    let (alone, _) = run_crushed(1e3, settings);
    assert!(kept.displacement.iter().any(|u| *u != 0.0) && kept.displacement == alone.displacement);
}

/// A strip of soft tissue that stands on its lower edge, six times as high as wide.
fn standing(young_modulus: f64) -> Problem {
    let law = neo_hookean(young_modulus, 0.3);
    let mut problem = with_law(jittered(square(5), 0.3, 2), law);
    problem.body = mtled::geometry::Shape::Box {
        min: Vector3::zeros(),
        max: Vector3::new(EDGE, 6.0 * EDGE, EDGE),
    };
    problem.conditions.push(condition("base", face(1, 0.0), [Some(0.0); 3]));
    gravity(&mut problem, Vector3::new(0.0, -9.81, 0.0));
    problem
}

/// Young's modulus \[Pa\] below which the strip buckles under its weight, E' I q h³ = 7.84
/// (Greenhill 1881), with E' = E/(1 − ν²) in plane strain.
fn greenhill_modulus() -> f64 {
    let (height, square_of_gyration) = (6.0 * EDGE, EDGE * EDGE / 12.0);
    9.81 * 1000.0 * height.powi(3) / (7.8373 * square_of_gyration) * (1.0 - 0.3 * 0.3)
}

/// A strip whose Young's modulus is `part` of the critical one, by a method.
fn run_standing(part: f64, motion: Motion) -> (State, Result<Summary, Error>) {
    let problem = Problem { motion, ..standing(part * greenhill_modulus()) };
    let (_, model) = build(&problem);
    let mut state = State::new(&model);
    let summary = simulate(&model, &problem.motion, &mut state, &mut Unobserved);
    (state, summary)
}

fn automatic() -> Motion {
    Motion::Static(Relaxation::default())
}

#[test]
fn where_both_solvers_fail_the_error_speaks_of_both() {
    let few = Relaxation { load_steps: 10, max_steps: 20, ..Relaxation::default() };
    let error = run_standing(0.1, Motion::Static(few)).1.unwrap_err();
    assert!(matches!(error, Error::NeitherSolver { .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains("relaxation") && text.contains("newton's method"), "{text}");
}

#[test]
fn a_strip_that_buckles_under_its_weight_is_called_unstable_and_a_stiffer_one_is_not() {
    for motion in [relaxation(1e-4), automatic()] {
        for stable in [1.5, 4.0] {
            let (_, summary) = run_standing(stable, motion.clone());
            assert_eq!(summary.unwrap().instability, None, "{stable}");
        }
        for unstable in [0.8, 0.5] {
            let instability = match run_standing(unstable, motion.clone()).1 {
                Ok(summary) => summary.instability.expect("the strip has buckled without a word"),
                Err(error) => error.instability().unwrap_or_else(|| panic!("{error}")).clone(),
            };
            assert!(instability.position.y > 5.0 * EDGE, "{unstable}: {instability}");
        }
    }
}

#[test]
fn where_newton_fails_relaxation_takes_its_place_and_says_so() {
    let (state, summary) = run_standing(0.8, automatic());
    let failure = summary.unwrap().newton_failed.expect("Newton's method did not fail");
    assert!(failure.reached < 1.0 && failure.iterations > 0, "{failure:?}");
    let (relaxed, _) = run_standing(0.8, relaxation(1e-4));
    let error = difference(&state.displacement, &relaxed.displacement);
    assert!(error < 2e-4, "{error:e}");
}

#[test]
fn a_straight_strip_that_would_buckle_is_an_unstable_equilibrium_of_newton() {
    let mut problem = standing(0.8 * greenhill_modulus());
    problem.recipe.cloud = Cloud::Regular { spacing: EDGE / 4.0 };
    let solved = solve_by(&problem, newton());
    let instability = solved.summary.instability.expect("the strip is straight");
    assert!(instability.position.y > 5.0 * EDGE, "{instability}");
}

/// A strip of ten times its width between two clamps, one of which shortens it by a part of its
/// length. It buckles beyond 4π²/(12·10²) = 3.3 % (Euler).
fn shortened(part: f64) -> Problem {
    let length = 10.0 * EDGE;
    let mut problem = with_law(square(4), neo_hookean(3000.0, 0.3));
    let max = Vector3::new(EDGE, length, EDGE);
    problem.body = mtled::geometry::Shape::Box { min: Vector3::zeros(), max };
    problem.conditions.push(condition("base", face(1, 0.0), [Some(0.0); 3]));
    let moved = [Some(0.0), Some(-part * length), Some(0.0)];
    problem.conditions.push(condition("top", face(1, length), moved));
    problem
}

#[test]
fn a_straight_column_between_clamps_is_called_unstable_beyond_its_euler_load_alone() {
    for (part, unstable) in [(0.05, true), (0.01, false)] {
        let solved = solve_by(&shortened(part), newton());
        let found = solved.summary.instability.is_some();
        assert_eq!(found, unstable, "shortened by {part}");
    }
}

#[test]
fn the_automatic_solution_is_that_of_newton_within_the_tolerance_of_displacements() {
    for problem in [leaning(jittered(cube(4), 0.2, 1)), leaning(jittered(square(6), 0.2, 1))] {
        let exact = solve_by(&problem, newton());
        let solved = solve_by(&problem, automatic());
        assert!(solved.summary.newton.is_some() && solved.summary.newton_failed.is_none());
        let error = difference(&solved.state.displacement, &exact.state.displacement);
        assert!(error > 0.0 && error < Relaxation::default().tolerance, "{error:e}");
    }
}

#[test]
fn a_body_that_sticks_to_an_obstacle_is_relaxed() {
    let mut problem = leaning(jittered(square(4), 0.2, 1));
    let up = Vector3::y();
    for (friction, relaxed) in [(Friction::Frictionless, false), (Friction::NoSlip, true)] {
        problem.obstacles = vec![floor(-0.1 * EDGE, up, friction)];
        let solved = solve_by(&problem, automatic());
        assert_eq!(solved.summary.relaxation.is_some(), relaxed, "{friction:?}");
        assert_eq!(solved.summary.newton.is_some(), !relaxed, "{friction:?}");
    }
}
