//! Unsound input and failed runs give errors that locate the cause.

use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::{Discretisation, Warning};
use mtled::error::Error;
use mtled::force::Workspace;
use mtled::geometry::{Selector, Shape};
use mtled::material::{ElasticConstants, Law, MaterialError, MooneyRivlin, NeoHookeanLogJ};
use mtled::model::Model;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::motion::summary::Summary;
use mtled::problem::*;
use mtled::simulation::Simulation;

fn refusal(problem: &Problem) -> Error {
    let made = Discretisation::new(problem).and_then(|d| Model::new(problem, &d));
    made.expect_err("the problem was not refused")
}

/// The error of a run that must fail, the observations until then and the last state.
fn failure(problem: &Problem) -> (Error, Recorder, State, Model) {
    let (_, model) = build(problem);
    let (mut state, mut recorder) = (State::new(&model), Recorder::default());
    let result: Result<Summary, Error> =
        simulate(&model, &problem.motion, &mut state, &mut recorder);
    (result.expect_err("the run did not fail"), recorder, state, model)
}

#[test]
fn a_condition_that_selects_nothing_is_refused_by_name() {
    let mut problem = square(4);
    problem.conditions.push(condition("far face", face(0, 5.0), [Some(0.0); 3]));
    let error = refusal(&problem);
    assert!(matches!(error, Error::EmptySelection { .. }));
    assert!(error.to_string().contains("far face"), "{error}");
}

#[test]
fn a_number_that_cannot_be_used_is_refused_by_its_field() {
    let mut problem = square(4);
    problem.motion = Motion::Relaxed(Relaxation { tolerance: 2.0, ..Relaxation::default() });
    let error = refusal(&problem);
    assert_eq!(error.to_string(), "motion.tolerance is 2; it must lie in (0, 1)");
    let (_, model) = build(&square(4));
    let (mut state, mut recorder) = (State::new(&model), Recorder::default());
    let error = simulate(&model, &problem.motion, &mut state, &mut recorder).unwrap_err();
    assert!(matches!(error, Error::Mistake(_)), "{error}");
    let step = StepControl { safety_factor: 1.3, ..StepControl::default() };
    problem.motion = Motion::Dynamic { end: 1.0, step, damping: 0.0 };
    let message = refusal(&problem).to_string();
    assert_eq!(message, "motion.step.safety_factor is 1.3; it must lie in (0, 1]");
}

#[test]
fn a_simulation_runs_once() {
    let mut problem = square(4);
    problem.motion = Motion::dynamic(1e-3, 0.0);
    let mut simulation = Simulation::new(&problem).unwrap();
    simulation.run(&mut Recorder::default()).unwrap();
    let error = simulation.run(&mut Recorder::default()).unwrap_err();
    assert!(matches!(error, Error::HasRun { time } if time >= 1e-3), "{error}");
}

#[test]
fn moduli_beyond_what_numbers_hold_are_named_before_the_first_step() {
    let mut problem = square(4);
    problem.motion = Motion::dynamic(1e-3, 0.0);
    let constants = ElasticConstants::from_young_poisson(1e308, 0.3).unwrap();
    problem.regions[0].material.law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants));
    let (_, model) = build(&problem);
    let (mut state, mut recorder) = (State::new(&model), Recorder::default());
    let error = simulate(&model, &problem.motion, &mut state, &mut recorder).unwrap_err();
    assert!(matches!(error, Error::NoTimeStep { .. }), "{error}");
    assert!(!error.to_string().contains("step was NaN"), "{error}");
}

#[test]
fn a_traction_on_no_part_of_the_boundary_is_refused_by_name() {
    let mut problem = square(4);
    problem.loads.tractions.push(Traction {
        name: "pressure".into(),
        part: face(0, 5.0),
        traction: Vector3::x().into(),
        amplitude: Amplitude::Constant,
    });
    let error = refusal(&problem);
    assert!(matches!(error, Error::EmptyTraction { .. }));
    assert!(error.to_string().contains("pressure"), "{error}");
}

