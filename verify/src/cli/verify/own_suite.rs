//! `mtled verify --suite FILE`: a user's own cases.

use super::{VerifyArgs, finish};
use crate::cli::common::Common;
use crate::cli::progress::ManyRuns;
use crate::explore::store::TaskRunner;
use crate::machine::provenance;
use crate::suite::Suite;
use anyhow::bail;
use mtled_checks::report::{ensure_writable, json};
use mtled_checks::study::{Report, Study};
use std::path::Path;
use std::time::Instant;

/// Clouds besides that of the case from whose scatter the bands of a baseline follow.
pub const OTHER_CLOUDS: u64 = 4;

pub fn verify_own(file: &Path, arguments: &VerifyArgs, common: &Common) -> anyhow::Result<u8> {
    let start = Instant::now();
    let suite = Suite::read(file)?;
    let only = arguments.only.as_deref().unwrap_or_default();
    let names: Vec<&str> = suite.cases.iter().map(|case| case.source.name.as_str()).collect();
    let whole = names.iter().all(|name| name.contains(only));
    if !names.iter().any(|name| name.contains(only)) {
        bail!("no case matches; the cases of {} are {}", file.display(), names.join(", "));
    }
    let gate = arguments.gate.read(&suite.name, suite.baseline.as_deref())?;
    ensure_writable(&arguments.out)?;
    let store = arguments.store.open()?;
    let runs = ManyRuns::new(common);
    let runner = TaskRunner { store: &store, notify: &|progress| runs.show(progress), plan: None };
    let first = arguments.seed;
    let last = if gate.needs_clouds() { first + OTHER_CLOUDS } else { first };
    let reports = match runs.finish(suite.studies(only, first..last + 1, &runner))? {
        Ok(clouds) => clouds,
        Err(code) => return Ok(code),
    };
    let mut reports = reports.into_iter().map(|studies| report(&suite, studies, start));
    let Some(own) = reports.next() else { bail!("{} has no case", file.display()) };
    let others: Vec<Report> = reports.filter(ran).collect();
    let gate = if others.len() > 1 { gate.with_clouds(others) } else { gate };
    finish(own, gate, whole, arguments, common)
}

/// Whether every case ran: some clouds of others cannot be varied.
fn ran(report: &Report) -> bool {
    report.studies.iter().all(|study| study.failure.is_none())
}

/// The report of a suite.
pub fn report(suite: &Suite, studies: Vec<Study>, start: Instant) -> Report {
    Report {
        schema_version: json::SCHEMA_VERSION,
        suite: suite.name.clone(),
        provenance: provenance(),
        studies,
        wall_seconds: start.elapsed().as_secs_f64(),
        comparison: None,
    }
}
