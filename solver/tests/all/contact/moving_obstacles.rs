//! Obstacles that move by themselves.
#![allow(non_snake_case)]

use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{Selector, Shape};
use mtled::model::Model;
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::problem::*;

fn moved(mut obstacle: Obstacle, way: RigidWay, amplitude: Amplitude) -> Obstacle {
    obstacle.motions.push(RigidMotion { way, amplitude });
    obstacle
}

fn run(problem: &Problem) -> (Model, State) {
    let (_, model) = build(problem);
    let mut state = State::new(&model);
    simulate(&model, &problem.motion, &mut state, &mut Unobserved).unwrap();
    (model, state)
}

/// A block on a sliding support, and a plate that is pressed on it from above.
fn pressed(motion: Motion) -> Problem {
    let mut problem = with_law(cube(4), neo_hookean(3000.0, 0.3));
    problem.conditions = vec![
        condition("left", face(0, 0.0), [Some(0.0), None, None]),
        condition("front", face(1, 0.0), [None, Some(0.0), None]),
        condition("bottom", face(2, 0.0), [None, None, Some(0.0)]),
    ];
    let plate = floor(-EDGE - 0.001, -Vector3::z(), Friction::Frictionless);
    let down = RigidWay::Translation(Vector3::new(0.0, 0.0, -0.2 * EDGE - 0.001));
    problem.obstacles.push(moved(plate, down, Amplitude::Linear { duration: 1.0 }));
    problem.motion = motion;
    problem
}

/// Force of the plate on the block \[N\], downwards.
fn push(state: &State) -> f64 {
    -state.contact_forces().iter().map(|contact| contact.force.z).sum::<f64>()
}

/// Force \[N\] on a face of a block of a compressible neo-Hookean material that is compressed to a
/// stretch, free at its sides: P = μ(a − 1/a) + λ ln J / a with μ(b − 1/b) + λ ln J / b = 0.
fn compressed(stretch: f64) -> f64 {
    let c = mtled::material::ElasticConstants::from_young_poisson(3000.0, 0.3).unwrap();
    let (mu, lambda) = (c.shear_modulus, c.lame_modulus());
    let side = |b: f64| mu * (b * b - 1.0) + lambda * (stretch * b * b).ln();
    let (mut low, mut high) = (1.0, 2.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if side(middle) < 0.0 { low = middle } else { high = middle }
    }
    let log_j = (stretch * low * low).ln();
    -EDGE * EDGE * (mu * (stretch - 1.0 / stretch) + lambda * log_j / stretch)
}

#[test]
fn a_plate_that_comes_down_compresses_a_block_as_the_closed_form_says() {
    let exact = compressed(0.8);
    let methods = [
        Motion::Newton(Newton::default()),
        Motion::Relaxed(Relaxation { tolerance: 1e-5, ..Relaxation::default() }),
    ];
    for motion in methods {
        let (_, state) = run(&pressed(motion));
        let found = push(&state);
        assert!((found / exact - 1.0).abs() < 2e-3, "{found} {exact}");
    }
}

/// Force \[N\] of a ball that is pressed into a soft block, by a method.
fn indented(motion: Motion, friction: Friction) -> f64 {
    let mut problem = with_law(cube(10), neo_hookean(3000.0, 0.4));
    problem.conditions = vec![condition("bottom", face(2, 0.0), [Some(0.0); 3])];
    let (centre, radius) = (Vector3::new(0.52 * EDGE, 0.47 * EDGE, 1.37 * EDGE), 0.36 * EDGE);
    let ball = Obstacle { friction, ..Obstacle::new("ball", Shape::Sphere { centre, radius }) };
    let down = RigidWay::Translation(Vector3::new(0.0, 0.0, -0.11 * EDGE));
    problem.obstacles.push(moved(ball, down, Amplitude::Smooth { duration: 1.0 }));
    problem.motion = motion;
    push(&run(&problem).1)
}

