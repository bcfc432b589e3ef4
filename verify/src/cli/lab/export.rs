//! `mtled runs export`.

use super::filter::FilterArgs;
use crate::cli::common::Common;
use crate::cli::streams::print_data;
use anyhow::{Result, bail};
use clap::Args;
use mtled_checks::report::{ensure_writable, write_atomically};
use mtled_lab::lab::records::{quantities_are_missing, runs_table};
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = TABLE)]
pub(crate) struct ExportArgs {
    /// File of the table, in CSV [default: standard output].
    #[arg(short, long, value_name = "FILE", help_heading = "Table")]
    output: Option<PathBuf>,
    #[command(flatten)]
    filter: FilterArgs,
}

const TABLE: &str = "The table has one row for each run and number that it gave: `quantity`, `position` (from 0, of a
probe with several), `component`, `time_s`, `value`, `unit`. Other columns say which run it is,
its settings (empty where the run has those of its case), its sizes, CPU times, counts of work,
date and version. A run that failed has one row, with the reason. Errors depend on a reference;
they are in the reports of studies. Where Parquet is useful, pandas or DuckDB make it of the table.

Examples:
  mtled runs export -o runs.csv
  mtled runs export --case my_case --where dilation=1.4..2.2:0.2 > runs.csv
  mtled runs export --since 2026-01-31 -o january.csv";

pub(crate) fn export(arguments: &ExportArgs, common: &Common) -> Result<u8> {
    if let Some(file) = &arguments.output {
        let ending = file.extension().unwrap_or_default().to_string_lossy();
        if ["parquet", "xlsx"].contains(&ending.to_lowercase().as_str()) {
            bail!("{}: the table is written as CSV; name a file that ends in .csv", file.display());
        }
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
        ensure_writable(folder.unwrap_or(Path::new(".")))?;
    }
    let chosen = arguments.filter.read(common)?;
    let nameless = chosen.records.iter().filter(|record| quantities_are_missing(record)).count();
    if nameless > 0 {
        common.warn(format!(
            "{nameless} records are of an earlier version, which did not store what their values \
             are; of these the table has the other figures only"
        ));
    }
    let (bytes, rows) = runs_table(&chosen.records)?;
    match &arguments.output {
        None => print_data(&String::from_utf8(bytes)?)?,
        Some(file) => {
            write_atomically(file, &bytes)?;
            let runs = chosen.records.len();
            let json = || Ok(format!("{}\n", json!({ "file": file, "runs": runs, "rows": rows })));
            common.print_summary(&json, &|| {
                format!("{rows} rows of {runs} runs in {}\n", file.display())
            })?;
        }
    }
    Ok(chosen.code)
}
