//! `mtled report`.

use super::common::Common;
use anyhow::Context;
use clap::Args;
use mtled_checks::gate::{compare as compare_with, compare_runs, read_baseline};
use mtled_checks::report::{human, json, read_report, two_runs, write_atomically, write_report};
use mtled_checks::study::Outcome;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// Folder of a report, or its results.json.
    run: PathBuf,
    /// A later report, which is compared with the first one.
    later: Option<PathBuf>,
    /// Folder for the pages [default: the folder of the report; for two reports
    /// reports/compare].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Compare the stored run with this baseline, as `mtled verify --baseline` does a new run;
    /// exit code 1 if a check got worse or fails.
    #[arg(long, value_name = "FILE", conflicts_with = "later")]
    baseline: Option<PathBuf>,
    /// Print every check, and not only those that fail.
    #[arg(long)]
    verbose: bool,
}

pub(crate) fn report(arguments: &ReportArgs, common: &Common) -> anyhow::Result<u8> {
    match &arguments.later {
        None => rebuild(arguments, common),
        Some(later) => compare(arguments, later, common),
    }
}

/// Writes the pages and figures again from results.json.
fn rebuild(arguments: &ReportArgs, common: &Common) -> anyhow::Result<u8> {
    let mut report = read_report(&arguments.run)?;
    if let Some(path) = &arguments.baseline {
        // The file does not say which studies were left out on purpose: none counts as missing.
        let comparison = compare_with(&report, &read_baseline(path)?, false);
        report.comparison = Some(comparison.with_context(|| path.display().to_string())?);
    }
    let same = || {
        if arguments.run.is_dir() {
            arguments.run.clone()
        } else {
            arguments.run.parent().map(PathBuf::from).unwrap_or_default()
        }
    };
    let out = arguments.out.clone().unwrap_or_else(same);
    write_report(&report, &out)?;
    common.print_coloured_summary(&|| Ok(json::to_json(&report)), &|| {
        let table = human::to_table(&report, common.colours(), arguments.verbose);
        format!("{table}\nreport: {}\n", out.join("index.html").display())
    })?;
    // What could not run then is a failure of that run, and not of this command.
    Ok(match (arguments.baseline.is_some(), report.outcome()) {
        (false, _) => 0,
        (true, outcome) => outcome.min(Outcome::Failed).exit_code(),
    })
}

fn compare(arguments: &ReportArgs, later: &Path, common: &Common) -> anyhow::Result<u8> {
    let before = read_report(&arguments.run)?;
    let now = read_report(later)?;
    let comparison = compare_runs(&before, &now);
    let out = arguments.out.clone().unwrap_or_else(|| "reports/compare".into());
    let page = out.join("index.html");
    let text = two_runs::to_markdown(&before, &now, &comparison);
    write_atomically(&page, two_runs::to_html(&before, &now, &comparison)?.as_bytes())?;
    write_atomically(&out.join("summary.md"), text.as_bytes())?;
    common.print_coloured_summary(
        &|| Ok(serde_json::to_string_pretty(&comparison)? + "\n"),
        &|| {
            let changed = human::changed_lines(&comparison, common.colours());
            let summary = human::compared_with(&comparison);
            format!("{changed}{summary}\nreport: {}\n", page.display())
        },
    )?;
    Ok(0)
}
