//! `mtled runs export`.

use super::filter::FilterArgs;
use crate::cli::common::{Common, Format};
use crate::cli::streams::print_data;
use crate::explore::records::{quantities_are_missing, runs_table, to_csv, to_parquet};
use anyhow::{Result, bail};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use mtled_checks::report::{ensure_writable, write_atomically};
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = TABLE)]
pub struct ExportArgs {
    /// Format of the table [default: by the ending of the file, else csv].
    #[arg(long, value_name = "FORMAT", value_parser = table_format(), help_heading = "Table")]
    format: Option<Format>,
    /// File of the table [default: standard output, for CSV only].
    #[arg(short, long, value_name = "FILE", help_heading = "Table")]
    output: Option<PathBuf>,
    #[command(flatten)]
    filter: FilterArgs,
}

const TABLE: &str = "The table has one row for each run and number that it gave: `quantity`, `position` (from 0, of a
probe with several), `component`, `time_s`, `value`, `unit`. Other columns say which run it is,
its settings (empty where the run has those of its case), its sizes, CPU times, counts of work,
date and version. A run that failed has one row, with the reason. Errors depend on a reference;
they are in the reports of studies.

Examples:
  mtled runs export -o runs.parquet
  mtled runs export --case my_case --where dilation=1.4..2.2:0.2 > runs.csv
  mtled runs export --since 2026-01-31 --format csv -o january.txt";

/// Other words than elsewhere, of the same type: the option of all commands is read from it.
fn table_format() -> impl TypedValueParser<Value = Format> {
    PossibleValuesParser::new(["csv", "parquet"])
        .map(|word| if word == "parquet" { Format::Parquet } else { Format::Csv })
}

impl ExportArgs {
    /// Whether the table is Parquet; the format of messages says nothing about it.
    fn is_parquet(&self) -> bool {
        match self.format {
            Some(Format::Parquet) => true,
            Some(Format::Csv) => false,
            Some(Format::Human | Format::Json) | None => {
                let ending = self.output.as_deref().and_then(Path::extension);
                ending.is_some_and(|ending| ending.eq_ignore_ascii_case("parquet"))
            }
        }
    }
}

pub fn export(arguments: &ExportArgs, common: &Common) -> Result<u8> {
    let parquet = arguments.is_parquet();
    match &arguments.output {
        None if parquet => {
            bail!("a Parquet file cannot be read from a pipe; name it with --output")
        }
        None => {}
        Some(file) => {
            let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
            ensure_writable(folder.unwrap_or(Path::new(".")))?;
        }
    }
    let chosen = arguments.filter.read(common)?;
    let nameless = chosen.records.iter().filter(|record| quantities_are_missing(record)).count();
    if nameless > 0 {
        common.warn(format!(
            "{nameless} records are of an earlier version, which did not store what their values \
             are; of these the table has the other figures only"
        ));
    }
    let table = runs_table(&chosen.records);
    let bytes = if parquet { to_parquet(&table)? } else { to_csv(&table)? };
    match &arguments.output {
        None => print_data(&String::from_utf8(bytes)?)?,
        Some(file) => {
            write_atomically(file, &bytes)?;
            let (runs, rows) = (chosen.records.len(), table.rows);
            let json = || Ok(format!("{}\n", json!({ "file": file, "runs": runs, "rows": rows })));
            common.print_summary(&json, &|| {
                format!("{rows} rows of {runs} runs in {}\n", file.display())
            })?;
        }
    }
    Ok(chosen.code)
}
