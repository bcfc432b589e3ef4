//! Pressures that follow the surface.
#![allow(non_snake_case)]

use crate::common::pipe::{nearly_incompressible, pressure_to_widen, quarter_pipe};
use crate::common::*;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::{Selector, Shape};
use mtled::material::*;
use mtled::model::following::FollowingTangent;
use mtled::model::{Following, Model};
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::motion::step::{add_following, external_force};
use mtled::problem::*;

fn pressure(part: Selector, pressure: f64) -> Pressure {
    Pressure { name: "pressure".into(), part, pressure, amplitude: Amplitude::Constant }
}

fn pressed(body: Shape, spacing: f64, law: Law) -> Problem {
    let mut recipe = Recipe::with_spacing(spacing);
    recipe.gradients = Gradients::Consistent { tolerance: 1e-12 };
    recipe.cloud = Cloud::Jittered { spacing, jitter: 0.2, seed: 3 };
    let mut problem = Problem::new(body, material(law), recipe);
    problem.motion = dynamic(0.1, 1e-3, 0.0);
    problem.loads.pressures = vec![pressure(Selector::All, 100.0)];
    problem
}

fn bodies() -> [Shape; 2] {
    let ball = Shape::Sphere { centre: Vector3::new(0.01, 0.02, 0.0), radius: 0.5 * EDGE };
    [Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(EDGE) }, ball]
}

fn pressure_force(model: &Model, u: &[f64]) -> Vec<f64> {
    let mut force = vec![0.0; model.size()];
    add_following(model, 0.0, u, &mut force);
    force
}

fn affine(model: &Model, F: &Matrix3) -> Vec<f64> {
    field(model, |X| (F - Matrix3::identity()) * X)
}

#[test]
fn a_body_under_uniform_pressure_is_in_equilibrium_where_it_has_only_shrunk() {
    for body in bodies() {
        let mut problem = pressed(body, EDGE / 5.0, neo_hookean(3000.0, 0.3));
        let F = Matrix3::identity() * 0.8;
        let P = problem.regions[0].material.law.first_piola_kirchhoff(&F);
        // P = −p cof F.
        problem.loads.pressures[0].pressure = -P[(0, 0)] / 0.64;
        let (_, model) = build(&problem);
        let u = affine(&model, &F);
        let (external, internal) = (pressure_force(&model, &u), forces(&model, &u));
        let rest: Vec<f64> = external.iter().zip(&internal).map(|(e, i)| e - i).collect();
        let relative = largest(&rest) / largest(&internal);
        assert!(relative < 1e-11, "{relative:e}");
    }
}

#[test]
fn a_uniform_pressure_all_around_has_no_resultant_after_an_affine_deformation() {
    let F = Matrix3::new(1.2, 0.3, -0.1, 0.1, 0.8, 0.2, 0.0, -0.2, 1.1);
    for body in bodies() {
        let (_, model) = build(&pressed(body, EDGE / 5.0, neo_hookean(3000.0, 0.3)));
        for u in [vec![0.0; model.size()], affine(&model, &F)] {
            let force = pressure_force(&model, &u);
            let nodes = || 0..model.positions.len();
            let resultant: Vector3 = nodes().map(|n| vector_at(&force, n, 3)).sum();
            let sizes: f64 = nodes().map(|n| vector_at(&force, n, 3).norm()).sum();
            assert!(resultant.norm() < 1e-12 * sizes, "{resultant} of {sizes}");
            let moment: Vector3 = nodes()
                .map(|n| (model.positions[n] + vector_at(&u, n, 3)).cross(&vector_at(&force, n, 3)))
                .sum();
            assert!(moment.norm() < 1e-12 * sizes * EDGE, "{moment}");
        }
    }
}

#[test]
fn the_force_of_a_pressure_turns_with_the_surface_and_goes_with_its_area() {
    let mut problem = pressed(bodies()[0].clone(), EDGE / 5.0, neo_hookean(3000.0, 0.3));
    problem.loads.pressures = vec![pressure(face(2, EDGE), 50.0)];
    let (_, model) = build(&problem);
    // A quarter turn about x takes the normal z to −y; the face grows by 1.5.
    let turn = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0);
    let F = turn * Matrix3::from_diagonal(&Vector3::new(1.5, 1.0, 1.3));
    let force = pressure_force(&model, &affine(&model, &F));
    let resultant: Vector3 = (0..model.positions.len()).map(|n| vector_at(&force, n, 3)).sum();
    let expected = Vector3::y() * 50.0 * 1.5 * EDGE * EDGE;
    assert!((resultant - expected).norm() < 1e-9 * expected.norm(), "{resultant}");
}

#[test]
fn the_stiffness_of_a_pressure_is_the_symmetric_part_of_its_derivative() {
    let space = pressed(bodies()[1].clone(), EDGE / 4.0, neo_hookean(3000.0, 0.3));
    let mut plane = square(5);
    plane.loads.pressures = vec![pressure(face(0, EDGE), 100.0)];
    for problem in [space, plane] {
        let (_, model) = build(&problem);
        let u = noise(&model, 0.02 * EDGE, 1);
        let work = |v: &[f64], w: &[f64], force: &[f64]| -> f64 {
            let both = v.iter().zip(w).map(|(v, w)| v + w);
            both.zip(force).map(|(v, f)| v * f).sum()
        };
        let (v, zero) = (noise(&model, 1.0, 2), vec![0.0; model.size()]);
        let step = 1e-6 * EDGE;
        let at = |sign: f64| -> Vec<f64> {
            let moved: Vec<f64> = u.iter().zip(&v).map(|(u, v)| u + sign * step * v).collect();
            pressure_force(&model, &moved)
        };
        let difference: Vec<f64> =
            at(1.0).iter().zip(at(-1.0)).map(|(a, b)| (a - b) / (2.0 * step)).collect();
        let mut product = zero.clone();
        let d = model.components;
        let mut tangent = FollowingTangent::new(&model.following, (0.0, None), &u, d);
        tangent.add_times(&v, Following::Symmetric, &mut product);
        // Of a quadratic form only the symmetric part counts.
        let (expected, found) = (work(&v, &zero, &difference), work(&v, &zero, &product));
        let scale: f64 = product.iter().zip(&v).map(|(p, v)| (p * v).abs()).sum();
        assert!((found - expected).abs() < 1e-8 * scale, "{found} {expected}");
        // And it is symmetric.
        let w = noise(&model, 1.0, 3);
        let mut other = zero.clone();
        tangent.add_times(&w, Following::Symmetric, &mut other);
        let (one, two) = (work(&w, &zero, &product), work(&v, &zero, &other));
        assert!((one - two).abs() < 1e-12 * scale, "{one} {two}");
    }
}

