//! The set-up part by part on one thread.

use super::alternation::{Clock, seconds_of};
use super::bodies::{DeformedModel, cube, recommended};
use super::figures::{BenchSettings, SetUp};
use mtled::discretisation::Discretisation;
use mtled::discretisation::nodes::node_cloud;
use mtled::discretisation::quadrature::quadrature;
use mtled::error::Error;
use mtled::model::Model;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::motion::internal_force::Workspace;
use mtled::problem::Problem;
use mtled_checks::measure::median;

/// Mean number of nodes per support.
const NEIGHBOURS: f64 = 32.0;

/// Measures the set-up of a cube.
pub fn set_up(settings: &BenchSettings) -> anyhow::Result<SetUp> {
    let problem = cube(if settings.quick { 20 } else { 31 }, NEIGHBOURS);
    let trials: Result<Vec<SetUp>, Error> =
        settings.one.install(|| (0..3).map(|_| measure(&problem)).collect());
    let trials = trials?;
    let middle = |part: fn(&SetUp) -> f64| {
        median(&trials.iter().map(part).collect::<Vec<_>>()).unwrap_or(f64::NAN)
    };
    Ok(SetUp {
        node_cloud: middle(|t| t.node_cloud),
        quadrature: middle(|t| t.quadrature),
        shape_functions: middle(|t| t.shape_functions),
        correction: middle(|t| t.correction),
        model: middle(|t| t.model),
        critical_step: middle(|t| t.critical_step),
        force_evaluation: middle(|t| t.force_evaluation),
        ..trials[0].clone()
    })
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let mut result = None;
    let seconds = seconds_of(Clock::Processor, || result = Some(work()));
    (result.expect("the work was done"), seconds)
}

fn measure(plain: &Problem) -> Result<SetUp, Error> {
    let problem = recommended(plain.clone());
    let (recipe, dimension) = (&problem.recipe, &problem.dimension);
    let body = problem.body.section(dimension)?;
    let (cloud, nodes_seconds) = timed(|| node_cloud(&problem.body, &recipe.cloud, dimension));
    let (cells, cell_seconds) =
        timed(|| quadrature(&body, &problem.regions, &recipe.grid, dimension));
    let (nodes, points) = (cloud?.positions.len(), cells?.positions.len());
    let (_, plain_seconds) = timed(|| Discretisation::new(plain));
    let (discretisation, consistent_seconds) = timed(|| Discretisation::new(&problem));
    let discretisation = discretisation?;
    let (model, model_seconds) = timed(|| Model::new(&problem, &discretisation));
    let model = model?;
    let mut workspace = Workspace::new(&model);
    let rest = vec![0.0; model.size()];
    let (critical, critical_seconds) =
        timed(|| critical_time_step(&model, &rest, 0.0, None, &mut workspace));
    let mut model = DeformedModel::of(model);
    let evaluations: Vec<f64> =
        (0..9).map(|_| seconds_of(Clock::Processor, || model.evaluate())).collect();
    Ok(SetUp {
        nodes,
        points,
        neighbours: discretisation.mean_support(),
        node_cloud: nodes_seconds,
        quadrature: cell_seconds,
        shape_functions: (plain_seconds - nodes_seconds - cell_seconds).max(0.0),
        correction: (consistent_seconds - plain_seconds).max(0.0),
        correction_iterations: discretisation.correction.map_or(0, |c| c.iterations),
        model: model_seconds,
        critical_step: critical_seconds,
        critical_step_evaluations: critical.products + 1,
        force_evaluation: median(&evaluations).unwrap_or(f64::NAN),
    })
}
