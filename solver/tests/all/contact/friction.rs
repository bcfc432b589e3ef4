//! Coulomb friction along rigid obstacles, against a point mass.

use crate::common::*;
use mtled::algebra::tensor::{Vector3, rotation, vector_at};
use mtled::geometry::Selector;
use mtled::model::Model;
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::problem::*;
use mtled::simulation::Simulation;

const GRAVITY: f64 = 9.81;

/// A stiff square in plane strain that lies on a plane tilted by `angle` \[rad\] towards −x. Its
/// weight grows within 0.05 s, so that it does not bounce, and is never lifted.
fn on_a_slope(angle: f64, friction: f64, speed: f64) -> Problem {
    let tilt = rotation(&Vector3::z(), angle);
    let mut problem = with_law(tilted_square(4, angle), neo_hookean(100_000.0, 0.3));
    gravity(&mut problem, Vector3::new(0.0, -GRAVITY, 0.0));
    problem.loads.body_forces[0].amplitude = Amplitude::Smooth { duration: RAMP };
    let velocity = tilt * Vector3::x() * -speed;
    problem.loads.initial_velocities = vec![(Selector::All, velocity.into())];
    problem.obstacles.push(floor(0.0, tilt * Vector3::y(), Friction::Coulomb(friction)));
    problem
}

const RAMP: f64 = 0.05;

fn run(mut problem: Problem, end: f64, damping: f64) -> (Model, State) {
    problem.motion = Motion::dynamic(end, damping);
    let (_, model) = build(&problem);
    let mut state = State::new(&model);
    simulate(&model, &problem.motion, &mut state, &mut Unobserved).unwrap();
    (model, state)
}

/// Velocity \[m/s\] of the centre of mass down the slope.
fn speed(model: &Model, state: &State, angle: f64) -> f64 {
    let nodes = 0..model.positions.len();
    let momentum: Vector3 =
        nodes.map(|n| model.lumped_mass[n] * vector_at(&state.velocity, n, 2)).sum();
    let mass: f64 = model.lumped_mass.iter().sum();
    -momentum.dot(&(rotation(&Vector3::z(), angle) * Vector3::x())) / mass
}

#[test]
fn a_block_slides_down_a_slope_with_what_friction_leaves_of_its_weight() {
    let (angle, friction, end) = (0.5f64, 0.3, 0.3);
    let (model, state) = run(on_a_slope(angle, friction, 0.0), end, 0.0);
    // The weight acts for the end less half of the time in which it grows.
    let exact = GRAVITY * (angle.sin() - friction * angle.cos()) * (end - 0.5 * RAMP);
    let found = speed(&model, &state, angle);
    assert!((found / exact - 1.0).abs() < 0.02, "{found} {exact}");
}

#[test]
fn friction_above_the_tangent_of_a_slope_holds_a_block() {
    let angle = 0.3f64;
    let (_, state) = run(on_a_slope(angle, 1.2 * angle.tan(), 0.0), 1.0, 60.0);
    assert!(largest(&state.velocity) < 1e-5, "{:e} m/s", largest(&state.velocity));
    assert!(largest(&state.displacement) < 0.01 * EDGE, "{:e} m", largest(&state.displacement));
}

#[test]
fn a_block_that_slides_on_a_floor_stops_where_its_energy_is_used_up() {
    let (friction, speed) = (0.4, 0.5);
    let mut problem = on_a_slope(0.0, friction, speed);
    problem.motion = Motion::dynamic(0.3, 0.0);
    let mut simulation = Simulation::new(&problem).unwrap();
    let summary = simulation.run(&mut Unobserved).unwrap();
    assert_eq!(summary.contact_loss, None, "friction is asked for, and no reason to warn");
    let (model, state) = (&simulation.model, &simulation.state);
    let slid = -mean_by_mass(model, &state.displacement).x;
    // Half of the ramp passes without weight: s = v (T/2) + v²/(2 μ g), less what the ramp itself has.
    let mut exact = (0.0, speed);
    let step = 1e-5;
    let mut t = 0.0;
    while exact.1 > 0.0 {
        let weight = GRAVITY * Amplitude::Smooth { duration: RAMP }.at(t);
        exact = (exact.0 + exact.1 * step, exact.1 - friction * weight * step);
        t += step;
    }
    assert!((slid / exact.0 - 1.0).abs() < 0.02, "{slid} {}", exact.0);
    let kinetic = 0.5 * model.lumped_mass.iter().sum::<f64>() * speed * speed;
    let lost = state.contact.impacts.lost;
    assert!((lost / kinetic - 1.0).abs() < 0.02, "{lost} {kinetic}");
}

#[test]
fn without_a_coefficient_friction_is_none() {
    let slide = |friction: Friction| {
        let mut problem = on_a_slope(0.5, 0.0, 0.1);
        problem.obstacles[0].friction = friction;
        run(problem, 0.1, 0.0).1.displacement
    };
    let (without, with) = (slide(Friction::Frictionless), slide(Friction::Coulomb(0.0)));
    let difference = without.iter().zip(&with).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(difference < 1e-9 * largest(&without), "{difference:e}");
}

#[test]
fn newtons_method_refuses_friction_that_slides_and_says_what_does_not() {
    let mut problem = on_a_slope(0.0, 0.3, 0.0);
    problem.motion = Motion::Newton(Newton::default());
    let error = Simulation::new(&problem).err().unwrap().to_string();
    assert!(error.contains("use relaxation, or a motion"), "{error}");
}
