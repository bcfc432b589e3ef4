//! `mtled study race`.

use crate::cli::common::Common;
use crate::cli::publish::{publish, report_of, tables};
use crate::cli::python::{checkout, installed};
use crate::cli::streams::print_data;
use crate::contests::race::{
    Challenge, Code, FINITE_ELEMENT_CODES, Interpreter, RaceOutcome, RaceSettings, race, run_here,
};
use anyhow::Result;
use clap::{Args, ValueEnum};
use mtled_checks::report::{ensure_writable, write_atomically};
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
pub struct RaceArgs {
    /// Problems [default: all].
    cases: Vec<Challenge>,
    /// Repetitions of every run, of which medians are shown.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..))]
    repeat: u16,
    /// Folder for index.html, race.md, results.json, timings.json and figures.
    #[arg(long, default_value = "reports/race", value_name = "DIR")]
    out: PathBuf,
    /// The folder `reference` of a checkout, for the finite-element codes [default: searched
    /// from the working directory upward].
    #[arg(long, value_name = "DIR")]
    reference: Option<PathBuf>,
    /// Show stored timings of the finite-element codes even if they are installed.
    #[arg(long)]
    stored: bool,
    /// Perform one run in this process and print it as JSON.
    #[arg(long, hide = true)]
    run: Option<String>,
}

pub fn race_study(arguments: &RaceArgs, common: &Common) -> Result<u8> {
    if let Some(key) = &arguments.run {
        print_data(&serde_json::to_string(&run_here(key)?)?)?;
        return Ok(0);
    }
    ensure_writable(&arguments.out)?;
    let start = Instant::now();
    let say = |text: &str| common.note(text);
    let challenges = if arguments.cases.is_empty() {
        Challenge::value_variants().to_vec()
    } else {
        arguments.cases.clone()
    };
    let interpreters = if arguments.stored { Vec::new() } else { interpreters(arguments, &say) };
    let settings = RaceSettings { challenges, repetitions: arguments.repeat.into(), interpreters };
    let RaceOutcome { study, timings } = race(&settings, &say)?;
    let report = report_of("race", study, start);
    let tables = tables(&report);
    write_atomically(&arguments.out.join("race.md"), tables.as_bytes())?;
    let timings = serde_json::to_string_pretty(&timings)? + "\n";
    write_atomically(&arguments.out.join("timings.json"), timings.as_bytes())?;
    publish(&report, &arguments.out, common, &|| tables.clone())
}

/// The finite-element codes that are installed.
fn interpreters(arguments: &RaceArgs, say: &dyn Fn(&str)) -> Vec<Interpreter> {
    let Ok(reference) = arguments.reference.clone().map_or_else(checkout, Ok) else {
        say("no checkout was found: stored timings of the finite-element codes are shown");
        return Vec::new();
    };
    let find = |code: Code| {
        let Some(python) = installed(code.name(), &reference) else {
            say(&format!("{} is not installed: stored timings are shown", code.title()));
            return None;
        };
        Some(Interpreter {
            code,
            program: python.program_and_flags(),
            reference: reference.clone(),
        })
    };
    FINITE_ELEMENT_CODES.into_iter().filter_map(find).collect()
}
