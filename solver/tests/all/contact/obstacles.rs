//! Contact of nodes with rigid obstacles.

use crate::common::*;
use mtled::algebra::tensor::{Vector3, rotation};
use mtled::geometry::{DistanceFunction, Selector, Shape};
use mtled::model::Model;
use mtled::model::rigid_motions::free_rigid_motions;
use mtled::motion::observe::{Unobserved, View};
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::motion::summary::Summary;
use mtled::problem::*;

/// A block one millimetre above a floor, damped so that it rests after half a
/// second.
fn falling(friction: Friction) -> Problem {
    let mut problem = with_law(jittered(cube(4), 0.2, 1), neo_hookean(30000.0, 0.3));
    gravity(&mut problem, Vector3::new(0.0, 0.0, -9.81));
    problem.obstacles.push(floor(-0.001, Vector3::z(), friction));
    problem.motion = Motion::Dynamic { end: 0.5, step: StepControl::default(), damping: 60.0 };
    problem
}

/// Smallest gap of any node to any obstacle \[m\].
fn smallest_gap(model: &Model, state: &State) -> f64 {
    let place = |n: u32| model.contact.place(n, &model.positions, &state.displacement);
    let nodes = 0..model.positions.len() as u32;
    let gaps = |n| model.contact.all_placed(state.time).map(move |(_, o)| o.gap(&place(n)));
    nodes.flat_map(gaps).fold(f64::INFINITY, f64::min)
}

/// Runs a problem and asserts at every step that no node is inside.
fn run_without_penetration(problem: &Problem) -> (Model, State) {
    let (_, model) = build(problem);
    let mut state = State::new(&model);
    let mut observer = EachStep(|view: &mut View| {
        let smallest = smallest_gap(view.model, view.state);
        assert!(
            smallest > -1e-3 * view.model.mean_spacing,
            "gap {smallest:e} m at t = {} s",
            view.state.time
        );
    });
    simulate(&model, &problem.motion, &mut state, &mut observer).unwrap();
    (model, state)
}

#[test]
fn a_falling_block_comes_to_rest_on_the_floor_and_no_node_goes_below() {
    let (model, state) = run_without_penetration(&falling(Friction::Frictionless));
    assert!(largest(&state.velocity) < 1e-4, "{:e} m/s", largest(&state.velocity));
    let on_floor = (0..model.positions.len()).filter(|&n| model.positions[n].z == 0.0).count();
    assert_eq!(state.contact.touching.len(), on_floor);
}

#[test]
fn the_nodes_that_touch_carry_the_weight_of_a_block_at_rest() {
    let (model, state) = run_without_penetration(&falling(Friction::Frictionless));
    let contact_force: f64 = state.contact_forces().iter().map(|contact| contact.force.z).sum();
    let weight = 9.81 * model.lumped_mass.iter().sum::<f64>();
    let ratio = contact_force / weight;
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
}

/// 30° \[rad\].
const SLOPE: f64 = std::f64::consts::FRAC_PI_6;

/// A square in plane strain on a plane that falls by 30° towards −x.
fn on_a_slope(friction: Friction) -> Problem {
    let tilt = rotation(&Vector3::z(), SLOPE);
    let mut problem = with_law(tilted_square(5, SLOPE), neo_hookean(30000.0, 0.3));
    gravity(&mut problem, Vector3::new(0.0, -9.81, 0.0));
    problem.obstacles.push(floor(0.0, tilt * Vector3::y(), friction));
    problem
}

/// Displacement of the centre of mass down the slope \[m\].
fn slid(model: &Model, state: &State) -> f64 {
    let down = rotation(&Vector3::z(), SLOPE) * -Vector3::x();
    mean_by_mass(model, &state.displacement).dot(&down)
}

#[test]
fn without_friction_a_block_slides_down_a_slope_as_a_point_mass_would() {
    let mut problem = on_a_slope(Friction::Frictionless);
    problem.motion = Motion::Dynamic { end: 0.3, step: StepControl::default(), damping: 0.0 };
    let (model, state) = run_without_penetration(&problem);
    let exact = 0.5 * 9.81 * SLOPE.sin() * 0.3 * 0.3;
    let slid = slid(&model, &state);
    assert!((slid / exact - 1.0).abs() < 1e-9, "{slid} {exact}");
}

#[test]
fn without_slip_a_block_stays_on_a_slope() {
    let mut problem = on_a_slope(Friction::NoSlip);
    problem.motion = Motion::Dynamic { end: 1.0, step: StepControl::default(), damping: 60.0 };
    let (model, state) = run_without_penetration(&problem);
    assert!(largest(&state.velocity) < 1e-4, "{:e} m/s", largest(&state.velocity));
    // Touching nodes have not slid, except in the rebound of the first impact
    // (measured: 2.6e-5 m, where a free block moves by 2.45 m).
    assert!(!state.contact.touching.is_empty());
    for &node in &state.contact.touching {
        let place = model.contact.place(node, &model.positions, &state.displacement);
        let slid = (place - model.positions[node as usize]).norm();
        assert!(slid < 1e-3 * EDGE, "{slid:e} m");
    }
}

