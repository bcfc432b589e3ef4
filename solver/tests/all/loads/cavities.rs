//! Cavities and the fluids that fill them.
#![allow(non_snake_case)]

use crate::common::pipe::{nearly_incompressible, quarter_pipe};
use crate::common::statics::{difference, doubts, solve_by};
use crate::common::*;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::audit::Kind;
use mtled::error::Error;
use mtled::geometry::{Selector, Shape};
use mtled::model::following::{CavityLoad, FollowingTangent};
use mtled::model::{CavityState, Following, Model};
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::motion::step::add_following;
use mtled::problem::*;

const INNER: f64 = 0.04;
const OUTER: f64 = 0.07;
/// The hollow ball lies away from the origin \[m\].
const CENTRE: [f64; 3] = [0.3, -0.2, 0.1];

fn sphere(radius: f64) -> Shape {
    Shape::Sphere { centre: CENTRE.into(), radius }
}

fn cavity(part: Selector, fluid: Option<Fluid>) -> Cavity {
    Cavity { name: "cavity".into(), part, opening: None, fluid }
}

fn fluid(bulk_modulus: f64, inflow: f64) -> Option<Fluid> {
    Some(Fluid { bulk_modulus, inflow, amplitude: Amplitude::Constant })
}

/// A hollow ball; three nodes that hold it lie in its wall.
fn hollow_ball(fluid: Option<Fluid>) -> Problem {
    let body = Shape::Difference(Box::new(sphere(OUTER)), Box::new(sphere(INNER)));
    let law = neo_hookean(3000.0, 0.3);
    let mut problem = Problem::new(body, material(law), Recipe::with_spacing(0.012));
    let inside = Selector::Inside { shape: sphere(1.2 * INNER), tolerance: 0.0 };
    problem.loads.cavities = vec![cavity(inside, fluid)];
    let half = |normal: Vector3| Selector::Inside {
        shape: Shape::HalfSpace { point: Vector3::from(CENTRE) + 0.94 * OUTER * -normal, normal },
        tolerance: 0.0,
    };
    problem.conditions = vec![condition("top", half(-Vector3::z()), [Some(0.0); 3])];
    problem
}

fn only(model: &Model) -> &CavityLoad {
    &model.following.cavities[0]
}

fn rest(model: &Model) -> Vec<f64> {
    vec![0.0; model.size()]
}

fn affine(model: &Model, F: &Matrix3) -> Vec<f64> {
    field(model, |X| (F - Matrix3::identity()) * X + Vector3::new(0.1, 0.2, 0.3))
}

#[test]
fn the_volume_of_a_cavity_is_that_of_its_shape_and_goes_with_the_determinant() {
    let (_, model) = build(&hollow_ball(None));
    let volume = only(&model).volume_at_rest();
    let exact = 4.0 / 3.0 * std::f64::consts::PI * INNER.powi(3);
    approx::assert_relative_eq!(volume, exact, max_relative = 0.01);
    let F = Matrix3::new(1.2, 0.3, -0.1, 0.1, 0.8, 0.2, 0.0, -0.2, 1.1);
    let CavityState { volume: moved, pressure } = only(&model).state(0.0, &affine(&model, &F), 3);
    approx::assert_relative_eq!(moved, F.determinant() * volume, max_relative = 1e-6);
    assert_eq!(pressure, 0.0);
}

/// The deformed surface closes with the error of its quadrature only.
#[test]
fn a_shift_changes_neither_the_volume_of_a_deformed_cavity_nor_what_its_slope_says() {
    let (_, model) = build(&hollow_ball(fluid(5e3, 1e-5)));
    let u = noise(&model, 1e-3, 1);
    let shift = Vector3::new(0.7, -0.4, 0.9);
    let moved: Vec<f64> = u.iter().enumerate().map(|(n, u)| u + shift[n % 3]).collect();
    let volume = |u: &[f64]| only(&model).state(0.0, u, 3).volume;
    approx::assert_relative_eq!(volume(&moved), volume(&u), max_relative = 1e-12);
    let (_, slope) = only(&model).row(&u, 3);
    let along: f64 = slope.iter().enumerate().map(|(n, slope)| slope * shift[n % 3]).sum();
    let size: f64 = slope.iter().map(|slope| slope.abs()).sum();
    assert!(along.abs() < 1e-12 * size, "{along:e} {size:e}");
}