#[test]
fn a_grid_without_a_point_in_the_body_is_refused() {
    let mut problem = cube(4);
    let core = Shape::Sphere { centre: Vector3::repeat(0.5 * EDGE), radius: 0.03 };
    problem.body = Shape::Difference(Box::new(problem.body), Box::new(core));
    problem.recipe.grid.inside = InsideRule::Centre;
    problem.recipe.grid.cell = 2.0 * EDGE;
    assert!(matches!(refusal(&problem), Error::NoQuadraturePoints));
}

#[test]
fn a_point_without_a_region_is_refused_with_its_place() {
    let mut problem = square(4);
    let half = Shape::HalfSpace { point: Vector3::repeat(0.05), normal: Vector3::x() };
    problem.regions[0].part = Selector::Inside { shape: half, tolerance: 0.0 };
    let Error::PointWithoutRegion { position } = refusal(&problem) else { panic!() };
    assert!(position.x > 0.05);
}

#[test]
fn a_support_that_stays_too_small_is_refused_with_its_place_and_size() {
    let mut problem = cube(4);
    let centre = Vector3::repeat(0.5 * EDGE);
    let faces = [0, 1, 2].map(|k| [-0.5, 0.5].map(|side| (k, side * EDGE)));
    let mut face_centres = vec![centre; 6];
    for (node, (k, side)) in face_centres.iter_mut().zip(faces.into_iter().flatten()) {
        node[k] += side;
    }
    problem.recipe.cloud = Cloud::Given { nodes: face_centres };
    let Error::SmallSupport { support_size, smallest, position, .. } = refusal(&problem) else {
        panic!()
    };
    assert!(support_size < smallest && smallest == 8);
    let message = refusal(&problem).to_string();
    assert!(message.contains(&format!("{:.6}", position.x)), "{message}");
}

#[test]
fn a_poor_support_is_enlarged_with_a_warning() {
    let mut problem = cube(4);
    problem.recipe.dilation = 1.05;
    let warnings = Discretisation::new(&problem).unwrap().warnings();
    assert!(
        warnings
            .iter()
            .any(|w| matches!(w, Warning::EnlargedSupports { points, of } if points <= of)),
        "{warnings:?}"
    );
}

#[test]
fn a_node_that_no_point_covers_is_refused_with_its_place() {
    let mut problem = square(8);
    problem.recipe.grid.cell = 0.5 * EDGE;
    let Error::UncoveredNode { node, position } = refusal(&problem) else { panic!() };
    let (cloud, _) = build(&square(8));
    assert_eq!(cloud.cloud.positions[node], position);
}

#[test]
fn a_node_whose_row_sum_is_negative_is_refused_with_its_place_and_mass() {
    let mut problem = quadratic(cube(4));
    problem.recipe.mass = MassRule::RowSum;
    let error = refusal(&problem);
    assert!(matches!(error, Error::MasslessNode { mass, .. } if mass < 0.0), "{error}");
    assert!(error.to_string().contains("even_split"), "{error}");
    // Statics need the sum alone.
    problem.motion = Motion::Newton(Newton::default());
    let (discretisation, model) = build(&problem);
    let right = 1000.0 * discretisation.volume();
    assert!((model.lumped_mass.iter().sum::<f64>() / right - 1.0).abs() < 1e-12);
}

#[test]
fn a_cloud_with_an_isolated_node_is_refused_with_the_place_of_the_gap() {
    let mut problem = square(8);
    let (whole, _) = build(&problem);
    let mut nodes = whole.cloud.positions;
    let lone = nodes.iter().copied().max_by(|a, b| (a.x + a.y).total_cmp(&(b.x + b.y))).unwrap();
    nodes.retain(|node| node.x < 0.4 * EDGE || *node == lone);
    problem.recipe.cloud = Cloud::Given { nodes };
    let Error::SmallSupport { position, support_size, smallest, .. } = refusal(&problem) else {
        panic!()
    };
    assert!(support_size < smallest);
    assert!(position.x > 0.4 * EDGE, "{position}");
}

