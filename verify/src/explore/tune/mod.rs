//! The cheapest recipe that meets a wanted error, or the best one for a wanted cost:
//! many recipes on coarse clouds, the hopeless dropped early, the rest on finer and
//! other clouds, the winner confirmed on clouds that nobody has looked at.

mod cases;
mod design;
mod effects;
mod report;
mod score;
mod search;

pub use cases::{Recommendation, recommend};
pub use design::{Candidate, candidates};
pub use report::{recommendation_study, tune_study, tune_text};
pub use search::{Tuned, tune};

use crate::accuracy::{Group, Truth};
use crate::explore::store::{Job, Progress, Record, Source, Store, Task, perform_all};
use crate::explore::sweep::{Axis, TruthWanted};
use crate::scene::{Knob, Setting};
use anyhow::{Context, Result};
use std::sync::Arc;

/// What is wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// At most this error \[–\], at the least cost.
    Error(f64),
    /// At most this CPU time \[s\], with the least error.
    Budget(f64),
}

/// A search.
#[derive(Debug)]
pub struct Wanted {
    pub source: Arc<Source>,
    pub goal: Goal,
    pub truth: TruthWanted,
    /// What is judged; the first group that the case has, where none is named.
    pub group: Option<Group>,
    /// Clouds of a recipe in the last round; errors are the largest over them.
    pub clouds: usize,
    /// Clouds that nobody has looked at, on which the winner is confirmed.
    pub fresh: usize,
    /// Levels that replace those of the design.
    pub axes: Vec<Axis>,
    /// The command that reproduces it.
    pub command: String,
}

/// A recipe at a spacing, on several clouds.
#[derive(Debug, Clone)]
pub struct Trial {
    /// Into the candidates of the search.
    pub candidate: usize,
    /// Spacing over that of the case \[–\].
    pub factor: f64,
    /// rms, one per cloud that ran \[–\].
    pub errors: Vec<f64>,
    /// Middle of the clouds, one thread \[s\].
    pub cpu_s: f64,
    /// Why the first cloud that failed did so.
    pub failure: Option<String>,
}

impl Trial {
    /// The largest error over the clouds; infinite where one failed.
    pub fn worst(&self) -> f64 {
        if self.failure.is_some() {
            return f64::INFINITY;
        }
        self.errors.iter().copied().fold(0.0, f64::max)
    }

    /// Largest less smallest error.
    pub fn range(&self) -> f64 {
        self.worst() - self.errors.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// What a search needs to run trials.
struct Bench<'a> {
    wanted: &'a Wanted,
    candidates: Vec<Candidate>,
    truth: Truth,
    group: Group,
    store: &'a Store,
    say: &'a (dyn Fn(Progress) + Sync),
}

impl Bench<'_> {
    fn task(&self, candidate: usize, factor: f64, cloud: u64) -> Task {
        let mut settings = vec![Setting::word(Knob::Spacing, &format!("x{factor:.4}"))];
        settings.extend(self.candidates[candidate].settings.iter().cloned());
        settings.push(Setting::number(Knob::Cloud, cloud as f64));
        settings.sort_by_key(|setting| setting.knob);
        Task {
            job: Job::Solve,
            source: self.wanted.source.clone(),
            settings,
            times: self.truth.times.clone(),
        }
    }

    /// Candidates at their factors, all on the same clouds, side by side.
    fn trials(&self, points: &[(usize, f64)], clouds: &[u64]) -> Result<Vec<Trial>> {
        let mut tasks = Vec::new();
        for &(candidate, factor) in points {
            tasks.extend(clouds.iter().map(|&cloud| self.task(candidate, factor, cloud)));
        }
        let records = perform_all(self.store, &tasks, self.say)?;
        let found = points.iter().zip(records.chunks(clouds.len()));
        found.map(|(point, records)| self.trial(*point, records)).collect()
    }

    fn trial(&self, (candidate, factor): (usize, f64), records: &[Record]) -> Result<Trial> {
        let case = &self.wanted.source.case;
        let error = |values| self.truth.difference(case, self.group, values).map(|d| d.rms);
        let errors = records.iter().filter_map(|record| error(record.values()?)).collect();
        let cpu: Vec<f64> = records.iter().map(Record::cpu_s).collect();
        let failure = records.iter().find_map(Record::failure).map(str::to_string);
        let cpu_s = mtled_checks::measure::median(&cpu).context("no cloud was run")?;
        Ok(Trial { candidate, factor, errors, cpu_s, failure })
    }

    /// The truth's own error \[–\].
    fn bar(&self) -> f64 {
        let own: Vec<Vec<f64>> = self.truth.quantities.iter().map(|q| q.values.clone()).collect();
        let difference = self.truth.difference(&self.wanted.source.case, self.group, &own);
        difference.map_or(0.0, |difference| difference.bar)
    }
}
