//! Holding a contest, and publishing what came out.

use crate::cli::common::{Common, STOPPED, command_line};
use crate::cli::publish::{report_of, tables};
use anyhow::Result;
use mtled_checks::report::{ensure_writable, json, svg, write_atomically};
use mtled_lab::contests::{Contest, ContestCase, History, Judged, Results, study, write_pages};
use std::path::Path;
use std::time::Instant;

/// Runs a contest, stores its results and publishes them.
pub(crate) fn held(contest: Contest, out: &Path, common: &Common) -> Result<u8> {
    let start = Instant::now();
    ensure_writable(out)?;
    let mut all = Vec::new();
    let mut keep = |results: Results| {
        let path = out.join("results").join(results.path());
        let text = serde_json::to_string(&results)? + "\n";
        write_atomically(&path, text.as_bytes())?;
        all.push(results);
        Ok(())
    };
    let whole = contest.run(&|text| common.note(text), &mut keep)?;
    if !whole {
        return Ok(STOPPED);
    }
    let cases: Vec<ContestCase> = contest.cases.into_iter().map(|(case, _)| case).collect();
    publish(&Judged::new(&all, &cases)?, None, out, start, common)
}

/// Writes pages and tables of judged results and prints the latter.
pub(crate) fn publish(
    judged: &Judged,
    history: Option<&History>,
    out: &Path,
    start: Instant,
    common: &Common,
) -> Result<u8> {
    let report = report_of("contest", study(judged, command_line()), start);
    write_pages(judged, history, out)?;
    if let Some(overview) = report.studies[0].figures.first() {
        write_atomically(&out.join("overview.svg"), svg::to_svg_file(overview).as_bytes())?;
    }
    let tables = tables(&report);
    write_atomically(&out.join("tables.md"), tables.as_bytes())?;
    let page = out.join("index.html");
    common.print_summary(&|| Ok(json::to_json(&report)), &|| {
        format!("{tables}\nreport: {}\n", page.display())
    })?;
    Ok(report.outcome().exit_code())
}