#[test]
fn newton_relaxation_and_a_slow_motion_agree_on_the_force_of_an_indenter() {
    let newton = indented(Motion::Newton(Newton::default()), Friction::Frictionless);
    let relaxed = indented(Motion::Relaxed(Relaxation::default()), Friction::Frictionless);
    let moved = indented(Motion::dynamic(2.0, 40.0), Friction::Frictionless);
    // On nodal parameters the last two were a quarter of the first: they alternate from node to node.
    assert!((relaxed / newton - 1.0).abs() < 0.01, "{relaxed} {newton}");
    assert!((moved / newton - 1.0).abs() < 0.02, "{moved} {newton}");
}

#[test]
fn relaxation_and_newton_agree_on_an_indenter_that_sticks() {
    let newton = indented(Motion::Newton(Newton::default()), Friction::NoSlip);
    let relaxed = indented(Motion::Relaxed(Relaxation::default()), Friction::NoSlip);
    let rubbed = indented(Motion::Relaxed(Relaxation::default()), Friction::Coulomb(100.0));
    assert!((relaxed / newton - 1.0).abs() < 0.02, "{relaxed} {newton}");
    assert!((rubbed / relaxed - 1.0).abs() < 0.01, "{rubbed} {relaxed}");
}

#[test]
fn the_work_of_a_plate_is_the_strain_energy_of_the_block() {
    let (model, state) = run(&pressed(Motion::Newton(Newton::default())));
    let stored = mtled::force::strain_energy(&model.points, &state.displacement);
    assert!(stored > 0.0 && (state.work.constraint / stored - 1.0).abs() < 1e-12);
}

#[test]
fn a_wall_that_runs_into_a_block_does_what_it_does_to_a_block_that_runs_into_it() {
    let speed = 0.5;
    let block = || {
        let mut problem = with_law(jittered(cube(4), 0.2, 1), neo_hookean(3000.0, 0.3));
        problem.obstacles.push(floor(-0.002, Vector3::z(), Friction::Frictionless));
        problem.motion = Motion::dynamic(0.06, 0.0);
        problem
    };
    let mut thrown = block();
    let down = Vector3::new(0.0, 0.0, -speed);
    thrown.loads.initial_velocities = vec![(Selector::All, down.into())];
    let mut struck = block();
    let (time, way) = (0.06, RigidWay::Translation(Vector3::new(0.0, 0.0, speed * 0.06)));
    let wall = struck.obstacles.remove(0);
    struck.obstacles.push(moved(wall, way, Amplitude::Linear { duration: time }));
    let ((model, thrown), (_, struck)) = (run(&thrown), run(&struck));
    let largest_difference = (0..model.positions.len())
        .map(|node| {
            let seen = struck.displacement_of(node, 3) + down * struck.time;
            (seen - thrown.displacement_of(node, 3)).norm()
        })
        .fold(0.0, f64::max);
    // The steps differ where the tangent is looked at again at other times.
    assert!(largest_difference < 1e-6 * EDGE, "{largest_difference:e}");
    assert!(struck.displacement.iter().skip(2).step_by(3).all(|u| *u > 0.0), "it must be hit");
}

#[test]
fn a_plate_that_turns_twists_a_block_that_sticks_to_it_as_a_prescribed_rotation_does() {
    let (angle, point) = (0.3, Vector3::new(0.5 * EDGE, 0.5 * EDGE, 0.0));
    let base = || {
        let mut problem = collocated(with_law(cube(4), neo_hookean(3000.0, 0.3)));
        problem.conditions = vec![condition("bottom", face(2, 0.0), [Some(0.0); 3])];
        problem.motion = Motion::Newton(Newton::default());
        problem
    };
    let mut by_plate = base();
    let mut plate = floor(-EDGE, -Vector3::z(), Friction::NoSlip);
    let rows = |rows: &[(f64, f64)]| Amplitude::Table(rows.to_vec());
    let turning = RigidWay::Rotation { point, axis: Vector3::z(), angle };
    let down = RigidWay::Translation(Vector3::new(0.0, 0.0, -0.1 * EDGE));
    plate = moved(plate, down, rows(&[(0.0, 0.0), (0.4, 1.0)]));
    plate = moved(plate, turning, rows(&[(0.4, 0.0), (1.0, 1.0)]));
    by_plate.obstacles.push(plate);
    let (_, by_plate) = run(&by_plate);
    let mut prescribed = base();
    let turn = move |X: &Vector3| {
        let turned = mtled::algebra::tensor::rotation(&Vector3::z(), angle);
        let arm = X - point;
        turned * arm - arm - Vector3::new(0.0, 0.0, 0.1 * EDGE)
    };
    prescribed.conditions.push(EssentialCondition {
        prescribed: Prescribed::Field(Field::of(turn)),
        ..condition("top", face(2, EDGE), [None; 3])
    });
    let (_, prescribed) = run(&prescribed);
    let pairs = by_plate.displacement.iter().zip(&prescribed.displacement);
    let difference = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(difference < 1e-6 * largest(&prescribed.displacement), "{difference:e}");
}

