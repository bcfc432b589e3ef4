//! The reference solution that the errors of a study are measured against.

use super::axis::{Axis, number_of};
use crate::lab::store::{Job, Source, Task, TaskRunner};
use anyhow::{Context, Result, bail};
use mtled::problem::Motion;
use mtled_case::scene::{Knob, Level, Setting};
use mtled_checks::input::read_text;
use mtled_run::accuracy::{ReferenceSolution, from_own_runs, stored_reference};
use std::path::PathBuf;
use std::sync::Arc;

/// The finest spacing of a study over the smallest of the solver's own reference runs where
/// nothing else is asked for \[–\].
pub const REFINEMENT: f64 = 2.0;
/// Spacing of the finer of the two reference runs over that of the other \[–\].
const LAST_REFINEMENT: f64 = 0.75;

/// Where the reference solution comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum ReferenceSource {
    /// The bundled reference of the problem, or else finer runs of the solver.
    Any,
    /// A reference file in the layout of `reference/data`.
    File(PathBuf),
    /// Finer runs of the solver in any case, refined by this factor.
    Own(f64),
}

impl ReferenceSource {
    /// The stored reference of a case, if there is one and it may be used.
    pub(crate) fn stored(&self, source: &Source) -> Result<Option<ReferenceSolution>> {
        match self {
            ReferenceSource::Any => Ok(ReferenceSolution::bundled(&source.case)),
            ReferenceSource::Own(_) => Ok(None),
            ReferenceSource::File(file) => {
                let name = file.display().to_string();
                let text =
                    read_text(file).with_context(|| format!("cannot read the reference {name}"))?;
                Ok(Some(stored_reference(&source.case, &text, &name)?))
            }
        }
    }

    /// Instants of the values \[s\].
    pub(crate) fn times(&self, source: &Source) -> Result<Vec<f64>> {
        Ok(self.stored(source)?.map_or_else(|| instants(source), |known| known.times))
    }

    /// The finer runs of the solver; none where the reference is stored.
    pub(crate) fn tasks(&self, source: &Arc<Source>, axes: &[Axis]) -> Vec<Task> {
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
        let refinement = if let ReferenceSource::Own(own) = self { *own } else { REFINEMENT };
        let smallest = finest(axes, source) / refinement;
        vec![task(smallest), task(smallest / LAST_REFINEMENT)]
    }
}

/// Instants at which a dynamic case is compared where no reference gives them \[s\].
fn instants(source: &Source) -> Vec<f64> {
    const INSTANTS: usize = 20;
    match source.case.problem.motion {
        Motion::Dynamic { end, .. } => {
            (1..=INSTANTS).map(|n| end * n as f64 / INSTANTS as f64).collect()
        }
        _ => vec![0.0],
    }
}

/// The smallest spacing of the axes over that of the case.
fn finest(axes: &[Axis], source: &Source) -> f64 {
    let own = source.case.problem.recipe.spacing().unwrap_or(1.0);
    let spacings = axes.iter().filter(|axis| axis.knob == Knob::Spacing);
    let factors = spacings.flat_map(|axis| &axis.levels).filter_map(|level| match level {
        Level::Number(metres) => Some(metres / own),
        _ => number_of(level),
    });
    factors.fold(1.0, f64::min)
}

/// The reference solution of a case; finer runs are made and stored where none is given.
pub(crate) fn find_reference(
    from: &ReferenceSource,
    source: &Arc<Source>,
    axes: &[Axis],
    runner: &TaskRunner,
) -> Result<ReferenceSolution> {
    if let Some(known) = from.stored(source)? {
        return Ok(known);
    }
    let mut runs = Vec::new();
    for record in &runner.records(&from.tasks(source, axes))? {
        if let Some(reason) = record.failure() {
            bail!("{}: a finer run for the reference solution fails: {reason}", source.name);
        }
        let spacing = record.figure("spacing_m").context("a record without a spacing")?;
        runs.push((spacing, record.values().unwrap_or_default().to_vec()));
    }
    from_own_runs(&source.case, &runs, &instants(source))
        .with_context(|| format!("{}: two finer runs are needed", source.name))
}