#[test]
fn a_probe_outside_every_influence_domain_is_refused_with_its_place() {
    let (discretisation, _) = build(&square(4));
    let error = discretisation.rows_at(&[Vector3::repeat(7.0)]).unwrap_err();
    assert!(matches!(error, Error::ProbeOutside { .. }));
    assert!(error.to_string().contains("7.000000"), "{error}");
}

#[test]
fn fewer_points_than_nodes_give_a_warning_that_names_hourglassing() {
    let mut problem = square(6);
    problem.recipe.grid.cell = EDGE / 5.0;
    let warnings = Discretisation::new(&problem).unwrap().warnings();
    assert_eq!(warnings[0], Warning::FewerPointsThanNodes { points: 25, nodes: 49 });
    assert!(warnings[0].to_string().contains("hourglassing"));
}

#[test]
fn a_sound_recipe_gives_no_warning() {
    assert!(build(&square(6)).0.warnings().is_empty());
    assert!(build(&cube(4)).0.warnings().is_empty());
}

#[test]
fn a_rubber_that_softens_in_tension_is_refused_with_the_smallest_ratio() {
    let error = MooneyRivlin::new(1052.0, 0.0, 0.3).unwrap_err();
    assert!(matches!(error, MaterialError::UnstableRubber { smallest, .. } if smallest == 0.4));
    assert!(error.to_string().contains("0.4000"), "{error}");
}

#[test]
fn a_fixed_step_above_the_critical_one_is_refused_with_both() {
    let mut problem = square(4);
    problem.motion = dynamic(1.0, 0.5, 0.0);
    let (error, recorder, state, _) = failure(&problem);
    let Error::UnstableStep { fixed, critical } = error else { panic!("{error}") };
    assert!(fixed == 0.5 && critical < 0.5);
    assert_eq!((recorder.observations, state.step), (0, 0));
}

#[test]
fn a_diverging_body_is_reported_with_step_time_and_node() {
    let mut problem = square(4);
    gravity(&mut problem, Vector3::new(0.0, 1e9, 0.0));
    problem.loads.body_forces[0].amplitude =
        Amplitude::Table(vec![(0.0, 0.0), (0.0049, 0.0), (0.005, 1.0)]);
    problem.motion = dynamic(1.0, 1e-3, 0.0);
    let (error, recorder, state, model) = failure(&problem);
    let message = error.to_string();
    let Error::Diverged { step, time, node, position, displacement, time_step } = error else {
        panic!("{message}")
    };
    assert_eq!(step, 6);
    assert!((time - 0.006).abs() < 1e-12 && (time_step - 1e-3).abs() < 1e-12);
    assert!(displacement > EDGE && position == model.positions[node]);
    assert!(message.contains("step 6"), "{message}");
    // The observer is not notified of the last step; the state includes it.
    assert_eq!((recorder.observations, state.step), (6, 6));
}

/// A square between its base and a press that moves down by `fraction` of its edge.
fn pressed(fraction: f64, duration: f64) -> Problem {
    let mut problem = square(6);
    problem.conditions.push(condition("base", face(1, 0.0), [None, Some(0.0), None]));
    let mut press = condition("press", face(1, EDGE), [None, Some(-fraction * EDGE), None]);
    press.amplitude = Amplitude::Linear { duration };
    problem.conditions.push(press);
    problem
}

#[test]
fn a_fixed_step_that_compression_makes_unstable_ends_in_an_error() {
    let mut problem = pressed(0.7, 0.5);
    let (_, model) = build(&problem);
    let rest = vec![0.0; model.size()];
    let mut workspace = Workspace::new(&model.points);
    let critical = critical_time_step(&model, &rest, 0.0, None, &mut workspace).time_step;
    problem.motion = dynamic(10.0, 0.98 * critical, 0.0);
    let (error, recorder, state, _) = failure(&problem);
    assert!(matches!(error, Error::Diverged { .. } | Error::Inverted { .. }), "{error}");
    assert!(recorder.observations == state.step && state.step > 1);
}

