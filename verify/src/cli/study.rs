//! `mtled study`: cases over ranges of recipes, and the race.

use crate::cli::python::installed;
use crate::cli::sweep::{SweepArgs, sweep};
use crate::cli::{Common, Format, print_data};
use crate::explore::sweep::Subject;
use crate::machine::provenance;
use crate::speed::race::{Challenge, Code, Interpreter, Race, race, run_here};
use anyhow::Result;
use clap::{Args, Subcommand, ValueEnum};
use mtled_checks::report::{json, markdown_tables, write_atomically, write_report};
use mtled_checks::study::Report;
use std::path::PathBuf;

#[derive(Debug, Subcommand)]
pub enum StudyCommand {
    /// How far the discrete divergence theorem and the quadrature are off, and how
    /// well supports are conditioned, over recipes.
    Consistency(SweepArgs),
    /// An affine field on the body of the case: errors over recipes.
    Patch(SweepArgs),
    /// Bound, Lanczos and the bisected truth of the critical step over recipes, at
    /// rest and compressed.
    Timestep(SweepArgs),
    /// Errors against a reference or own finer runs over spacings, with orders and
    /// their scatter over clouds.
    Convergence(SweepArgs),
    /// Which recipes and loads end soundly, and how the others end.
    Stability(SweepArgs),
    /// Speed against error, side by side with FEniCSx and scikit-fem: the bonded
    /// block and two smooth problems over ladders of recipes and elements.
    Race(RaceArgs),
}

#[derive(Debug, Args)]
pub struct RaceArgs {
    /// What to race on [default: all].
    cases: Vec<Challenge>,
    /// How often every run is repeated; medians are shown.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..))]
    repeat: u16,
    /// Folder for index.html, race.md, results.json, timings.json and figures.
    #[arg(long, default_value = "reports/race")]
    out: PathBuf,
    /// The folder `reference` of a checkout, for the finite-element codes
    /// [default: found upward from here].
    #[arg(long, value_name = "DIR")]
    reference: Option<PathBuf>,
    /// Show stored timings of the finite-element codes even where they are
    /// installed.
    #[arg(long)]
    stored: bool,
    /// One run in this process, as JSON.
    #[arg(long, hide = true)]
    run: Option<String>,
}

pub fn study(command: &StudyCommand, common: &Common) -> Result<u8> {
    match command {
        StudyCommand::Consistency(arguments) => sweep(Subject::Consistency, arguments, common),
        StudyCommand::Patch(arguments) => sweep(Subject::Patch, arguments, common),
        StudyCommand::Timestep(arguments) => sweep(Subject::TimeStep, arguments, common),
        StudyCommand::Convergence(arguments) => sweep(Subject::Convergence, arguments, common),
        StudyCommand::Stability(arguments) => sweep(Subject::Stability, arguments, common),
        StudyCommand::Race(arguments) => race_study(arguments, common),
    }
}

fn race_study(arguments: &RaceArgs, common: &Common) -> Result<u8> {
    if let Some(key) = &arguments.run {
        print_data(&serde_json::to_string(&run_here(key)?)?)?;
        return Ok(0);
    }
    let say = |text: &str| {
        if !common.quiet {
            eprintln!("{text}");
        }
    };
    let challenges = match arguments.cases.is_empty() {
        true => Challenge::value_variants().to_vec(),
        false => arguments.cases.clone(),
    };
    let interpreters = if arguments.stored { Vec::new() } else { interpreters(arguments, &say) };
    let setting = Race { challenges, repetitions: arguments.repeat.into(), interpreters };
    let outcome = race(&setting, &say)?;
    let report = Report {
        schema_version: 1,
        suite: "race".into(),
        provenance: provenance(),
        wall_seconds: outcome.study.wall_seconds,
        studies: vec![outcome.study],
        comparison: None,
    };
    write_report(&report, &arguments.out)?;
    let tables = markdown_tables(&report.studies[0], &report.provenance);
    write_atomically(&arguments.out.join("race.md"), tables.as_bytes())?;
    let timings = serde_json::to_string_pretty(&outcome.timings)? + "\n";
    write_atomically(&arguments.out.join("timings.json"), timings.as_bytes())?;
    match common.format {
        Format::Json => print_data(&json::to_json(&report))?,
        Format::Human if !common.quiet => {
            let page = arguments.out.join("index.html");
            print_data(&format!("{tables}\nreport: {}\n", page.display()))?;
        }
        Format::Human => {}
    }
    Ok(if report.passed() { 0 } else { 1 })
}

/// The finite-element codes that are installed here.
fn interpreters(arguments: &RaceArgs, say: &dyn Fn(&str)) -> Vec<Interpreter> {
    let Ok(reference) =
        arguments.reference.clone().map_or_else(crate::cli::reference::solve::checkout, Ok)
    else {
        say("no checkout is around: the finite-element codes are shown by stored timings");
        return Vec::new();
    };
    let find = |code: Code| {
        let Some(python) = installed(code.name(), &reference) else {
            say(&format!("{} is not installed: stored timings are shown", code.title()));
            return None;
        };
        Some(Interpreter { code, program: python.words(), reference: reference.clone() })
    };
    [Code::Fenicsx, Code::ScikitFem].into_iter().filter_map(find).collect()
}
