//! A user's own cases for `mtled verify --suite FILE`.

use super::gate::{Gate, GateArgs};
use crate::cli::common::Common;
use crate::cli::lab::StoreArgs;
use crate::cli::progress::ManyRuns;
use anyhow::bail;
use mtled_checks::report::json;
use mtled_checks::study::{Report, Study};
use mtled_lab::lab::store::TaskRunner;
use mtled_lab::suite::Suite;
use mtled_run::machine::provenance;
use std::path::Path;
use std::time::Instant;

/// Clouds besides that of the case from whose scatter the bands of a baseline follow.
pub(crate) const OTHER_CLOUDS: u64 = 4;

/// A suite that was run.
pub(crate) struct OwnRun {
    pub report: Report,
    pub gate: Gate,
    /// Whether all its cases were run.
    pub whole: bool,
}

/// Runs the cases whose names contain `only` on a cloud; the exit code where the user stopped it.
pub(crate) fn run_own(
    file: &Path,
    (only, cloud): (&str, u64),
    gate: &GateArgs,
    store: &StoreArgs,
    common: &Common,
) -> anyhow::Result<Result<OwnRun, u8>> {
    let start = Instant::now();
    let suite = Suite::read(file)?;
    let names: Vec<&str> = suite.cases.iter().map(|case| case.source.name.as_str()).collect();
    let whole = names.iter().all(|name| name.contains(only));
    if !names.iter().any(|name| name.contains(only)) {
        bail!("no case matches; the cases of {} are {}", file.display(), names.join(", "));
    }
    let gate = gate.read(&suite.name, suite.baseline.as_deref())?;
    let store = store.open()?;
    let runs = ManyRuns::new(common);
    let runner = TaskRunner { store: &store, notify: &|progress| runs.show(progress), plan: None };
    let last = if gate.needs_clouds() { cloud + OTHER_CLOUDS } else { cloud };
    let reports = match runs.finish(suite.studies(only, cloud..last + 1, &runner))? {
        Ok(clouds) => clouds,
        Err(code) => return Ok(Err(code)),
    };
    let mut reports = reports.into_iter().map(|studies| report(&suite, studies, start));
    let Some(own) = reports.next() else { bail!("{} has no case", file.display()) };
    let others: Vec<Report> = reports.filter(ran).collect();
    let gate = if others.len() > 1 { gate.with_clouds(others) } else { gate };
    Ok(Ok(OwnRun { report: own, gate, whole }))
}

/// Whether every case ran: some clouds of others cannot be varied.
fn ran(report: &Report) -> bool {
    report.studies.iter().all(|study| study.failure.is_none())
}

/// The report of a suite.
pub(crate) fn report(suite: &Suite, studies: Vec<Study>, start: Instant) -> Report {
    Report {
        schema_version: json::SCHEMA_VERSION,
        suite: suite.name.clone(),
        provenance: provenance(),
        studies,
        wall_seconds: start.elapsed().as_secs_f64(),
        comparison: None,
    }
}
