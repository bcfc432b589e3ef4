//! An error budget with a price: where the error of a case comes from, each part
//! estimated by a run in which that part alone is made smaller, and what that run
//! costs.

mod parts;
mod text;

pub use parts::{Part, parts};
pub use text::{budget_study, budget_text};

use crate::accuracy::{Difference, Group, Truth};
use crate::explore::store::{Progress, Record, Source, Store, Task, perform_all};
use crate::explore::sweep::{TruthWanted, find_truth};
use anyhow::{Context, Result, bail};
use std::sync::Arc;

/// What a budget is wanted of.
#[derive(Debug)]
pub struct Wanted {
    pub source: Arc<Source>,
    pub truth: TruthWanted,
    /// What is judged; the first group that the case has, where none is named.
    pub group: Option<Group>,
    /// Other clouds that show how much of the error is luck.
    pub clouds: usize,
}

/// One part with what its run gave.
#[derive(Debug)]
pub struct Share {
    pub part: Part,
    /// Change of the answer, rms over the largest value of its kind \[–\]; none where
    /// the run failed.
    pub size: Option<f64>,
    /// CPU time of that run over that of the case as it is \[–\].
    pub price: f64,
    /// Why its run failed.
    pub failure: Option<String>,
}

/// The whole budget.
#[derive(Debug)]
pub struct Budget {
    pub source: Arc<Source>,
    pub group: Group,
    /// Against the truth.
    pub total: Difference,
    pub truth: Truth,
    pub base: Record,
    pub shares: Vec<Share>,
    /// Errors against the truth on the other clouds \[–\].
    pub luck: Vec<f64>,
}

/// Runs what is not on record yet.
pub fn budget(wanted: &Wanted, store: &Store, say: &(dyn Fn(Progress) + Sync)) -> Result<Budget> {
    let source = &wanted.source;
    let truth = find_truth(&wanted.truth, source, &[], store, say)?;
    let Some(group) = wanted.group.or_else(|| truth.group(&source.case)) else {
        bail!("{}: has no probe and no support whose error could be told", source.name);
    };
    let parts = parts(&source.case);
    let task = |settings: &[crate::scene::Setting]| Task {
        job: crate::explore::store::Job::Solve,
        source: source.clone(),
        settings: settings.to_vec(),
        times: truth.times.clone(),
    };
    let mut tasks = vec![task(&[])];
    tasks.extend(parts.iter().map(|part| task(&part.settings)));
    let clouds = (1..=wanted.clouds)
        .map(|n| crate::scene::Setting::number(crate::scene::Knob::Cloud, n as f64));
    tasks.extend(clouds.map(|setting| task(&[setting])));
    let mut records = perform_all(store, &tasks, say)?;
    let others = records.split_off(1 + parts.len());
    let changed = records.split_off(1);
    let base = records.pop().context("the case itself was not run")?;
    let Some(answer) = base.values() else {
        bail!("{}: {}", source.name, base.failure().unwrap_or("failed"));
    };
    let judged =
        |record: &Record| truth.difference(&source.case, group, record.values()?).map(|d| d.rms);
    let total = truth
        .difference(&source.case, group, answer)
        .with_context(|| format!("{} has no {}", source.name, group.words()))?;
    let shares = parts.into_iter().zip(&changed).map(|(part, record)| Share {
        size: record.values().and_then(|other| truth.apart(&source.case, group, answer, other)),
        price: record.cpu_s() / base.cpu_s(),
        failure: record.failure().map(str::to_string),
        part,
    });
    let shares = shares.collect();
    let luck = others.iter().filter_map(judged).collect();
    Ok(Budget { source: source.clone(), group, total, base, shares, luck, truth })
}
