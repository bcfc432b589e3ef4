//! Time steps, contact included.

use super::alternation::{Clock, alternate};
use super::bodies::{cube, recommended};
use super::figures::{BenchSettings, MemoryRow, StepRow};
use super::whole_cases::bundled_case;
use crate::machine::peak_memory;
use anyhow::ensure;
use mtled::discretisation::Discretisation;
use mtled::model::Model;
use mtled::motion::state::State;
use mtled::motion::step::{Buffers, Scheme, step};
use mtled::problem::{Motion, Problem, StepControl};
use rayon::ThreadPool;
use std::path::Path;
use std::time::Instant;

/// Steps through a dynamic simulation, damped so that it stays bounded.
pub struct Stepper {
    /// The model.
    pub model: Model,
    scheme: Scheme,
    state: State,
    buffers: Buffers,
}

impl Stepper {
    /// Dynamic, whatever the motion of the problem.
    pub fn new(problem: &Problem, discretisation: &Discretisation) -> anyhow::Result<Stepper> {
        let mut problem = problem.clone();
        let damping = match problem.motion {
            Motion::Dynamic { damping, .. } => damping,
            _ => 10.0,
        };
        problem.motion = Motion::Dynamic { end: 1.0, step: StepControl::default(), damping };
        let model = Model::new(&problem, discretisation)?;
        let time_step = 0.9 * model.per_point_bound;
        let scheme = Scheme::central_difference(time_step, time_step, damping);
        let (state, buffers) = (State::new(&model), Buffers::new(&model, false));
        Ok(Stepper { model, scheme, state, buffers })
    }

    /// One step.
    pub fn step(&mut self) {
        let (now, then) = (self.state.time, self.state.time + self.scheme.time_step);
        step(&self.model, &self.scheme, now, then, &mut self.state, &mut self.buffers);
    }

    /// Refuses a measurement of a run that diverged.
    pub fn check(&self) -> anyhow::Result<()> {
        let finite = self.state.displacement.iter().all(|x| x.is_finite());
        ensure!(finite, "the run diverged while it was measured");
        Ok(())
    }
}

/// Measures steps on one thread and on all.
pub fn step_row(
    settings: &BenchSettings,
    label: &str,
    problem: &Problem,
) -> anyhow::Result<StepRow> {
    let discretisation = Discretisation::new(problem)?;
    let mut first = Stepper::new(problem, &discretisation)?;
    let mut second = Stepper::new(problem, &discretisation)?;
    let on = |pool: &ThreadPool, stepper: &mut Stepper| pool.install(|| stepper.step());
    let mut work = || on(&settings.one, &mut first);
    let one = alternate(Clock::Processor, settings.rounds, &mut [&mut work]);
    let mut work = || on(&settings.all, &mut second);
    let all = alternate(Clock::Wall, settings.rounds, &mut [&mut work]);
    first.check()?;
    second.check()?;
    Ok(StepRow {
        label: label.to_string(),
        nodes: first.model.positions.len(),
        points: discretisation.supports.len(),
        neighbours: discretisation.mean_support(),
        seconds: [one.median(0), all.median(0)],
    })
}

/// The brain with and without its skull: the cost of contact.
pub fn contact_rows(settings: &BenchSettings, cases: &Path) -> anyhow::Result<[StepRow; 2]> {
    let with = bundled_case(cases, "brain_slice")?.problem;
    let without = Problem { obstacles: Vec::new(), ..with.clone() };
    Ok([
        step_row(settings, "brain slice in its skull (plane)", &with)?,
        step_row(settings, "brain slice without obstacles (plane)", &without)?,
    ])
}

/// Sets up a body of about 100 000 nodes and 200 000 points. This must be measured first,
/// since the peak of the memory is that of the process.
pub fn memory_row(settings: &BenchSettings) -> anyhow::Result<MemoryRow> {
    let problem = recommended(cube(if settings.quick { 30 } else { 58 }, 30.0));
    let start = Instant::now();
    let (mut stepper, neighbours) = settings.all.install(|| -> anyhow::Result<_> {
        let discretisation = Discretisation::new(&problem)?;
        Ok((Stepper::new(&problem, &discretisation)?, discretisation.mean_support()))
    })?;
    let (set_up_seconds, peak_bytes) = (start.elapsed().as_secs_f64(), peak_memory());
    let times = settings
        .all
        .install(|| alternate(Clock::Wall, settings.rounds, &mut [&mut || stepper.step()]));
    stepper.check()?;
    let (model, points) = (&stepper.model, stepper.model.point_positions.len());
    Ok(MemoryRow {
        nodes: model.positions.len(),
        points,
        neighbours,
        set_up_seconds,
        peak_bytes,
        bytes_streamed_per_point: model.bytes_per_step() as f64 / points as f64,
        step_seconds: times.median(0),
    })
}

/// Steps of a cube.
pub fn cube_step(settings: &BenchSettings) -> anyhow::Result<StepRow> {
    let problem = recommended(cube(if settings.quick { 20 } else { 31 }, 30.0));
    step_row(settings, "cube", &problem)
}
