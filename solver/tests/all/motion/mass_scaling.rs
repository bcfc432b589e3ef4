//! Mass scaling: heavier nodes for longer steps.

use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::error::Error;
use mtled::force::Workspace;
use mtled::geometry::{Selector, Shape};
use mtled::model::Model;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::motion::mass_scaling::raise_masses;
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::problem::*;

/// A square with nodes three times closer in a corner, pushed down slowly.
fn pushed(mass_scaling: f64) -> Problem {
    let mut problem = square(10);
    let corner = Vector3::new(0.88 * EDGE, 0.88 * EDGE, -EDGE);
    let shape = Shape::Box { min: corner, max: Vector3::repeat(EDGE) };
    let part = Selector::Inside { shape, tolerance: 0.0 };
    let fine = |size| vec![Refinement { part: part.clone(), size }];
    problem.recipe.grid.refinements = fine(0.002);
    problem.recipe.cloud = Cloud::Graded {
        spacing: EDGE / 10.0,
        refinements: fine(EDGE / 30.0),
        growth: 0.6,
        seed: 0,
    };
    problem.conditions.push(condition("base", face(1, 0.0), [Some(0.0); 3]));
    let mut top = condition("top", face(1, EDGE), [None, Some(-0.1 * EDGE), None]);
    top.amplitude = Amplitude::Smooth { duration: 4.0 };
    problem.conditions.push(top);
    let step = StepControl { mass_scaling, ..StepControl::default() };
    problem.motion = Motion::Dynamic { end: 5.0, step, damping: 5.0 };
    problem
}

fn scaled(problem: &Problem) -> Result<Model, Error> {
    let (discretisation, model) = build(problem);
    raise_masses(model, problem, &discretisation)
}

fn step_at_rest(model: &Model) -> f64 {
    let rest = vec![0.0; model.size()];
    critical_time_step(model, &rest, 0.0, None, &mut Workspace::new(&model.points)).time_step
}

#[test]
fn a_few_heavier_nodes_lengthen_the_step_by_the_factor() {
    let plain = scaled(&pushed(1.0)).unwrap();
    let raised = scaled(&pushed(1.5)).unwrap();
    let ratio = step_at_rest(&raised) / step_at_rest(&plain);
    assert!((1.5..1.5 * 1.02).contains(&ratio), "{ratio}");
    let heavier = raised.inertia.iter().zip(&raised.lumped_mass).filter(|(i, m)| i > m).count();
    assert!(heavier < raised.positions.len() / 2, "{heavier} of {}", raised.positions.len());
    let added: f64 = raised.inertia.iter().sum::<f64>() - raised.lumped_mass.iter().sum::<f64>();
    assert!((added - raised.added_mass).abs() < 1e-12 && added > 0.0, "{added}");
}

#[test]
fn a_slow_push_gives_the_same_displacements_in_fewer_steps() {
    let run = |mass_scaling| {
        let problem = pushed(mass_scaling);
        let model = scaled(&problem).unwrap();
        let mut state = State::new(&model);
        let summary = simulate(&model, &problem.motion, &mut state, &mut Unobserved).unwrap();
        (summary.steps, state.displacement)
    };
    let ((steps, exact), (fewer, scaled)) = (run(1.0), run(1.5));
    assert!(fewer as f64 <= steps as f64 / 1.45, "{fewer} {steps}");
    let difference: Vec<f64> = exact.iter().zip(&scaled).map(|(a, b)| a - b).collect();
    let change = largest(&difference) / largest(&exact);
    assert!(change < 1e-3, "{change:e}");
}

#[test]
fn a_factor_that_needs_too_much_mass_is_refused() {
    let error = scaled(&pushed(8.0)).unwrap_err();
    assert!(matches!(error, Error::TooMuchAddedMass { .. }), "{error}");
}

#[test]
fn without_scaling_no_mass_is_added() {
    let model = scaled(&pushed(1.0)).unwrap();
    assert_eq!(model.inertia, model.lumped_mass);
    assert_eq!(model.added_mass, 0.0);
}
