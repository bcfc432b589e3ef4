//! `mtled budget`.

use crate::accuracy::Group;
use crate::cli::progress::ManyRuns;
use crate::cli::sweep::{STORE, command_line, truth};
use crate::cli::{Common, Format, print_data};
use crate::explore::budget::{Wanted, budget, budget_study, budget_text};
use crate::explore::store::{Source, Store};
use crate::machine::provenance;
use anyhow::Result;
use clap::Args;
use mtled_checks::report::{json, write_report};
use mtled_checks::study::Report;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
pub struct BudgetArgs {
    /// Case file, or name of a carried case.
    case: String,
    /// Where the truth comes from: "any" (a carried reference of the problem, else own
    /// finer runs), "own", or a reference file.
    #[arg(long, default_value = "any", value_name = "any|own|FILE")]
    truth: String,
    /// What is judged [default: the first that the case has].
    #[arg(long, value_enum)]
    quantity: Option<Group>,
    /// Other clouds that show how much of the error is luck.
    #[arg(long, default_value_t = 2)]
    clouds: u16,
    /// Folder of the records; what is there is not run again.
    #[arg(long, default_value = STORE, value_name = "DIR")]
    store: PathBuf,
    /// Folder for index.html, results.json and figures
    /// [default: reports/budget/<case>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn budget_of(arguments: &BudgetArgs, common: &Common) -> Result<u8> {
    let start = Instant::now();
    let store = Store::new(&arguments.store);
    let source = Source::find(&arguments.case, store.folder())?;
    let wanted = Wanted {
        source: source.clone(),
        truth: truth(&arguments.truth),
        group: arguments.quantity,
        clouds: arguments.clouds.into(),
    };
    let runs = ManyRuns::new(common);
    let found = match budget(&wanted, &store, &|progress| runs.show(progress)) {
        Ok(found) => found,
        Err(error) => return runs.give_up(error),
    };
    runs.finish();
    let report = Report {
        schema_version: json::SCHEMA_VERSION,
        suite: "budget".into(),
        provenance: provenance(),
        studies: vec![budget_study(&found, &command_line())],
        wall_seconds: start.elapsed().as_secs_f64(),
        comparison: None,
    };
    let preset = || PathBuf::from("reports").join("budget").join(&source.name);
    let out = arguments.out.clone().unwrap_or_else(preset);
    write_report(&report, &out)?;
    match common.format {
        Format::Json => print_data(&json::to_json(&report))?,
        Format::Human if !common.quiet => {
            let page = out.join("index.html");
            print_data(&format!("{}\nreport: {}\n", budget_text(&found), page.display()))?;
        }
        Format::Human => {}
    }
    Ok(0)
}
