//! Conditions, loads and obstacles that contradict each other or have no effect are
//! refused or reported.
#![allow(non_snake_case)]

use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::{Discretisation, Warning};
use mtled::error::Error;
use mtled::geometry::{Extent, Selector, Shape};
use mtled::model::Model;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::problem::*;

fn refusal(problem: &Problem) -> Error {
    let made = Discretisation::new(problem).and_then(|d| Model::new(problem, &d));
    made.map(|_| ()).expect_err("the problem was not refused")
}

fn warnings(problem: &Problem) -> Vec<Warning> {
    build(problem).1.warnings
}

/// A square whose bottom is fixed and whose top moves up by `top` \[m\].
fn stretched(top: f64) -> Problem {
    let mut problem = square(4);
    problem.conditions.push(condition("bottom", face(1, 0.0), [Some(0.0); 3]));
    problem.conditions.push(condition("top", face(1, EDGE), [None, Some(top), None]));
    problem
}

#[test]
fn conditions_that_prescribe_different_values_of_a_node_are_refused_with_both() {
    let mut problem = stretched(0.01);
    problem.conditions.push(condition("lid", face(1, EDGE), [None, Some(0.02), None]));
    let error = refusal(&problem);
    let message = error.to_string();
    let Error::ContradictingConditions { first, second, nodes, node, displacements, .. } = error
    else {
        panic!("{message}")
    };
    assert_eq!((first.as_str(), second.as_str(), nodes), ("top", "lid", 5));
    assert_eq!(displacements, [0.01, 0.02]);
    assert!(message.contains(&format!("at node {node} ")) && message.contains("displacement y"));
}

#[test]
fn conditions_that_part_during_the_run_are_refused_with_the_time() {
    let mut problem = stretched(0.01);
    problem.motion = dynamic(1.0, 1e-3, 0.0);
    problem.conditions[1].amplitude = Amplitude::Table(vec![(0.0, 1.0), (0.5, 1.0), (1.0, 0.0)]);
    problem.conditions.push(condition("lid", face(1, EDGE), [None, Some(0.01), None]));
    let Error::ContradictingConditions { time, .. } = refusal(&problem) else { panic!() };
    assert!(time > 0.5 && time < 0.6, "{time}");
    // Released before they part, the first contradicts nothing.
    problem.conditions[1].release = Some(0.5);
    assert!(matches!(warnings(&problem)[..], [Warning::SharedNodes { .. }]));
}

#[test]
fn conditions_that_agree_on_a_face_are_reported_and_the_first_has_the_force() {
    let mut problem = stretched(0.01);
    problem.conditions.push(condition("lid", face(1, EDGE), [Some(0.0), Some(0.01), None]));
    problem.motion = Motion::Newton(Newton::default());
    let (_, model) = build(&problem);
    let expected = Warning::SharedNodes {
        first: "top".into(),
        second: "lid".into(),
        components: vec!['y'],
        nodes: 5,
    };
    assert_eq!(model.warnings, [expected]);
    let (mut state, mut recorder) = (State::new(&model), Recorder::default());
    simulate(&model, &problem.motion, &mut state, &mut recorder).unwrap();
    let [bottom, top, lid] = recorder.reactions[..] else { panic!() };
    assert!(top.force.y > 0.0 && lid.force.y == 0.0 && lid.force.x.abs() > 0.0);
    let sum = bottom.force + top.force + lid.force;
    assert!(sum.norm() < 1e-8 * top.force.norm(), "{sum}");
}

#[test]
fn an_edge_between_two_faces_that_agree_is_not_reported() {
    let mut problem = stretched(0.01);
    problem.conditions.push(condition("left", face(0, 0.0), [Some(0.0), None, None]));
    assert_eq!(warnings(&problem), []);
    let mut problem = cube(4);
    for axis in 0..3 {
        problem.conditions.push(condition(
            &format!("face {axis}"),
            face(axis, 0.0),
            [Some(0.0); 3],
        ));
    }
    assert_eq!(warnings(&problem), []);
}

