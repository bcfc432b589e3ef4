//! `mtled report`.

use crate::cli::{Common, Format, print_data};
use clap::Args;
use mtled_checks::gate::{compare as compare_with, compare_runs, read_baseline};
use mtled_checks::report::{human, json, read_report, versus, write_atomically, write_report};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct ReportArgs {
    /// Folder of a report, or its results.json.
    run: PathBuf,
    /// A later run: both are compared instead.
    later: Option<PathBuf>,
    /// Where to write [default: into the folder of the report; of two,
    /// reports/compare].
    #[arg(long)]
    out: Option<PathBuf>,
    /// Judge the stored run by this baseline, as `mtled verify --baseline` does a run of
    /// its own; exit code 1 where a check got worse or fails.
    #[arg(long, value_name = "FILE", conflicts_with = "later")]
    baseline: Option<PathBuf>,
}

pub fn report(arguments: &ReportArgs, common: &Common) -> anyhow::Result<u8> {
    match &arguments.later {
        None => rebuild(arguments, common),
        Some(later) => compare(arguments, later, common),
    }
}

/// Pages, figures and the rest from the one file that holds everything.
fn rebuild(arguments: &ReportArgs, common: &Common) -> anyhow::Result<u8> {
    let mut report = read_report(&arguments.run)?;
    if let Some(path) = &arguments.baseline {
        // Which studies were left out on purpose is not in the file: none is missed.
        report.comparison = Some(compare_with(&report, &read_baseline(path)?, false)?);
    }
    let beside = || match arguments.run.is_dir() {
        true => arguments.run.clone(),
        false => arguments.run.parent().map(PathBuf::from).unwrap_or_default(),
    };
    let out = arguments.out.clone().unwrap_or_else(beside);
    write_report(&report, &out)?;
    match common.format {
        Format::Json => print_data(&json::to_json(&report))?,
        Format::Human if !common.quiet => {
            let table = human::to_table(&report, common.colours());
            print_data(&format!("{table}\nreport: {}\n", out.join("index.html").display()))?;
        }
        Format::Human => {}
    }
    Ok(u8::from(arguments.baseline.is_some() && !report.passed()))
}

fn compare(arguments: &ReportArgs, later: &Path, common: &Common) -> anyhow::Result<u8> {
    let before = read_report(&arguments.run)?;
    let now = read_report(later)?;
    let comparison = compare_runs(&before, &now);
    let out = arguments.out.clone().unwrap_or_else(|| "reports/compare".into());
    let page = out.join("index.html");
    let text = versus::to_markdown(&before, &now, &comparison);
    write_atomically(&page, versus::to_html(&before, &now, &comparison)?.as_bytes())?;
    write_atomically(&out.join("summary.md"), text.as_bytes())?;
    match common.format {
        Format::Json => print_data(&(serde_json::to_string_pretty(&comparison)? + "\n"))?,
        Format::Human if !common.quiet => {
            let changed = human::changed_lines(&comparison, common.colours());
            let words = human::compared_with(&comparison);
            print_data(&format!("{changed}{words}\nreport: {}\n", page.display()))?;
        }
        Format::Human => {}
    }
    Ok(0)
}