#[test]
fn a_belt_carries_a_block_along_until_it_runs_as_fast() {
    let (friction, speed) = (0.3, 0.2);
    let mut problem = with_law(square(4), neo_hookean(100_000.0, 0.3));
    gravity(&mut problem, Vector3::new(0.0, -9.81, 0.0));
    problem.loads.body_forces[0].amplitude = Amplitude::Smooth { duration: 0.05 };
    let belt = floor(0.0, Vector3::y(), Friction::Coulomb(friction));
    let way = RigidWay::Translation(Vector3::x() * speed);
    problem.obstacles.push(moved(belt, way, Amplitude::Table(vec![(0.0, 0.0), (1.0, 1.0)])));
    // Damping takes 2 m/s² at that speed, two thirds of what friction can give.
    problem.motion = Motion::dynamic(0.9, 10.0);
    let (model, state) = run(&problem);
    let mean = (0..model.positions.len())
        .map(|n| model.lumped_mass[n] * state.velocity[2 * n])
        .sum::<f64>()
        / model.lumped_mass.iter().sum::<f64>();
    assert!((mean / speed - 1.0).abs() < 1e-2, "{mean}");
}

#[test]
fn an_obstacle_that_is_driven_into_what_is_held_is_refused_with_the_time() {
    let mut problem = pressed(Motion::Newton(Newton::default()));
    problem.conditions.push(condition("top", face(2, EDGE), [Some(0.0); 3]));
    let discretisation = mtled::discretisation::Discretisation::new(&problem).unwrap();
    let error = Model::new(&problem, &discretisation).err().unwrap();
    let mtled::error::Error::DrivenIntoObstacle { time, .. } = error else { panic!("{error}") };
    assert!(time > 0.0 && time < 1.0, "{time}");
}

#[test]
fn an_obstacle_that_starts_inside_because_it_jumps_there_is_refused() {
    let mut problem = pressed(Motion::Newton(Newton::default()));
    problem.obstacles[0].motions[0].amplitude = Amplitude::Constant;
    let discretisation = mtled::discretisation::Discretisation::new(&problem).unwrap();
    let error = Model::new(&problem, &discretisation).err().unwrap();
    assert!(matches!(error, mtled::error::Error::NodesInObstacle { .. }), "{error}");
}

#[test]
fn a_thin_blade_that_runs_through_nodes_in_a_step_is_seen() {
    let mut problem = with_law(cube(6), neo_hookean(3000.0, 0.3));
    problem.conditions = vec![condition("bottom", face(2, 0.0), [Some(0.0); 3])];
    let shape = Shape::Box {
        min: Vector3::new(-0.5 * EDGE, -0.5 * EDGE, 1.01 * EDGE),
        max: Vector3::new(1.5 * EDGE, 1.5 * EDGE, 1.02 * EDGE),
    };
    let blade = Obstacle::new("blade", shape);
    let down = RigidWay::Translation(Vector3::new(0.0, 0.0, -0.2 * EDGE));
    problem.obstacles.push(moved(blade, down, Amplitude::Linear { duration: 0.02 }));
    problem.motion = Motion::dynamic(0.02, 50.0);
    let (model, state) = run(&problem);
    let top = (0..model.positions.len()).filter(|&n| model.positions[n].z == EDGE);
    for node in top {
        let z = EDGE + state.displacement_of(node, 3).z;
        assert!(z < 0.82 * EDGE, "{z}");
    }
}