#[test]
fn a_body_inside_an_obstacle_at_the_start_is_refused_with_its_deepest_node() {
    let mut problem = stretched(0.01);
    let mut floor = floor(0.0, Vector3::y(), Friction::Frictionless);
    floor.offset = 1.0;
    problem.obstacles.push(floor);
    let Error::NodesInObstacle { name, nodes, position, depth, .. } = refusal(&problem) else {
        panic!()
    };
    assert_eq!((name.as_str(), nodes, position.y), ("obstacle", 25, 0.0));
    assert!((depth - 1.0).abs() < 1e-12);
}

#[test]
fn nodes_slightly_inside_an_obstacle_at_the_start_are_reported() {
    let mut problem = stretched(0.01);
    problem.obstacles.push(floor(0.05 * EDGE / 4.0, Vector3::y(), Friction::Frictionless));
    let [Warning::StartInsideObstacle { nodes: 5, depth, .. }] = warnings(&problem)[..] else {
        panic!()
    };
    assert!((depth - 0.05 * EDGE / 4.0).abs() < 1e-12);
    // Round-off is no contradiction.
    problem.obstacles[0] = floor(1e-12, Vector3::y(), Friction::Frictionless);
    assert_eq!(warnings(&problem), []);
}

#[test]
fn a_condition_that_drives_nodes_into_an_obstacle_is_refused_with_the_time() {
    let mut problem = stretched(0.0);
    problem.motion = dynamic(1.0, 1e-3, 0.0);
    problem.conditions[1] = condition("press", face(1, EDGE), [Some(0.0), Some(0.02), None]);
    problem.conditions[1].amplitude = Amplitude::Linear { duration: 1.0 };
    let ceiling = floor(-(EDGE + 0.01), -Vector3::y(), Friction::Frictionless);
    problem.obstacles.push(ceiling);
    let message = refusal(&problem).to_string();
    let Error::DrivenIntoObstacle { condition: by, nodes, time, .. } = refusal(&problem) else {
        panic!("{message}")
    };
    assert_eq!((by.as_str(), nodes), ("press", 5));
    assert!(time > 0.5 && time < 0.75, "{time}");
    problem.conditions[1] = condition("press", face(1, EDGE), [Some(0.0), Some(0.01), None]);
    assert_eq!(warnings(&problem), []);
}

#[test]
fn nodes_that_an_obstacle_cannot_push_are_reported_where_they_end_inside_it() {
    let mut problem = stretched(0.0);
    problem.conditions[1] = condition("guide", face(1, EDGE), [None, Some(0.0), None]);
    problem.obstacles.push(floor(-(EDGE + 0.01), -Vector3::y(), Friction::Frictionless));
    let (_, model) = build(&problem);
    let moved = |by: f64| field(&model, |X| Vector3::y() * (X.y / EDGE * by));
    assert_eq!(model.contact.penetrations(&model.positions, 1.0, &moved(0.01)), []);
    let found = model.contact.penetrations(&model.positions, 1.0, &moved(0.02));
    let [Warning::EndInsideObstacle { nodes: 5, depth, .. }] = found[..] else { panic!() };
    assert!((depth - 0.01).abs() < 1e-12);
}

#[test]
fn an_obstacle_of_which_its_offset_leaves_nothing_is_refused_by_name() {
    let ball = Shape::Sphere { centre: Vector3::new(0.3, 0.0, 0.0), radius: 0.05 };
    let with_offset = |offset: f64| {
        let mut problem = stretched(0.01);
        let ball = obstacle(ball.clone(), ObstacleSide::Outside, Friction::Frictionless);
        problem.obstacles.push(Obstacle { offset, ..ball });
        problem
    };
    let error = refusal(&with_offset(-0.1));
    assert!(matches!(error, Error::EmptyObstacle { ref name } if name == "obstacle"), "{error}");
    assert_eq!(warnings(&with_offset(-0.02)), []);
}

#[test]
fn an_initial_velocity_of_no_node_is_refused_by_its_number() {
    let mut problem = square(4);
    problem.loads.initial_velocities =
        vec![(Selector::All, Vector3::x().into()), (face(0, 0.0), Vector3::y().into())];
    assert!(matches!(refusal(&problem), Error::EmptyInitialVelocity { index: 1 }));
    problem.loads.initial_velocities.swap(0, 1);
    assert_eq!(warnings(&problem), []);
}