#[test]
fn a_point_that_turns_inside_out_is_reported_with_its_index_place_and_jacobian() {
    let mut problem = pressed(1.5, 0.02);
    problem.motion = dynamic(0.02, 1e-3, 0.0);
    let (error, recorder, state, model) = failure(&problem);
    let message = error.to_string();
    let Error::Inverted { step, time, point, position, jacobian } = error else {
        panic!("{message}")
    };
    assert!(jacobian <= 0.0 && position == model.point_positions[point]);
    assert!(step == state.step && time == state.time && recorder.observations == step);
    assert!(message.contains(&format!("point {point} ")), "{message}");
}

#[test]
fn a_point_that_the_last_step_turns_inside_out_is_reported() {
    let mut problem = pressed(1.5, 0.02);
    problem.motion = dynamic(0.02, 1e-3, 0.0);
    let (.., state, _) = failure(&problem);
    problem.motion = dynamic(1e-3 * (state.step - 1) as f64, 1e-3, 0.0);
    assert!(matches!(failure(&problem).0, Error::Inverted { .. }));
}

/// Error, tolerance and residual of a relaxation that must not converge, after
/// `max_steps` steps.
fn unconverged(load_steps: usize, tolerance: f64, max_steps: usize) -> (f64, f64, f64) {
    let mut problem = square(6);
    problem.conditions.push(condition("base", face(1, 0.0), [Some(0.0); 3]));
    gravity(&mut problem, Vector3::new(0.0, -9.81, 0.0));
    let settings = Relaxation { load_steps, tolerance, max_steps, ..Relaxation::default() };
    problem.motion = Motion::Relaxed(settings);
    let (result, _, state, _) = failure(&problem);
    let Error::NotConverged { steps, stalled: false, error, tolerance, residual, .. } = result
    else {
        panic!("{result}")
    };
    assert_eq!((steps, state.step), (max_steps, max_steps));
    (error, tolerance, residual)
}

#[test]
fn a_relaxation_that_runs_out_of_steps_reports_its_convergence() {
    let (error, tolerance, residual) = unconverged(20, 1e-9, 50);
    assert!(error.is_finite() && error > tolerance);
    assert!(residual > 0.0 && residual.is_finite());
}

#[test]
fn a_relaxation_that_ends_before_its_load_reports_finite_numbers() {
    let (error, _, residual) = unconverged(100, 0.5, 40);
    assert!(error.is_finite() && error > 0.0 && residual.is_finite() && residual > 0.0);
}

#[test]
fn a_node_beyond_the_data_or_where_a_field_is_no_number_is_refused_with_its_place() {
    let mut problem = cube(3);
    let data = |y: f64| {
        let corner = |k: usize| Vector3::new((k % 2) as f64 * EDGE, y, (k / 2) as f64 * EDGE);
        (0..4).map(|k| (corner(k), Vector3::x() * 0.01)).collect::<Vec<_>>()
    };
    let scattered = |y: f64, reach: f64| {
        let data = mtled::geometry::Scattered::new(&data(y), reach).unwrap();
        Prescribed::Field(Field::Scattered(std::sync::Arc::new(data)))
    };
    problem.conditions = vec![condition("face", face(1, EDGE), [Some(0.0); 3])];
    problem.conditions[0].prescribed = scattered(EDGE, EDGE);
    let discretisation = Discretisation::new(&problem).unwrap();
    assert!(Model::new(&problem, &discretisation).is_ok());
    problem.conditions[0].prescribed = scattered(0.5 * EDGE, 0.4 * EDGE);
    let message = Model::new(&problem, &discretisation).unwrap_err().to_string();
    assert!(
        message.contains("from its nearest data point, more than the reach of 4.0000e-2 m"),
        "{message}"
    );
    problem.conditions[0].prescribed =
        Prescribed::Field(Field::of(|at| Vector3::x() * (at.x - 1.0).ln()));
    let message = Model::new(&problem, &discretisation).unwrap_err().to_string();
    assert!(message.contains("is not a finite number"), "{message}");
}
