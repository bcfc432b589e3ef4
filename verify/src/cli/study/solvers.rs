//! `mtled study solvers`.

use crate::bundled::REFERENCES;
use crate::cli::common::{Common, STOPPED, command_line};
use crate::cli::publish::{publish, report_of, tables};
use crate::contests::solvers::{Contest, ContestCase, Entrant, Spacing, hold};
use crate::lab::store::Source;
use anyhow::{Context, Result, bail};
use clap::Args;
use mtled_checks::input::read_text;
use mtled_checks::report::{ensure_writable, write_atomically};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, Args)]
#[command(after_help = PROTOCOL)]
pub struct SolversArgs {
    /// Case files, or names of bundled cases [default: all bundled cases with a reference].
    cases: Vec<String>,
    /// A program that takes part: its name and its command, in which {job} and {answer} stand for
    /// the two files; may be repeated. Words are separated as in a shell, but none is started.
    #[arg(long = "solver", value_name = "NAME=COMMAND")]
    solvers: Vec<Entrant>,
    /// Leave mtled itself out.
    #[arg(long)]
    without_mtled: bool,
    /// Distances of nodes from coarse to fine, in metres or as factors of the case's own.
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "x2,x1.41,x1")]
    spacing: Vec<Spacing>,
    /// Time on the clock after which a run is killed [s].
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds)]
    time_limit: f64,
    /// A reference file in the layout of `reference/data`, for a case of your own; may be
    /// repeated.
    #[arg(long = "reference", value_name = "FILE")]
    references: Vec<PathBuf>,
    /// Folder for index.html, solvers.md, results.json and figures.
    #[arg(long, default_value = "reports/solvers", value_name = "DIR")]
    out: PathBuf,
}

const PROTOCOL: &str =
    "A program reads the job, a JSON file, solves it and writes the answer, another JSON file.
reference/adapters/README.md describes both; `mtled protocol schema` prints their JSON Schemas.
mtled takes part with the recipe of the case file, as `mtled protocol solve {job} {answer}`.
Exit code 1 says that a program broke the protocol or that its answers are doubtful; refusals and
time limits are results.

Examples:
  mtled study solvers --solver 'mine=python3 mine.py {job} {answer}'
  mtled study solvers my_case.toml --reference my_reference.json --solver 'mine=./mine {job} {answer}'";

/// A time limit \[s\]; a week at most.
fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value <= 604_800.0 => Ok(value),
        _ => Err("it must be a time in seconds, more than 0 and at most a week".into()),
    }
}

pub fn solvers_study(arguments: &SolversArgs, common: &Common) -> Result<u8> {
    let start = Instant::now();
    let folder = tempfile::tempdir().context("cannot make a folder for the bundled cases")?;
    let contest = contest(arguments, folder.path())?;
    ensure_writable(&arguments.out)?;
    let Some(study) = hold(&contest, &|text| common.note(text))? else { return Ok(STOPPED) };
    let report = report_of("solvers", study, start);
    let tables = tables(&report);
    write_atomically(&arguments.out.join("solvers.md"), tables.as_bytes())?;
    publish(&report, &arguments.out, common, &|| tables.clone())
}

/// What is to be run; bundled cases are unpacked into a folder.
fn contest(arguments: &SolversArgs, folder: &Path) -> Result<Contest> {
    let entrants = entrants(arguments)?;
    let read = |file: &PathBuf| {
        let name = file.display().to_string();
        let text = read_text(file);
        Ok((name.clone(), text.with_context(|| format!("cannot read the reference {name}"))?))
    };
    let references: Vec<(String, String)> =
        arguments.references.iter().map(read).collect::<Result<_>>()?;
    let names = if arguments.cases.is_empty() {
        REFERENCES.iter().map(|(name, _)| name.to_string()).collect()
    } else {
        arguments.cases.clone()
    };
    let case = |name: &String| {
        let source = Source::find(name, folder, &[]).context("the case cannot be used")?;
        ContestCase::new(source, &references, &arguments.spacing)
    };
    let cases: Vec<ContestCase> = names.iter().map(case).collect::<Result<_>>()?;
    Ok(Contest { entrants, cases, time_limit_s: arguments.time_limit, command: command_line() })
}

/// mtled and the others, each with a name of its own.
fn entrants(arguments: &SolversArgs) -> Result<Vec<Entrant>> {
    let mut entrants = Vec::new();
    if !arguments.without_mtled {
        let program = std::env::current_exe().context("the path of this program is not known")?;
        entrants.push(Entrant::own(&program));
    }
    for solver in &arguments.solvers {
        if entrants.iter().any(|known: &Entrant| known.name == solver.name) {
            bail!("there are two solvers called {}", solver.name);
        }
        entrants.push(solver.clone());
    }
    if entrants.is_empty() {
        bail!("no solver takes part; name one with --solver NAME=COMMAND");
    }
    Ok(entrants)
}
