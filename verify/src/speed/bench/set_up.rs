//! What comes before the first step, part by part, on one thread.

use super::force::Settings;
use super::pose::{Subject, cube};
use super::turns::{Clock, seconds_of};
use mtled::discretisation::Discretisation;
use mtled::discretisation::nodes::node_cloud;
use mtled::discretisation::quadrature::quadrature;
use mtled::error::Error;
use mtled::model::Model;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::motion::internal_force::Workspace;
use mtled::problem::{Gradients, Problem};
use mtled_checks::measure::median;
use serde::Serialize;

/// Tolerance of the gradients that users have.
const TOLERANCE: f64 = 1e-3;
/// Nodes per support.
const NEIGHBOURS: f64 = 32.0;

/// Processor seconds of each part on one thread, and of one evaluation of the
/// internal force.
#[derive(Debug, Clone, Serialize)]
pub struct SetUp {
    pub nodes: usize,
    pub points: usize,
    pub neighbours: f64,
    pub node_cloud: f64,
    pub quadrature: f64,
    /// Neighbours, patches, φ and Grad φ of all points.
    pub shape_functions: f64,
    /// Consistent gradients above plain ones, boundary panels included.
    pub correction: f64,
    pub correction_iterations: usize,
    /// Masses, conditions, loads and blocks.
    pub model: f64,
    pub critical_step: f64,
    /// Evaluations of the internal force that Lanczos took.
    pub critical_step_evaluations: usize,
    pub force_evaluation: f64,
}

impl SetUp {
    pub fn all(&self) -> f64 {
        let before = self.node_cloud + self.quadrature + self.shape_functions;
        before + self.correction + self.model + self.critical_step
    }

    /// Seconds of the shape functions per point.
    pub fn per_point(&self) -> f64 {
        self.shape_functions / self.points as f64
    }
}

/// Measures the set-up of a cube.
pub fn set_up(settings: &Settings) -> anyhow::Result<SetUp> {
    let problem = cube(if settings.quick { 20 } else { 31 }, NEIGHBOURS);
    let tries: Result<Vec<SetUp>, Error> =
        settings.one.install(|| (0..3).map(|_| measure(&problem)).collect());
    let tries = tries?;
    let middle = |part: fn(&SetUp) -> f64| {
        median(&tries.iter().map(part).collect::<Vec<_>>()).unwrap_or(f64::NAN)
    };
    Ok(SetUp {
        node_cloud: middle(|t| t.node_cloud),
        quadrature: middle(|t| t.quadrature),
        shape_functions: middle(|t| t.shape_functions),
        correction: middle(|t| t.correction),
        model: middle(|t| t.model),
        critical_step: middle(|t| t.critical_step),
        force_evaluation: middle(|t| t.force_evaluation),
        ..tries[0].clone()
    })
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let mut made = None;
    let seconds = seconds_of(Clock::Processor, || made = Some(work()));
    (made.expect("the work was done"), seconds)
}

fn measure(plain: &Problem) -> Result<SetUp, Error> {
    let mut problem = plain.clone();
    problem.recipe.gradients = Gradients::Consistent { tolerance: TOLERANCE };
    let (recipe, dimension) = (&problem.recipe, &problem.dimension);
    let body = problem.body.section(dimension)?;
    let (cloud, nodes_seconds) = timed(|| node_cloud(&problem.body, &recipe.cloud, dimension));
    let (cells, cell_seconds) =
        timed(|| quadrature(&body, &problem.regions, &recipe.grid, dimension));
    let (nodes, points) = (cloud?.positions.len(), cells?.positions.len());
    let (_, plainly) = timed(|| Discretisation::new(plain));
    let (discretisation, consistently) = timed(|| Discretisation::new(&problem));
    let discretisation = discretisation?;
    let (model, binding) = timed(|| Model::new(&problem, &discretisation));
    let model = model?;
    let mut workspace = Workspace::new(&model);
    let rest = vec![0.0; model.size()];
    let (critical, critical_seconds) =
        timed(|| critical_time_step(&model, &rest, 0.0, None, &mut workspace));
    let mut subject = Subject::of(model);
    let evaluations: Vec<f64> =
        (0..9).map(|_| seconds_of(Clock::Processor, || subject.evaluate())).collect();
    Ok(SetUp {
        nodes,
        points,
        neighbours: discretisation.mean_support(),
        node_cloud: nodes_seconds,
        quadrature: cell_seconds,
        shape_functions: (plainly - nodes_seconds - cell_seconds).max(0.0),
        correction: (consistently - plainly).max(0.0),
        correction_iterations: discretisation.correction.map_or(0, |c| c.iterations),
        model: binding,
        critical_step: critical_seconds,
        critical_step_evaluations: critical.products + 1,
        force_evaluation: median(&evaluations).unwrap_or(f64::NAN),
    })
}
