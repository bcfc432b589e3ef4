//! What the errors of a study are measured against.

use super::axis::Axis;
use super::{instants, number_of};
use crate::accuracy::{Truth, extrapolated};
use crate::explore::store::{Job, Progress, Source, Store, Task, perform_all};
use crate::scene::{Knob, Setting};
use crate::studies::workbench::spacing_of;
use anyhow::{Context, Result};
use std::path::PathBuf;
use std::sync::Arc;

/// Finer than the finest spacing of the study by these factors: the finest first.
const FINER: [f64; 2] = [1.0 / 2.0, 1.0 / 1.5];

/// Where the truth is to come from.
#[derive(Debug, Clone, PartialEq)]
pub enum TruthWanted {
    /// A carried reference of the problem, or else own finer runs.
    Any,
    /// A reference file in the layout of `reference/data`.
    File(PathBuf),
    /// Own finer runs in any case.
    Own,
}

impl TruthWanted {
    /// The stored reference of a case, if one is wanted and there.
    fn stored(&self, source: &Source) -> Result<Option<Truth>> {
        match self {
            TruthWanted::Any => Ok(Truth::carried(&source.case)),
            TruthWanted::Own => Ok(None),
            TruthWanted::File(file) => {
                let name = file.display().to_string();
                let text = std::fs::read_to_string(file)
                    .with_context(|| format!("cannot read the reference {name}"))?;
                Ok(Some(Truth::of_reference(&source.case, &text, &name)?))
            }
        }
    }

    /// Instants of the values \[s\].
    pub fn times(&self, source: &Source) -> Result<Vec<f64>> {
        Ok(self.stored(source)?.map_or_else(|| instants(source), |truth| truth.times))
    }

    /// The runs that it takes; none where it is stored.
    pub fn tasks(&self, source: &Arc<Source>, axes: &[Axis]) -> Vec<Task> {
        if matches!(self.stored(source), Ok(Some(_)) | Err(_)) {
            return Vec::new();
        }
        let times = instants(source);
        let task = |factor: f64| Task {
            job: Job::Solve,
            source: source.clone(),
            settings: vec![Setting::word(Knob::Spacing, &format!("x{factor:.6}"))],
            times: times.clone(),
        };
        let finest = finest(axes, source);
        FINER.iter().map(|finer| task(finer * finest)).collect()
    }
}

/// The smallest spacing of the axes over that of the case.
fn finest(axes: &[Axis], source: &Source) -> f64 {
    let own = spacing_of(&source.case.problem).unwrap_or(1.0);
    let spacings = axes.iter().filter(|axis| axis.knob == Knob::Spacing);
    let factors = spacings.flat_map(|axis| &axis.levels).filter_map(|level| match level {
        crate::scene::Level::Number(metres) => Some(metres / own),
        _ => number_of(level),
    });
    factors.fold(1.0, f64::min)
}

/// The truth of a case; own runs that it takes are made and kept.
pub fn find_truth(
    wanted: &TruthWanted,
    source: &Arc<Source>,
    axes: &[Axis],
    store: &Store,
    say: &(dyn Fn(Progress) + Sync),
) -> Result<Truth> {
    if let Some(truth) = wanted.stored(source)? {
        return Ok(truth);
    }
    let tasks = wanted.tasks(source, axes);
    let records = perform_all(store, &tasks, say)?;
    let mut runs = Vec::new();
    for record in &records {
        if let Some(reason) = record.failure() {
            anyhow::bail!(
                "{}: the finer run that errors are measured against fails: {reason}",
                source.name
            );
        }
        let spacing = record.figure("spacing_m").context("a record without a spacing")?;
        runs.push((spacing, record.values().unwrap_or_default().to_vec()));
    }
    extrapolated(&source.case, &runs, &instants(source))
        .with_context(|| format!("{}: two finer runs are needed", source.name))
}
