//! Closed forms in time: a wave in a column and the swing of a beam.

use crate::exact::bar::ConfinedColumn;
use crate::exact::beam::Beam;
use crate::studies::closed_forms::results::{BOUND, Results};
use anyhow::{Context, Result};
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::Rows;
use mtled::geometry::{Selector, Shape};
use mtled::material::{ElasticConstants, Law, LinearElastic, Material};
use mtled::motion::observe::{Continue, Observer, View};
use mtled::problem::{Amplitude, BackgroundGrid, BodyForce, Motion, Problem, StepControl};
use mtled_run::run::integrate;
use mtled_run::specimens::simple::{PLANE, bonded_face, free_body, recipe};

/// A fifth below the stability limit, without damping.
const UNDAMPED: StepControl = StepControl {
    safety_factor: 0.8,
    reevaluate_every: usize::MAX,
    fixed: None,
    mass_scaling: 1.0,
};

/// Displacement of one point along x over time.
struct History {
    row: Rows,
    /// (s, m)
    samples: Vec<(f64, f64)>,
}

impl Observer for History {
    fn observe(&mut self, view: &mut View) -> Continue {
        let u = self.row.interpolate(0, &view.state.displacement, 3);
        self.samples.push((view.state.time, u.x));
        Continue::Yes
    }
}

/// Gravity acts suddenly on a column at rest: its top over one period.
pub(crate) fn wave(
    mut problem: Problem,
    exact: &ConfinedColumn,
    top: Vector3,
    results: &mut Results,
) -> Result<()> {
    let period = 4.0 * exact.height / exact.wave_speed();
    problem.motion = Motion::Dynamic { end: period, step: UNDAMPED, damping: 0.0 };
    problem.loads.body_forces[0].amplitude = Amplitude::Constant;
    let simulation = Simulation::with_any_recipe(&problem)?;
    let row = simulation.discretisation.rows_at(&[top])?;
    let mut history = History { row, samples: Vec::new() };
    integrate(simulation, &mut history)?;
    let (mut error, mut size) = (0.0, 0.0);
    for (t, u) in &history.samples {
        let exact = exact.top_after_release(*t);
        error += (u - exact).powi(2);
        size += exact * exact;
    }
    let label = "released column, L2 error of the motion of its top over one period";
    let source = "d'Alembert; Graff 1975, section 2.1";
    results.relative("wave/top", label, f64::sqrt(error / size), BOUND, source);
    Ok(())
}

/// Momentum of the first mode over time.
struct Mode {
    /// \[node\]
    shape: Vec<f64>,
    /// (s, N·s)
    samples: Vec<(f64, f64)>,
}

impl Observer for Mode {
    fn observe(&mut self, view: &mut View) -> Continue {
        let state = &view.state;
        let momentum = self.shape.iter().zip(&view.model.lumped_mass).enumerate();
        let sum = momentum.map(|(node, (shape, mass))| shape * mass * state.velocity[2 * node + 1]);
        // Velocities belong to half a step earlier.
        self.samples.push((state.time - 0.5 * state.time_step, sum.sum()));
        Continue::Yes
    }
}

/// Small vibration of a cantilever in plane strain after gravity acts suddenly: the velocity of
/// the first mode first vanishes after half a period.
pub(crate) fn swing(results: &mut Results) -> Result<()> {
    let (length, height) = (0.2, 0.01);
    let constants = ElasticConstants::from_young_poisson(1e6, 0.3)?;
    let beam = Beam {
        length,
        area: height,
        second_moment: height * height * height / 12.0,
        young_modulus: constants.young_modulus() / (1.0 - constants.poisson_ratio().powi(2)),
        density: 1000.0,
    };
    let spacing = 0.25 * height;
    let material =
        Material { density: beam.density, law: Law::LinearElastic(LinearElastic::new(constants)) };
    let shape = Shape::Box { min: Vector3::zeros(), max: Vector3::new(length, height, 1.0) };
    let mut recipe = recipe(spacing, 0.0, 0);
    recipe.grid = BackgroundGrid::with_cell(0.5 * spacing);
    let mut problem = free_body(PLANE, shape, material, recipe);
    problem.conditions = vec![bonded_face(0, 0.0, 0.0, Amplitude::Constant)];
    problem.loads.body_forces = vec![BodyForce {
        part: Selector::All,
        acceleration: Vector3::new(0.0, -1e-3, 0.0).into(),
        amplitude: Amplitude::Constant,
    }];
    let end = 0.55 / beam.cantilever_frequency();
    problem.motion = Motion::Dynamic { end, step: UNDAMPED, damping: 0.0 };
    let simulation = Simulation::with_any_recipe(&problem)?;
    let positions = &simulation.model.positions;
    let shape = positions.iter().map(|at| beam.cantilever_mode(at.x)).collect();
    let mut mode = Mode { shape, samples: Vec::new() };
    integrate(simulation, &mut mode)?;
    let turn = mode.samples.windows(2).skip(2).find(|pair| pair[0].1 < 0.0 && pair[1].1 >= 0.0);
    let [(t0, p0), (t1, p1)] = turn.context("the velocity of the beam does not change its sign")?
    else {
        anyhow::bail!("a window of two holds two samples");
    };
    let half_period = t0 + (t1 - t0) * p0 / (p0 - p1);
    results.value(
        ("swinging_beam/frequency", "cantilever 20 times as long as high, first frequency", "Hz"),
        (0.5 / half_period, beam.cantilever_frequency()),
        "Euler and Bernoulli; Blevins 1979, table 8-1",
    );
    Ok(())
}
