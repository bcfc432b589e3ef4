//! `mtled contest …`.

mod check;
mod hold;
mod problems;
mod race;

use super::common::Common;
use anyhow::{Context, Result, bail};
use check::{CheckArgs, check};
use clap::{Args, Subcommand};
use hold::{held, publish};
use mtled_lab::contests::{
    Contest, Entrant, History, Identity, Judged, LONGEST_RUN_S, Spacing, benchmark,
};
use problems::{OwnProblems, believed, bundled, cases, files, laddered, problems};
use race::{RaceArgs, race};
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Subcommand)]
pub(crate) enum ContestCommand {
    /// List the problems of the benchmark with their versions and fingerprints.
    List,
    /// Run programs on problems at several resolutions, store their raw answers and judge them.
    Run(RunArgs),
    /// Run recipes of mtled beside elements of FEniCSx, FElupe and scikit-fem on the problems of
    /// `reference/race.toml`: speed against error.
    Race(RaceArgs),
    /// Judge stored results again, without running anything; exit code 1 where one is not
    /// believed, 3 where answers are doubtful.
    Check(CheckArgs),
    /// Judge stored results and write pages about them: all, each solver, each problem.
    Pages(PagesArgs),
}

#[derive(Debug, Args)]
#[command(after_help = PROTOCOL)]
pub(crate) struct RunArgs {
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
    /// How often every run is made; that with the median time counts.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    repeat: u16,
    /// A reference file in the layout of `reference/data`, for a case of your own; may be
    /// repeated.
    #[arg(long = "reference", value_name = "FILE")]
    references: Vec<PathBuf>,
    /// Folder for the pages, tables.md and results/SOLVER/PROBLEM.json.
    #[arg(long, default_value = "reports/contest", value_name = "DIR")]
    out: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct PagesArgs {
    /// Files of results, or folders of them.
    #[arg(required = true)]
    results: Vec<PathBuf>,
    #[command(flatten)]
    own: OwnProblems,
    /// Figures of mtled by commit, as reports/history.py writes them, for a page of their own.
    #[arg(long, value_name = "FILE")]
    history: Option<PathBuf>,
    /// Folder for the pages and tables.md.
    #[arg(long, default_value = "reports/contest", value_name = "DIR")]
    out: PathBuf,
}

const PROTOCOL: &str =
    "A program reads the job, a JSON file, solves it and writes the answer, another JSON file.
reference/adapters/README.md describes both; `mtled protocol schema` prints their JSON Schemas.
mtled takes part with the recipe of the case file, as `mtled protocol solve {job} {answer}`.
Exit code 1 says that a program broke the protocol or that its answers are doubtful; refusals and
time limits are results.

Examples:
  mtled contest run --solver 'mine=python3 mine.py {job} {answer}'
  mtled contest run my_case.toml --reference my_reference.json --solver 'mine=./mine {job} {answer}'";

/// A time limit \[s\]; a week at most.
fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value <= LONGEST_RUN_S => Ok(value),
        _ => Err("it must be a time in seconds, more than 0 and at most a week".into()),
    }
}

pub(crate) fn contest(command: &ContestCommand, common: &Common) -> Result<u8> {
    match command {
        ContestCommand::List => list(common),
        ContestCommand::Run(arguments) => run(arguments, common),
        ContestCommand::Race(arguments) => race(arguments, common),
        ContestCommand::Check(arguments) => check(arguments, common),
        ContestCommand::Pages(arguments) => {
            let start = Instant::now();
            let folder = tempfile::tempdir().context("cannot make a folder for bundled cases")?;
            let cases = problems(&arguments.own, folder.path())?;
            let history = arguments.history.as_deref().map(History::read).transpose()?;
            let mut all = Vec::new();
            for file in files(&arguments.results)? {
                let results = believed(&file, &cases);
                all.push(results.with_context(|| file.display().to_string())?.0);
            }
            let judged = Judged::new(&all, &cases)?;
            // Faults and doubts are what the pages are about.
            publish(&judged, history.as_ref(), &arguments.out, start, common).map(|_| 0)
        }
    }
}

fn list(common: &Common) -> Result<u8> {
    let row = |problem: &Identity| {
        let (id, group) = (&problem.id, &problem.group);
        format!("{id}  {group}\n  inputs {}\n  references {}\n", problem.inputs, problem.references)
    };
    let document = || Ok(serde_json::to_string(benchmark())? + "\n");
    common.print_summary(&document, &|| benchmark().iter().map(row).collect())?;
    Ok(0)
}

fn run(arguments: &RunArgs, common: &Common) -> Result<u8> {
    let folder = tempfile::tempdir().context("cannot make a folder for the bundled cases")?;
    let entrants = entrants(arguments)?;
    let names = if arguments.cases.is_empty() { bundled() } else { arguments.cases.clone() };
    let cases = cases(&names, &arguments.references, folder.path())?;
    let time_limit_s = arguments.time_limit;
    let contest = Contest {
        entrants,
        cases: laddered(cases, &arguments.spacing)?,
        time_limit_s,
        repetitions: arguments.repeat.into(),
    };
    held(contest, &arguments.out, common)
}

/// mtled and the others, each with a name of its own.
fn entrants(arguments: &RunArgs) -> Result<Vec<Entrant>> {
    let mut entrants = Vec::new();
    if !arguments.without_mtled {
        let program = std::env::current_exe().context("the path of this program is not known")?;
        entrants.push(Entrant::own(&program, "mtled", &[]));
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
