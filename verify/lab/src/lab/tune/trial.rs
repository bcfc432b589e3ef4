//! What is searched for, and recipes tried on several clouds.

use super::design::Candidate;
use crate::lab::store::{Job, RunRecord, Source, Task, TaskRunner};
use crate::lab::sweep::{Axis, ReferenceSource};
use anyhow::{Context, Result};
use mtled_case::scene::{Knob, Setting};
use mtled_checks::measure::median;
use mtled_run::accuracy::{Group, ReferenceSolution};
use std::sync::Arc;

/// The goal of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// At most this error \[–\], at the least cost.
    Error(f64),
    /// At most this CPU time \[s\], with the least error.
    Budget(f64),
}

/// A search for a recipe.
#[derive(Debug)]
pub struct TuneRequest {
    /// The case.
    pub source: Arc<Source>,
    /// What the recipe must meet.
    pub goal: Goal,
    /// Where the reference solution comes from.
    pub reference: ReferenceSource,
    /// Quantities whose error is measured; by default the first group that the case has.
    pub group: Option<Group>,
    /// Clouds per recipe in the last round; its error is the largest over them.
    pub clouds: usize,
    /// Clouds that the search does not use, on which the winner is confirmed.
    pub fresh: usize,
    /// CPU time that finer reference runs may take where the reference cannot decide the goal \[s\].
    pub truth_budget_s: f64,
    /// Ranges that replace the built-in design.
    pub axes: Vec<Axis>,
    /// The command that reproduces it.
    pub command: String,
}

/// A recipe at a spacing, on several clouds.
#[derive(Debug, Clone)]
pub struct Trial {
    /// Index of the candidate.
    pub candidate: usize,
    /// Spacing over that of the case \[–\].
    pub factor: f64,
    /// rms errors of the clouds that ran \[–\].
    pub errors: Vec<f64>,
    /// Median over the clouds, one thread \[s\].
    pub cpu_s: f64,
    /// Error message of the first cloud that failed.
    pub failure: Option<String>,
}

impl Trial {
    /// The largest error over the clouds; infinite where one failed.
    pub(crate) fn worst(&self) -> f64 {
        if self.failure.is_some() {
            return f64::INFINITY;
        }
        self.errors.iter().copied().fold(0.0, f64::max)
    }

    /// The smallest error over the clouds.
    pub(crate) fn least(&self) -> f64 {
        self.errors.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Runs trials of candidates.
pub(crate) struct TrialRunner<'a> {
    pub request: &'a TuneRequest,
    pub candidates: Vec<Candidate>,
    pub reference: ReferenceSolution,
    pub group: Group,
    tasks: TaskRunner<'a>,
}

impl<'a> TrialRunner<'a> {
    /// The candidates are still to be added.
    pub(crate) fn new(
        request: &'a TuneRequest,
        reference: ReferenceSolution,
        group: Group,
        tasks: TaskRunner<'a>,
    ) -> TrialRunner<'a> {
        TrialRunner { request, candidates: Vec::new(), reference, group, tasks }
    }

    fn task(&self, candidate: usize, factor: f64, cloud: u64) -> Task {
        let mut settings = vec![Setting::word(Knob::Spacing, &format!("x{factor:.4}"))];
        settings.extend(self.candidates[candidate].settings.iter().cloned());
        settings.push(Setting::number(Knob::Cloud, cloud as f64));
        settings.sort_by_key(|setting| setting.knob);
        Task {
            job: Job::Solve,
            source: self.request.source.clone(),
            settings,
            times: self.reference.times.clone(),
        }
    }

    /// Trials of (candidate, spacing factor), all on the same clouds.
    pub(crate) fn trials(&self, points: &[(usize, f64)], clouds: &[u64]) -> Result<Vec<Trial>> {
        let mut tasks = Vec::new();
        for &(candidate, factor) in points {
            tasks.extend(clouds.iter().map(|&cloud| self.task(candidate, factor, cloud)));
        }
        let records = self.tasks.records(&tasks)?;
        let trials = points.iter().zip(records.chunks(clouds.len()));
        trials.map(|(point, records)| self.trial(*point, records)).collect()
    }

    fn trial(&self, (candidate, factor): (usize, f64), records: &[RunRecord]) -> Result<Trial> {
        let case = &self.request.source.case;
        let error = |values| self.reference.difference(case, self.group, values).map(|d| d.rms);
        let errors = records.iter().filter_map(|record| error(record.values()?)).collect();
        let cpu: Vec<f64> = records.iter().map(RunRecord::cpu_s).collect();
        let failure = records.iter().find_map(RunRecord::failure).map(str::to_string);
        let cpu_s = median(&cpu).context("no cloud was run")?;
        Ok(Trial { candidate, factor, errors, cpu_s, failure })
    }

    /// Error of the reference solution itself \[–\].
    pub(crate) fn bar(&self) -> f64 {
        self.reference.bar(&self.request.source.case, self.group)
    }
}
