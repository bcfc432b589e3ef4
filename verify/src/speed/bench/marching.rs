//! Whole steps, contact, and whole small cases.

use super::force::Settings;
use super::pose::cube;
use super::turns::{Clock, in_turns};
use crate::machine::{cpu_seconds, peak_memory};
use crate::run::solve_case;
use crate::scene::{Case, one_error, read_case};
use anyhow::ensure;
use mtled::discretisation::Discretisation;
use mtled::model::Model;
use mtled::motion::state::State;
use mtled::motion::step::{Buffers, Scheme, step};
use mtled::problem::{Gradients, Motion, Problem, StepControl};
use mtled_checks::measure::median;
use rayon::ThreadPool;
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

/// A run that stands ready, damped so that it stays bounded as it goes on.
pub struct Marcher {
    pub model: Model,
    scheme: Scheme,
    state: State,
    buffers: Buffers,
}

impl Marcher {
    /// Dynamic whatever the motion of the problem.
    pub fn new(problem: &Problem, discretisation: &Discretisation) -> anyhow::Result<Marcher> {
        let mut problem = problem.clone();
        let damping = match problem.motion {
            Motion::Dynamic { damping, .. } => damping,
            _ => 10.0,
        };
        problem.motion = Motion::Dynamic { end: 1.0, step: StepControl::default(), damping };
        let model = Model::new(&problem, discretisation)?;
        let time_step = 0.9 * model.bound;
        let scheme = Scheme::central_difference(time_step, time_step, damping);
        let (state, buffers) = (State::new(&model), Buffers::new(&model, false));
        Ok(Marcher { model, scheme, state, buffers })
    }

    /// One step.
    pub fn step(&mut self) {
        let (now, then) = (self.state.time, self.state.time + self.scheme.time_step);
        step(&self.model, &self.scheme, now, then, &mut self.state, &mut self.buffers);
    }

    /// Refuses a measurement of steps that went astray.
    pub fn check(&self) -> anyhow::Result<()> {
        let sound = self.state.displacement.iter().all(|x| x.is_finite());
        ensure!(sound, "the run diverged while it was measured");
        Ok(())
    }
}

/// Whole steps of a body.
#[derive(Debug, Clone, Serialize)]
pub struct StepRow {
    pub what: String,
    pub nodes: usize,
    pub points: usize,
    pub neighbours: f64,
    /// Seconds of one step: processor time on one thread, wall time on all.
    pub seconds: [f64; 2],
}

/// A carried case from its file to its result, on one thread.
#[derive(Debug, Clone, Serialize)]
pub struct CaseRow {
    pub name: String,
    pub nodes: usize,
    pub points: usize,
    pub force_evaluations: usize,
    pub set_up_seconds: f64,
    pub march_seconds: f64,
    pub cpu_seconds: f64,
}

/// What a large body takes.
#[derive(Debug, Clone, Serialize)]
pub struct MemoryRow {
    pub nodes: usize,
    pub points: usize,
    pub neighbours: f64,
    pub set_up_seconds: f64,
    /// Largest resident memory of the process until the first step \[bytes\].
    pub peak_bytes: Option<u64>,
    pub bytes_streamed_per_point: f64,
    /// Wall seconds of one step on all threads.
    pub step_seconds: f64,
}

/// A carried case.
pub fn carried(cases: &Path, name: &str) -> anyhow::Result<Case> {
    read_case(&cases.join(format!("{name}.toml"))).map_err(one_error)
}

/// Measures whole steps on one thread and on all.
pub fn step_row(settings: &Settings, what: &str, problem: &Problem) -> anyhow::Result<StepRow> {
    let discretisation = Discretisation::new(problem)?;
    let mut first = Marcher::new(problem, &discretisation)?;
    let mut second = Marcher::new(problem, &discretisation)?;
    let on = |pool: &ThreadPool, marcher: &mut Marcher| pool.install(|| marcher.step());
    let mut work = || on(&settings.one, &mut first);
    let one = in_turns(Clock::Processor, settings.rounds, &mut [&mut work]);
    let mut work = || on(&settings.all, &mut second);
    let all = in_turns(Clock::Wall, settings.rounds, &mut [&mut work]);
    first.check()?;
    second.check()?;
    Ok(StepRow {
        what: what.to_string(),
        nodes: first.model.positions.len(),
        points: discretisation.supports.len(),
        neighbours: discretisation.mean_support(),
        seconds: [one.median(0), all.median(0)],
    })
}

/// The brain in its skull, with and without the skull: what contact costs.
pub fn contact_rows(settings: &Settings, cases: &Path) -> anyhow::Result<[StepRow; 2]> {
    let with = carried(cases, "brain_slice")?.problem;
    let without = Problem { obstacles: Vec::new(), ..with.clone() };
    Ok([
        step_row(settings, "brain slice in its skull (plane)", &with)?,
        step_row(settings, "brain slice without obstacles (plane)", &without)?,
    ])
}

/// Solves a case a few times.
pub fn case_row(settings: &Settings, cases: &Path, name: &str) -> anyhow::Result<CaseRow> {
    let case = carried(cases, name)?;
    let mut measured = Vec::new();
    for _ in 0..3 {
        let cpu = cpu_seconds();
        let (solved, _) = settings.one.install(|| solve_case(&case))?;
        measured.push((cpu_seconds() - cpu, solved));
    }
    let middle = |value: &dyn Fn(usize) -> f64| {
        median(&(0..measured.len()).map(value).collect::<Vec<_>>()).unwrap_or(f64::NAN)
    };
    let solved = &measured[0].1;
    Ok(CaseRow {
        name: name.to_string(),
        nodes: solved.prepared.model.positions.len(),
        points: solved.prepared.discretisation.supports.len(),
        force_evaluations: solved.summary.force_evaluations,
        set_up_seconds: middle(&|i| measured[i].1.prepared.setup_seconds),
        march_seconds: middle(&|i| measured[i].1.solve_seconds),
        cpu_seconds: middle(&|i| measured[i].0),
    })
}

/// Sets up a body of about 100 000 nodes and 200 000 points. To be measured
/// first of all: the peak is that of the process.
pub fn memory_row(settings: &Settings) -> anyhow::Result<MemoryRow> {
    let mut problem = cube(if settings.quick { 30 } else { 58 }, 30.0);
    problem.recipe.gradients = Gradients::Consistent { tolerance: 1e-3 };
    let start = Instant::now();
    let (mut marcher, neighbours) = settings.all.install(|| -> anyhow::Result<_> {
        let discretisation = Discretisation::new(&problem)?;
        Ok((Marcher::new(&problem, &discretisation)?, discretisation.mean_support()))
    })?;
    let (set_up_seconds, peak_bytes) = (start.elapsed().as_secs_f64(), peak_memory());
    let turns = settings
        .all
        .install(|| in_turns(Clock::Wall, settings.rounds, &mut [&mut || marcher.step()]));
    marcher.check()?;
    let (model, points) = (&marcher.model, marcher.model.point_positions.len());
    Ok(MemoryRow {
        nodes: model.positions.len(),
        points,
        neighbours,
        set_up_seconds,
        peak_bytes,
        bytes_streamed_per_point: model.bytes_per_step() as f64 / points as f64,
        step_seconds: turns.median(0),
    })
}

/// Steps of the cube whose force is measured too.
pub fn cube_step(settings: &Settings) -> anyhow::Result<StepRow> {
    step_row(settings, "cube", &cube(if settings.quick { 20 } else { 31 }, 30.0))
}
