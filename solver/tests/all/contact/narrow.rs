//! Obstacles that are narrow for the spacing of the nodes, or thin for the step.

use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::error::Error;
use mtled::geometry::Shape;
use mtled::model::Model;
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::problem::*;

const SPACING: f64 = EDGE / 10.0;

fn solid(shape: Shape) -> Obstacle {
    obstacle(shape, ObstacleSide::Outside, Friction::Frictionless)
}

/// A soft block whose top is moved down by two spacings on what lies under its middle.
fn pressed(shape: Shape, cells: usize) -> Problem {
    let mut problem = with_law(cube(cells), neo_hookean(3000.0, 0.3));
    let mut top = condition("top", face(2, EDGE), [Some(0.0), Some(0.0), Some(-2.0 * SPACING)]);
    top.amplitude = Amplitude::Linear { duration: 1.0 };
    problem.conditions.push(top);
    problem.obstacles.push(solid(shape));
    problem.motion = Motion::Static(Relaxation::default());
    problem
}

/// Upward force of the obstacle \[N\], and what the run leaves unresolved.
fn force_of(problem: &Problem) -> (f64, usize) {
    let (discretisation, model) = build(problem);
    let mut state = State::new(&model);
    simulate(&model, &problem.motion, &mut state, &mut Unobserved).unwrap();
    let force = state.contact_forces().iter().map(|contact| contact.force.z).sum();
    (force, model.contact.unresolved(&discretisation, state.time, &state.displacement).len())
}

fn ball(aside: f64) -> Shape {
    let radius = 0.4 * SPACING;
    let middle = 0.5 * EDGE + aside;
    Shape::Sphere { centre: Vector3::new(middle, middle, -radius), radius }
}

#[test]
fn a_ball_narrower_than_a_spacing_is_met_or_said_to_be_in_the_body_wherever_nodes_are() {
    for aside in [0.0, 0.25 * SPACING, 0.5 * SPACING] {
        let (force, unresolved) = force_of(&pressed(ball(aside), 10));
        assert!(force > 0.02 || unresolved == 1, "{aside}: {force} N, {unresolved}");
    }
}

#[test]
fn a_plate_thinner_than_a_correction_is_not_crossed_in_statics() {
    let (lower, upper) = (Vector3::new(-1.0, -1.0, -0.003), Vector3::new(1.0, 1.0, -0.001));
    let (force, unresolved) = force_of(&pressed(Shape::Box { min: lower, max: upper }, 10));
    let half_space = Shape::HalfSpace { point: Vector3::z() * -0.001, normal: Vector3::z() };
    let (expected, _) = force_of(&pressed(half_space, 10));
    // The tolerance of either run.
    assert!((force / expected - 1.0).abs() < 1e-3, "{force} N of {expected} N");
    assert_eq!(unresolved, 0);
}

/// A block thrown on a plate at this speed \[m/s\]; its lowest node after it has gone on for
/// twice its way.
fn thrown(thickness: f64, speed: f64) -> f64 {
    let mut problem = with_law(cube(5), neo_hookean(3e5, 0.3));
    let (lower, upper) =
        (Vector3::new(-1.0, -1.0, -0.005 - thickness), Vector3::new(1.0, 1.0, -0.005));
    problem.obstacles.push(solid(Shape::Box { min: lower, max: upper }));
    problem
        .loads
        .initial_velocities
        .push((mtled::geometry::Selector::All, (Vector3::z() * -speed).into()));
    problem.motion = Motion::dynamic(0.012 / speed, 0.0);
    let (_, model) = build(&problem);
    let mut state = State::new(&model);
    simulate(&model, &problem.motion, &mut state, &mut Unobserved).unwrap();
    lowest(&model, &state)
}

fn lowest(model: &Model, state: &State) -> f64 {
    let height = |&node: &u32| model.contact.place(node, &model.positions, &state.displacement).z;
    model.contact.nodes.iter().map(height).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_plate_that_is_thin_for_the_step_is_not_crossed() {
    for (thickness, speed) in [(2e-3, 2.0), (2e-4, 1.0), (2e-5, 2.0)] {
        let lowest = thrown(thickness, speed);
        assert!(lowest > -0.005 - 1e-8, "{thickness} m, {speed} m/s: {lowest}");
    }
}

#[test]
fn an_obstacle_inside_the_body_between_its_nodes_is_refused() {
    let centre = Vector3::repeat(0.55 * EDGE);
    let problem = pressed(Shape::Sphere { centre, radius: 0.3 * SPACING }, 10);
    let discretisation = mtled::discretisation::Discretisation::new(&problem).unwrap();
    let refused = Model::new(&problem, &discretisation).unwrap_err();
    assert!(matches!(refused, Error::ObstacleInBody { .. }), "{refused}");
}

#[test]
fn a_large_floor_is_met_by_nodes_alone() {
    let floor =
        Shape::Box { min: Vector3::new(-1.0, -1.0, -1.0), max: Vector3::new(1.0, 1.0, 0.0) };
    let half_space = Shape::HalfSpace { point: Vector3::zeros(), normal: Vector3::z() };
    let [a, b] = [floor, half_space].map(|shape| force_of(&pressed(shape, 5)));
    assert!((a.0 / b.0 - 1.0).abs() < 1e-9, "{a:?} {b:?}");
}