#[test]
fn a_quarter_of_a_pipe_has_a_quarter_of_its_hole() {
    let law = neo_hookean(3000.0, 0.3);
    let (mut problem, part) = quarter_pipe((INNER, OUTER), (0.005, 1.0), law);
    problem.loads.cavities = vec![cavity(part, None)];
    problem.motion = dynamic(1.0, 1e-3, 0.0);
    let open = Model::new(&problem, &mtled::discretisation::Discretisation::new(&problem).unwrap());
    assert!(matches!(open, Err(Error::OpenCavity { .. })));
    problem.loads.cavities[0].opening = Some(Vector3::zeros());
    let (_, model) = build(&problem);
    let exact = 0.25 * std::f64::consts::PI * INNER * INNER;
    approx::assert_relative_eq!(only(&model).volume_at_rest(), exact, max_relative = 0.01);
}

#[test]
fn the_outside_of_a_body_encloses_no_cavity() {
    let mut problem = hollow_ball(None);
    problem.loads.cavities[0].part =
        Selector::Not(Box::new(problem.loads.cavities[0].part.clone()));
    let found =
        Model::new(&problem, &mtled::discretisation::Discretisation::new(&problem).unwrap());
    assert!(matches!(found, Err(Error::NoCavity { volume, .. }) if volume < 0.0));
}