#[test]
fn the_work_of_a_pressure_becomes_kinetic_and_strain_energy() {
    let mut problem = cube(5);
    problem.conditions = vec![condition("bottom", face(2, 0.0), [Some(0.0); 3])];
    problem.loads.pressures = vec![pressure(face(0, EDGE), 300.0)];
    problem.loads.pressures[0].amplitude = Amplitude::Smooth { duration: 0.05 };
    problem.motion = dynamic(0.15, 2e-4, 0.0);
    let (_, model) = build(&problem);
    let (mut state, mut recorder) = (State::new(&model), Recorder::default());
    simulate(&model, &problem.motion, &mut state, &mut recorder).unwrap();
    let most = recorder.energies.iter().map(|e| e.external_work).fold(0.0, f64::max);
    let drift = recorder.energies.iter().map(|e| e.balance().abs()).fold(0.0, f64::max);
    assert!(largest(&state.displacement) > 0.1 * EDGE && drift < 1e-4 * most, "{drift} of {most}");
}

/// Its half divides neither quarter circle of the pipes evenly \[m\].
const SPACING: f64 = 0.1;

/// A quarter of a pipe in plane strain under a pressure inside.
fn pipe(inner: f64, outer: f64, spacing: f64, law: Law, inside: f64) -> Problem {
    let (mut problem, hole) = quarter_pipe((inner, outer), (spacing, 0.01), law);
    problem.loads.pressures = vec![pressure(hole, inside)];
    problem.loads.pressures[0].amplitude = Amplitude::Smooth { duration: 1.0 };
    problem
}

/// Mean radial displacement at the reference radius `at` \[m\].
fn radial(problem: &Problem, motion: Motion, at: f64) -> f64 {
    let problem = Problem { motion, ..problem.clone() };
    let (discretisation, model) = build(&problem);
    let mut state = State::new(&model);
    simulate(&model, &problem.motion, &mut state, &mut Unobserved).unwrap();
    let angles: Vec<f64> = (1..=8).map(|n| n as f64 * 10f64.to_radians()).collect();
    let positions: Vec<Vector3> =
        angles.iter().map(|a| Vector3::new(a.cos(), a.sin(), 0.0) * at).collect();
    let rows = discretisation.rows_at(&positions).unwrap();
    let radial =
        |(i, X): (usize, &Vector3)| rows.interpolate(i, &state.displacement, 2).dot(X) / at;
    positions.iter().enumerate().map(radial).sum::<f64>() / positions.len() as f64
}

/// To a tolerance above round-off near incompressibility.
fn newton() -> Newton {
    Newton { tolerance: 1e-8, ..Newton::default() }
}

#[test]
fn a_pipe_under_small_pressure_widens_as_lame_says() {
    let (a, b, E, nu) = (1.0, 2.0, 3000.0, 0.3);
    let p = 1e-4 * E;
    let problem = pipe(a, b, SPACING, neo_hookean(E, nu), p);
    let exact = |r: f64| {
        p * a * a / (E * (b * b - a * a)) * (1.0 + nu) * ((1.0 - 2.0 * nu) * r + b * b / r)
    };
    for motion in [Motion::Relaxed(Relaxation::default()), Motion::Newton(newton())] {
        let found = radial(&problem, motion, 1.4);
        approx::assert_relative_eq!(found, exact(1.4), max_relative = 0.005);
    }
}

#[test]
fn a_pipe_that_widens_by_half_needs_the_pressure_of_the_closed_form() {
    let (a, b, mu): (f64, f64, f64) = (1.0, 2.0, 1000.0);
    let c = (1.5f64 * a).powi(2) - a * a;
    let p = pressure_to_widen((a, b), mu, c);
    let problem = pipe(a, b, SPACING, nearly_incompressible(mu), p);
    let exact = |R: f64| (R * R + c).sqrt() - R;
    let counts = statics::solve_by(&problem, Motion::Newton(newton())).summary.newton.unwrap();
    assert!(counts.products < 4000, "{counts:?}");
    for motion in [Motion::Relaxed(Relaxation::default()), Motion::Newton(newton())] {
        let found = radial(&problem, motion, 1.4);
        approx::assert_relative_eq!(found, exact(1.4), max_relative = 0.01);
    }
}

#[test]
fn a_scene_without_pressure_has_none_and_dead_loads_do_not_change() {
    let mut problem = cube(3);
    gravity(&mut problem, Vector3::z());
    let (_, model) = build(&problem);
    assert!(model.following.is_empty());
    let (mut dead, u) = (vec![0.0; model.size()], noise(&model, 0.01, 1));
    external_force(&model, 0.0, &mut dead);
    let before = dead.clone();
    add_following(&model, 0.0, &u, &mut dead);
    assert_eq!(dead, before);
}
