//! Reports of a single study.

use super::common::Common;
use anyhow::Result;
use mtled_checks::report::{json, markdown_tables, write_report};
use mtled_checks::study::{Report, Study};
use mtled_run::machine::provenance;
use std::path::Path;
use std::time::Instant;

/// The report of one study that took the time since `start`.
pub(crate) fn report_of(suite: &str, study: Study, start: Instant) -> Report {
    let wall_seconds = start.elapsed().as_secs_f64();
    Report {
        schema_version: json::SCHEMA_VERSION,
        suite: suite.into(),
        provenance: provenance(),
        studies: vec![Study { wall_seconds, ..study }],
        wall_seconds,
        comparison: None,
    }
}

/// Writes a report to `out` and prints it as JSON or as `text` and the path of its page.
/// The exit code is that of its outcome.
pub(crate) fn publish(
    report: &Report,
    out: &Path,
    common: &Common,
    text: &dyn Fn() -> String,
) -> Result<u8> {
    write_report(report, out)?;
    let page = out.join("index.html");
    common.print_summary(&|| Ok(json::to_json(report)), &|| {
        format!("{}\nreport: {}\n", text(), page.display())
    })?;
    Ok(report.outcome().exit_code())
}

/// The tables of the report of a single study as Markdown.
pub(crate) fn tables(report: &Report) -> String {
    markdown_tables(&report.studies[0], &report.provenance)
}
