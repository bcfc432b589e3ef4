//! `mtled verify`.

mod gate;
mod own_suite;
mod progress;

pub(crate) use own_suite::{OTHER_CLOUDS, report};
use own_suite::{OwnRun, run_own};

use super::common::{Common, STOPPED};
use super::lab::StoreArgs;
use anyhow::bail;
use clap::Args;
use gate::{Gate, GateArgs, report_to_github};
use mtled_checks::report::{ensure_writable, human, json, read, read_report, write_report};
use mtled_checks::study::{Report, Study};
use mtled_harness::studies::workbench::{Suite, Workbench};
use mtled_harness::studies::{Definition, STUDIES};
use mtled_run::machine::provenance;
use progress::Progress;
use rayon::prelude::*;
use std::convert::Infallible;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Instant;

#[derive(Debug, Args)]
pub(crate) struct VerifyArgs {
    /// Which suite to run: quick takes about two minutes, full about a quarter of an hour, both
    /// with the studies of the solver; a file such as those that `mtled init` writes has cases of
    /// your own.
    #[arg(long, value_name = "quick|full|FILE", default_value = "quick")]
    suite: SuiteChoice,
    /// Run only the studies, of a suite of your own the cases, whose name contains this text.
    #[arg(long, value_name = "PATTERN")]
    only: Option<String>,
    /// Family of node clouds; the baseline belongs to family 0. In another family random and graded
    /// clouds have other random seeds, and the lattices of bundled cases are jittered by 2 % of the
    /// spacing. Operation counts keep their clouds.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..1_000_000))]
    seed: u64,
    /// Folder for index.html, results.json, junit.xml and summary.md.
    #[arg(long, default_value = "reports/verify", value_name = "DIR")]
    out: PathBuf,
    /// Print every check, and not only those that fail.
    #[arg(long)]
    verbose: bool,
    #[command(flatten)]
    store: StoreArgs,
    #[command(flatten)]
    gate: GateArgs,
}

#[derive(Debug, Clone)]
enum SuiteChoice {
    Solver(Suite),
    Own(PathBuf),
}

impl FromStr for SuiteChoice {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<SuiteChoice, Infallible> {
        Ok(match text {
            "quick" => SuiteChoice::Solver(Suite::Quick),
            "full" => SuiteChoice::Solver(Suite::Full),
            file => SuiteChoice::Own(file.into()),
        })
    }
}

pub(crate) fn verify(arguments: &VerifyArgs, common: &Common) -> anyhow::Result<u8> {
    match &arguments.suite {
        SuiteChoice::Solver(suite) => verify_solver(*suite, arguments, common),
        SuiteChoice::Own(file) => {
            ensure_writable(&arguments.out)?;
            let cases = (arguments.only.as_deref().unwrap_or_default(), arguments.seed);
            match run_own(file, cases, &arguments.gate, &arguments.store, common)? {
                Ok(OwnRun { report, gate, whole }) => {
                    finish(report, gate, whole, arguments, common)
                }
                Err(code) => Ok(code),
            }
        }
    }
}

fn verify_solver(suite: Suite, arguments: &VerifyArgs, common: &Common) -> anyhow::Result<u8> {
    let chosen = chosen(arguments.only.as_deref())?;
    let gate = arguments.gate.read(suite.name(), None)?;
    ensure_writable(&arguments.out)?;
    let whole = chosen.len() == STUDIES.len();
    let report = run(suite, &chosen, arguments, common)?;
    finish(report, gate, whole, arguments, common)
}

/// Judges a run by the baseline, or updates that, and writes the report.
fn finish(
    mut report: Report,
    gate: Gate,
    whole: bool,
    arguments: &VerifyArgs,
    common: &Common,
) -> anyhow::Result<u8> {
    if mtled_run::run::interrupted() {
        return Ok(STOPPED);
    }
    gate.judge(&mut report, whole)?;
    // The report is read back, so that `mtled report` writes the same pages from the file.
    let report = read::from_json(&json::to_json(&report), &arguments.out.join("results.json"))?;
    write_report(&report, &arguments.out)?;
    // All files come before standard output, which may be closed.
    gate.write(&report, whole)?.iter().for_each(|line| common.note(line));
    report_to_github(&report, &arguments.out)?;
    common.print_coloured_summary(&|| Ok(json::to_json(&report)), &|| {
        let table = human::to_table(&report, common.colours(), arguments.verbose);
        format!("{table}\nreport: {}\n", arguments.out.join("index.html").display())
    })?;
    Ok(report.outcome().exit_code())
}

fn chosen(only: Option<&str>) -> anyhow::Result<Vec<&'static Definition>> {
    let matches = |id: &str| only.is_none_or(|pattern| id.contains(pattern));
    let chosen: Vec<_> = STUDIES.iter().filter(|study| matches(study.id)).collect();
    if chosen.is_empty() {
        let names: Vec<&str> = STUDIES.iter().map(|study| study.id).collect();
        bail!("no study matches; the studies are {}", names.join(", "));
    }
    Ok(chosen)
}

/// Runs the studies in parallel.
fn run(
    suite: Suite,
    chosen: &[&Definition],
    arguments: &VerifyArgs,
    common: &Common,
) -> anyhow::Result<Report> {
    let start = Instant::now();
    let name = suite.name();
    let bench = Workbench::new(suite, arguments.seed, &arguments.out)?;
    let ids: Vec<&str> = chosen.iter().map(|study| study.id).collect();
    let earlier = read_report(&arguments.out).ok().filter(|earlier| earlier.suite == name);
    let progress = Progress::new(&ids, earlier.as_ref(), common);
    let one = |definition: &&Definition| {
        progress.begin(definition.id);
        let study = definition.run(&bench);
        progress.end(&study);
        study
    };
    let studies: Vec<Study> = chosen.par_iter().with_max_len(1).map(one).collect();
    progress.clear();
    Ok(Report {
        schema_version: json::SCHEMA_VERSION,
        suite: name.into(),
        provenance: provenance(),
        studies,
        wall_seconds: start.elapsed().as_secs_f64(),
        comparison: None,
    })
}
