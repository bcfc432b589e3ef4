//! Runs the case and its variants and compares them.

use super::parts::{Part, parts};
use crate::lab::store::{Job, RunRecord, Source, Task, TaskRunner};
use crate::lab::sweep::{ReferenceSource, find_reference};
use anyhow::{Context, Result, bail};
use mtled_case::scene::{Knob, Setting};
use mtled_run::accuracy::{Difference, Group, ReferenceSolution};
use std::sync::Arc;

/// What to measure.
#[derive(Debug)]
pub struct BudgetRequest {
    /// The case.
    pub source: Arc<Source>,
    /// Where the reference solution comes from.
    pub reference: ReferenceSource,
    /// Quantities whose error is measured; by default the first group that the case has.
    pub group: Option<Group>,
    /// Number of other clouds that show the scatter of the error.
    pub clouds: usize,
}

/// A part of the error with the result of its run.
#[derive(Debug)]
pub struct MeasuredPart {
    /// What was changed.
    pub part: Part,
    /// Estimate of the part, rms over the largest value of its kind \[–\]; none where the run
    /// failed.
    pub size: Option<f64>,
    /// CPU time of that run over that of the case \[–\].
    pub cost: f64,
    /// Error message of a run that failed.
    pub failure: Option<String>,
}

/// The whole budget.
#[derive(Debug)]
pub struct ErrorBudget {
    /// The case.
    pub source: Arc<Source>,
    /// Quantities whose error is measured.
    pub group: Group,
    /// Error against the reference solution.
    pub total: Difference,
    /// The reference solution.
    pub reference: ReferenceSolution,
    /// The case itself.
    pub base: RunRecord,
    /// The parts of the error.
    pub parts: Vec<MeasuredPart>,
    /// rms errors against the reference solution on the other clouds \[–\].
    pub other_clouds: Vec<f64>,
}

/// Runs what is not stored yet and compares.
pub fn measure_budget(request: &BudgetRequest, runner: &TaskRunner) -> Result<ErrorBudget> {
    let source = &request.source;
    let case = &source.case;
    let reference = find_reference(&request.reference, source, &[], runner)?;
    let Some(group) = request.group.or_else(|| reference.group(case)) else {
        bail!("{}: has no probe and no support whose error can be measured", source.name);
    };
    let parts = parts(case);
    let task = |settings: &[Setting]| Task {
        job: Job::Solve,
        source: source.clone(),
        settings: settings.to_vec(),
        times: reference.times.clone(),
    };
    let mut tasks = vec![task(&[])];
    tasks.extend(parts.iter().map(|part| task(&part.settings)));
    let clouds = (1..=request.clouds).map(|n| Setting::number(Knob::Cloud, n as f64));
    tasks.extend(clouds.map(|setting| task(&[setting])));
    let mut records = runner.records(&tasks)?;
    let others = records.split_off(1 + parts.len());
    let changed = records.split_off(1);
    let base = records.pop().context("the case itself was not run")?;
    let Some(solution) = base.values() else {
        bail!("{}: {}", source.name, base.failure().unwrap_or("failed"));
    };
    let error = |values| reference.difference(case, group, values);
    let total =
        error(solution).with_context(|| format!("{} has no {}", source.name, group.label()))?;
    let parts = parts.into_iter().zip(&changed).map(|(part, record)| {
        let change = |other| reference.difference_between(case, group, solution, other);
        MeasuredPart {
            size: record.values().and_then(change).map(|change| part.factor * change),
            cost: record.cpu_s() / base.cpu_s(),
            failure: record.failure().map(str::to_string),
            part,
        }
    });
    let parts = parts.collect();
    let other_clouds =
        others.iter().filter_map(|record| Some(error(record.values()?)?.rms)).collect();
    Ok(ErrorBudget { source: source.clone(), group, total, base, parts, other_clouds, reference })
}