#[test]
fn the_transposed_stiffness_of_a_fluid_is_that_of_its_derivative() {
    let (_, model) = build(&hollow_ball(fluid(5e3, 1e-5)));
    let u = noise(&model, 1e-3, 1);
    let (v, w) = (noise(&model, 1.0, 2), noise(&model, 1.0, 3));
    let step = 1e-7;
    let at = |sign: f64| -> Vec<f64> {
        let moved: Vec<f64> = u.iter().zip(&v).map(|(u, v)| u + sign * step * v).collect();
        let mut force = rest(&model);
        add_following(&model, 0.0, &moved, &mut force);
        force
    };
    let slope: Vec<f64> =
        at(1.0).iter().zip(at(-1.0)).map(|(a, b)| (a - b) / (2.0 * step)).collect();
    let product = |of: &[f64], part: Following| {
        let mut product = rest(&model);
        let mut tangent = FollowingTangent::new(&model.following, (0.0, None), &u, 3);
        tangent.add_times(of, part, &mut product);
        product
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let transposed = product(&w, Following::Transposed);
    let (expected, found) = (dot(&w, &slope), dot(&v, &transposed));
    let scale: f64 = v.iter().zip(&transposed).map(|(v, p)| (v * p).abs()).sum();
    assert!((expected - found).abs() < 1e-7 * scale, "{expected} {found}");
    let symmetric = [product(&v, Following::Symmetric), product(&w, Following::Symmetric)];
    let (one, two) = (dot(&w, &symmetric[0]), dot(&v, &symmetric[1]));
    assert!((one - two).abs() < 1e-12 * scale, "{one} {two}");
}

#[test]
fn products_with_a_kept_stiffness_of_pressures_are_those_without() {
    let (_, model) = build(&hollow_ball(fluid(5e3, 1e-5)));
    let (u, v) = (noise(&model, 1e-3, 1), noise(&model, 1.0, 2));
    let mut tangent = FollowingTangent::new(&model.following, (0.0, None), &u, 3);
    let mut product = || {
        let mut product = rest(&model);
        tangent.add_times(&v, Following::Symmetric, &mut product);
        product
    };
    let first = product();
    let last = (0..20).map(|_| product()).last().unwrap();
    let size = |of: &[f64]| of.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let differences: Vec<f64> = first.iter().zip(&last).map(|(a, b)| a - b).collect();
    assert_ne!(first, last, "the kept stiffness was not used");
    assert!(size(&differences) < 1e-13 * size(&first));
}

fn solved(problem: &Problem, motion: Motion) -> (Model, State) {
    let problem = Problem { motion, ..problem.clone() };
    let (_, model) = build(&problem);
    let mut state = State::new(&model);
    simulate(&model, &problem.motion, &mut state, &mut Unobserved).unwrap();
    (model, state)
}

fn newton() -> Motion {
    Motion::Newton(Newton { tolerance: 1e-8, ..Newton::default() })
}

/// As an input of 40 % of the volume into a stiff fluid, in one increment.
#[test]
fn the_pressure_that_a_fluid_finds_moves_the_body_as_that_pressure_does() {
    for bulk_modulus in [1e4, 1e7, Fluid::WATER] {
        let problem = hollow_ball(fluid(bulk_modulus, 1e-4));
        let (model, state) = solved(&problem, newton());
        let CavityState { volume, pressure } = only(&model).state(1.0, &state.displacement, 3);
        let before = only(&model).volume_at_rest();
        let compressed = (before + 1e-4 - volume) / before;
        approx::assert_relative_eq!(compressed, pressure / bulk_modulus, max_relative = 1e-6);
        assert!(pressure > 100.0, "{pressure}");
        let mut pressed = hollow_ball(None);
        let part = pressed.loads.cavities[0].part.clone();
        let amplitude = Amplitude::Constant;
        pressed.loads.pressures = vec![Pressure { name: "p".into(), part, pressure, amplitude }];
        let (_, other) = solved(&pressed, newton());
        let apart = difference(&state.displacement, &other.displacement);
        assert!(apart < 1e-5, "{apart:e}");
    }
}

#[test]
fn relaxation_and_newton_agree_on_a_filled_ball() {
    let mut problem = hollow_ball(fluid(2e4, 5e-5));
    problem.loads.cavities[0].fluid.as_mut().unwrap().amplitude =
        Amplitude::Smooth { duration: 1.0 };
    let (_, one) = solved(&problem, newton());
    let relaxed = Relaxation { tolerance: 1e-6, ..Relaxation::default() };
    let (_, two) = solved(&problem, Motion::Relaxed(relaxed));
    let apart = difference(&one.displacement, &two.displacement);
    assert!(apart < 1e-4, "{apart:e}");
}

#[test]
fn a_fluid_without_stiffness_is_refused_by_its_field() {
    let found = hollow_ball(fluid(0.0, 1e-5)).check();
    assert_eq!(found[0].field, "loads.cavities[0].fluid.bulk_modulus");
}

/// An eighth of an incompressible hollow ball that a fluid widens to some inner radius.
fn inflated_eighth(stretch: f64) -> (f64, f64) {
    let (inner, outer, mu) = (1.0, 2.0, 1000.0);
    let ball = |radius| Shape::Sphere { centre: Vector3::zeros(), radius };
    let without = |body, hole| Shape::Difference(Box::new(body), Box::new(hole));
    let half = |normal| Shape::HalfSpace { point: Vector3::zeros(), normal };
    let shell = without(ball(outer), ball(inner));
    let eighth = [Vector3::x(), Vector3::y(), Vector3::z()]
        .into_iter()
        .fold(shell, |body, n| without(body, half(n)));
    let law = material(nearly_incompressible(mu));
    let mut problem = Problem::new(eighth, law, Recipe::with_spacing(0.25));
    let name = |k: usize| ["x", "y", "z"][k];
    let held = |k: usize, j: usize| (j == k).then_some(0.0);
    problem.conditions = (0..3)
        .map(|k| condition(name(k), face(k, 0.0), [held(k, 0), held(k, 1), held(k, 2)]))
        .collect();
    let hole = Selector::Inside { shape: ball(inner), tolerance: 0.01 };
    let faces = Selector::Union((0..3).map(|k| face(k, 0.0)).collect());
    let part = Selector::Intersection(vec![hole, Selector::Not(Box::new(faces))]);
    let whole = std::f64::consts::PI / 6.0 * inner * inner * inner;
    let inflow = whole * (stretch.powi(3) - 1.0);
    let amplitude = Amplitude::Linear { duration: 1.0 };
    let fluid = Some(Fluid { bulk_modulus: Fluid::WATER, inflow, amplitude });
    problem.loads.cavities =
        vec![Cavity { opening: Some(Vector3::zeros()), ..cavity(part, fluid) }];
    let (model, state) = solved(&problem, newton());
    let found = only(&model).state(1.0, &state.displacement, 3).pressure;
    let outside = ((outer.powi(3) + stretch.powi(3) - 1.0) / outer.powi(3)).cbrt();
    let of = |stretch: f64| 4.0 / stretch + stretch.powi(-4);
    (found, 0.5 * mu * (of(outside) - of(stretch)))
}

#[test]
fn a_ball_is_inflated_beyond_the_peak_of_its_pressure() {
    let found = [1.5, 1.9, 2.2].map(inflated_eighth);
    for (found, exact) in found {
        approx::assert_relative_eq!(found, exact, max_relative = 0.03);
    }
    assert!(found[2].0 < found[1].0, "{found:?}");
}

#[test]
fn the_audit_is_silent_on_a_cavity_and_doubts_one_of_another_volume() {
    let problem = Problem { motion: newton(), ..hollow_ball(fluid(1e7, 1e-5)) };
    let solved = solve_by(&problem, newton());
    assert_eq!(doubts(&problem, &solved), []);
    let mut stated = problem.clone();
    let half = Shape::HalfSpace { point: CENTRE.into(), normal: Vector3::z() };
    let half = Selector::Inside { shape: half, tolerance: 0.0 };
    let whole = stated.loads.cavities[0].part.clone();
    stated.loads.cavities[0].part = Selector::Intersection(vec![whole, half]);
    assert!(doubts(&stated, &solved).contains(&Kind::CavityVolume));
}