#[test]
fn a_region_without_a_point_is_reported_unless_it_is_the_rest() {
    let mut problem = square(4);
    let part = Shape::Sphere { centre: Vector3::repeat(9.0), radius: 0.01 };
    let far = Selector::Inside { shape: part, tolerance: 0.0 };
    problem
        .regions
        .insert(0, Region { name: "tumour".into(), part: far, ..problem.regions[0].clone() });
    assert_eq!(warnings(&problem), [Warning::EmptyRegion { name: "tumour".into() }]);
    problem.regions[0].part = Selector::All;
    assert_eq!(warnings(&problem), []);
}

#[test]
fn a_traction_on_prescribed_nodes_only_is_reported() {
    let mut problem = stretched(0.01);
    let pull = |part: Selector, traction: Vector3| Traction {
        name: "pull".into(),
        part,
        traction: traction.into(),
        amplitude: Amplitude::Constant,
    };
    problem.loads.tractions = vec![pull(face(1, EDGE), Vector3::y())];
    assert_eq!(warnings(&problem), [Warning::CarriedTraction { name: "pull".into() }]);
    problem.loads.tractions = vec![pull(face(1, EDGE), Vector3::x())];
    assert_eq!(warnings(&problem), []);
}

#[test]
fn a_static_load_that_ends_before_its_amplitude_is_reported() {
    let mut problem = stretched(0.01);
    problem.conditions[1].amplitude = Amplitude::Linear { duration: 4.0 };
    problem.motion = Motion::Relaxed(Relaxation::default());
    let found = warnings(&problem);
    let [Warning::UnfinishedLoad { name, factor, .. }] = &found[..] else { panic!("{found:?}") };
    assert_eq!((name.as_str(), *factor), ("top", 0.25));
    problem.conditions[1].amplitude = Amplitude::Linear { duration: 1.0 };
    assert_eq!(warnings(&problem), []);
}

#[test]
fn a_static_rotation_that_begins_beyond_half_a_turn_is_reported() {
    let mut problem = stretched(0.01);
    problem.motion = Motion::Relaxed(Relaxation::default());
    let (point, axis) = (Vector3::zeros(), Vector3::z());
    problem.conditions[1].prescribed = Prescribed::Rotation { point, axis, angle: -4.0 };
    problem.conditions[1].amplitude = Amplitude::Constant;
    let sudden = |warning: &Warning| matches!(warning, Warning::SuddenTurn { .. });
    assert!(warnings(&problem).iter().any(sudden));
    problem.conditions[1].amplitude = Amplitude::Linear { duration: 1.0 };
    assert!(!warnings(&problem).iter().any(sudden));
}

#[test]
fn a_condition_that_is_released_before_a_static_load_ends_is_reported() {
    let mut problem = stretched(0.01);
    problem.motion = Motion::Relaxed(Relaxation::default());
    problem.conditions[1].release = Some(0.5);
    let found = warnings(&problem);
    let early = |warning: &Warning| match warning {
        Warning::ReleasedEarly { name, release, .. } => name == "top" && *release == 0.5,
        _ => false,
    };
    assert!(found.iter().any(early), "{found:?}");
    problem.conditions[1].release = Some(2.0);
    assert_eq!(warnings(&problem), []);
}

/// What a condition holds includes the weight of its own nodes.
#[test]
fn the_reaction_of_a_held_volume_carries_the_whole_weight() {
    let mut problem = square(6);
    let lower = Shape::HalfSpace { point: Vector3::repeat(0.5 * EDGE), normal: Vector3::y() };
    let part = Selector::Inside { shape: lower, tolerance: 0.0 };
    problem.conditions = vec![EssentialCondition {
        extent: Extent::Volume,
        ..condition("root", part, [Some(0.0); 3])
    }];
    gravity(&mut problem, Vector3::new(0.0, -9.81, 0.0));
    problem.motion = Motion::Newton(Newton::default());
    let (_, model) = build(&problem);
    let (mut state, mut recorder) = (State::new(&model), Recorder::default());
    simulate(&model, &problem.motion, &mut state, &mut recorder).unwrap();
    let weight = 9.81 * model.lumped_mass.iter().sum::<f64>();
    let ratio = recorder.reactions[0].force.y / weight;
    assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
}