#[test]
fn nodes_never_leave_a_cavity_grown_by_its_offset() {
    for friction in [Friction::Frictionless, Friction::NoSlip] {
        let mut problem = with_law(cube(3), neo_hookean(30000.0, 0.3));
        let centre = Vector3::repeat(0.5 * EDGE);
        let skull = Shape::Sphere { centre, radius: 0.09 };
        problem
            .obstacles
            .push(Obstacle { offset: 0.002, ..obstacle(skull, ObstacleSide::Inside, friction) });
        problem.loads.initial_velocities.push((Selector::All, Vector3::new(1.0, 0.3, 0.0).into()));
        problem.motion = Motion::Dynamic { end: 0.1, step: StepControl::default(), damping: 0.0 };
        let (_, state) = run_without_penetration(&problem);
        // Without the cavity it would have moved by 0.1 m.
        assert!(largest(&state.displacement) < 0.07);
    }
}

#[test]
fn an_obstacle_out_of_reach_changes_no_bit() {
    let mut problem = jittered(cube(3), 0.2, 1);
    gravity(&mut problem, Vector3::new(0.0, 0.0, -9.81));
    problem.loads.initial_velocities.push((face(0, 0.0), Vector3::x().into()));
    let run = |problem: &Problem| {
        let (_, model) = build(problem);
        let mut state = State::new(&model);
        let motion = dynamic(0.1, 1e-3, 0.0);
        simulate(&model, &motion, &mut state, &mut EachStep(|_: &mut View| ())).unwrap();
        assert!(state.contact.touching.is_empty());
        state.displacement
    };
    let alone = run(&problem);
    problem.obstacles.push(floor(-1.0, Vector3::z(), Friction::Frictionless));
    assert_eq!(alone, run(&problem));
}

#[test]
fn nodes_far_from_the_obstacle_are_not_touched() {
    let (model, state) = run_without_penetration(&falling(Friction::NoSlip));
    for &node in &state.contact.touching {
        assert!(model.positions[node as usize].z < 0.25 * EDGE);
    }
}

#[test]
fn a_scene_without_obstacles_has_an_empty_contact_plan() {
    let (_, model) = build(&cube(3));
    assert!(model.contact.obstacles.is_empty() && model.contact.nodes.is_empty());
}

/// A cube of half the edge that gravity presses onto a floor whose distance function rises
/// by `slope` per length.
fn pressed_onto(slope: f64, safety_factor: f64) -> (Model, State, Summary) {
    let mut problem = with_law(jittered(cube(4), 0.2, 1), neo_hookean(30000.0, 0.3));
    gravity(&mut problem, Vector3::new(0.0, 0.0, -9.81));
    problem.conditions.push(condition("x", face(0, 0.0), [Some(0.0), None, None]));
    problem.conditions.push(condition("y", face(1, 0.0), [None, Some(0.0), None]));
    let reach = Vector3::repeat(10.0 * EDGE);
    let rise = DistanceFunction::new(-reach, reach, move |x: &Vector3| slope * (x.z + 0.001));
    problem.obstacles.push(obstacle(
        Shape::Function(rise),
        ObstacleSide::Outside,
        Friction::Frictionless,
    ));
    let step = StepControl { safety_factor, ..StepControl::default() };
    problem.motion = Motion::Relaxed(Relaxation { step, tolerance: 1e-6, ..Relaxation::default() });
    let (_, model) = build(&problem);
    let mut state = State::new(&model);
    let summary = simulate(&model, &problem.motion, &mut state, &mut Unobserved).unwrap();
    (model, state, summary)
}

#[test]
fn a_node_pressed_against_an_obstacle_comes_to_rest_on_its_surface_whatever_its_distance_function()
{
    for slope in [0.7, 1.0, 1.4] {
        for safety_factor in [0.94, 0.5] {
            let (model, state, _) = pressed_onto(slope, safety_factor);
            for &node in &state.contact.touching {
                let z = model.contact.place(node, &model.positions, &state.displacement).z;
                assert!((z + 0.001).abs() < 1e-9, "slope {slope}, step {safety_factor}: {z}");
            }
        }
    }
}

#[test]
fn the_estimated_error_of_a_body_in_contact_is_that_of_a_body_at_rest() {
    let (model, state, summary) = pressed_onto(1.0, 0.94);
    let estimated = summary.relaxation.unwrap().estimated_error;
    assert!(estimated <= 1e-6 * largest(&state.displacement), "{estimated:e} m");
    let free = free_rigid_motions(&model, state.time, &state.displacement);
    assert_eq!(free, 0, "the floor and two sides hold the block");
}
