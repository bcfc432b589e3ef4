//! `mtled contest …`.

use super::common::{Common, STOPPED, command_line};
use super::publish::{report_of, tables};
use crate::bundled::REFERENCES;
use crate::contests::solvers::{
    Contest, ContestCase, Entrant, History, Identity, Judged, LONGEST_RUN_S, Outcome, Results,
    ResultsFault, Seen, SolverRun, Spacing, StoredEnd, benchmark, doubts, judge, problem_of,
    result_files, study, write_pages,
};
use crate::lab::label::percent;
use crate::lab::store::Source;
use anyhow::{Context, Result, bail};
use clap::{Args, Subcommand};
use mtled_checks::escape::printable;
use mtled_checks::input::read_text;
use mtled_checks::report::{ensure_writable, json, svg, write_atomically};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, Subcommand)]
pub enum ContestCommand {
    /// List the problems of the benchmark with their versions and fingerprints.
    List,
    /// Run programs on problems at several resolutions, store their raw answers and judge them.
    Run(RunArgs),
    /// Judge stored results again, without running anything; exit code 1 where one is not
    /// believed, 3 where answers are doubtful.
    Check(CheckArgs),
    /// Judge stored results and write pages about them: all, each solver, each problem.
    Pages(PagesArgs),
}

#[derive(Debug, Args)]
#[command(after_help = PROTOCOL)]
pub struct RunArgs {
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
    /// Folder for the pages, tables.md and results/SOLVER/PROBLEM.json.
    #[arg(long, default_value = "reports/contest", value_name = "DIR")]
    out: PathBuf,
}

#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Files of results, or folders of them.
    #[arg(required = true)]
    results: Vec<PathBuf>,
    #[command(flatten)]
    own: OwnProblems,
}

#[derive(Debug, Args)]
pub struct PagesArgs {
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

#[derive(Debug, Args)]
struct OwnProblems {
    /// A case of your own that there are results of; may be repeated.
    #[arg(long = "case", value_name = "FILE")]
    cases: Vec<String>,
    /// A reference file in the layout of `reference/data` for it; may be repeated.
    #[arg(long = "reference", value_name = "FILE")]
    references: Vec<PathBuf>,
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

pub fn contest(command: &ContestCommand, common: &Common) -> Result<u8> {
    match command {
        ContestCommand::List => list(common),
        ContestCommand::Run(arguments) => run(arguments, common),
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
    let start = Instant::now();
    let folder = tempfile::tempdir().context("cannot make a folder for the bundled cases")?;
    let entrants = entrants(arguments)?;
    let names = if arguments.cases.is_empty() { bundled() } else { arguments.cases.clone() };
    let cases = cases(&names, &arguments.references, folder.path())?;
    let laddered = cases.into_iter().map(|case| {
        let spacings_m = case.ladder(&arguments.spacing)?;
        Ok((case, spacings_m))
    });
    let cases = laddered.collect::<Result<Vec<_>>>()?;
    let contest = Contest { entrants, cases, time_limit_s: arguments.time_limit };
    ensure_writable(&arguments.out)?;
    let mut all = Vec::new();
    let mut keep = |results: Results| {
        let path = arguments.out.join("results").join(results.path());
        let text = serde_json::to_string(&results)? + "\n";
        write_atomically(&path, text.as_bytes())?;
        all.push(results);
        Ok(())
    };
    let whole = contest.run(&|text| common.note(text), &mut keep)?;
    if !whole {
        return Ok(STOPPED);
    }
    let cases: Vec<ContestCase> = contest.cases.into_iter().map(|(case, _)| case).collect();
    publish(&Judged::new(&all, &cases)?, None, &arguments.out, start, common)
}

/// Writes pages and tables of judged results and prints the latter.
fn publish(
    judged: &Judged,
    history: Option<&History>,
    out: &Path,
    start: Instant,
    common: &Common,
) -> Result<u8> {
    let report = report_of("contest", study(judged, command_line()), start);
    write_pages(judged, history, out)?;
    if let Some(overview) = report.studies[0].figures.first() {
        write_atomically(&out.join("overview.svg"), svg::to_svg_file(overview).as_bytes())?;
    }
    let tables = tables(&report);
    write_atomically(&out.join("tables.md"), tables.as_bytes())?;
    let page = out.join("index.html");
    common.print_summary(&|| Ok(json::to_json(&report)), &|| {
        format!("{tables}\nreport: {}\n", page.display())
    })?;
    Ok(report.outcome().exit_code())
}

/// What is said of a file of results.
#[derive(Serialize)]
struct Verdict {
    file: String,
    /// None where it is not believed.
    result: Option<String>,
    faults: Vec<String>,
    doubts: Vec<String>,
}

/// Says of every file whether it is believed, and how its runs ended. Exit code 1 where one is not
/// believed, 3 where answers are doubtful.
fn check(arguments: &CheckArgs, common: &Common) -> Result<u8> {
    let folder = tempfile::tempdir().context("cannot make a folder for the bundled cases")?;
    let cases = problems(&arguments.own, folder.path())?;
    let mut seen = Seen::default();
    let files = files(&arguments.results)?;
    let verdicts: Vec<Verdict> =
        files.iter().map(|file| verdict(file, &cases, &mut seen)).collect();
    let line = |verdict: &Verdict| {
        let result = verdict.result.as_ref()?;
        Some(format!("{}: {result}\n", verdict.file))
    };
    let text = || verdicts.iter().filter_map(line).collect::<String>();
    common.print_summary(&|| Ok(serde_json::to_string(&verdicts)? + "\n"), &text)?;
    for verdict in &verdicts {
        let file = &verdict.file;
        verdict.faults.iter().for_each(|fault| common.complain(format!("{file}: {fault}")));
        let doubts = verdict.doubts.iter();
        doubts.for_each(|doubt| common.complain(format!("{file}: doubtful: {doubt}")));
    }
    Ok(if verdicts.iter().any(|verdict| !verdict.faults.is_empty()) {
        1
    } else if verdicts.iter().any(|verdict| !verdict.doubts.is_empty()) {
        3
    } else {
        0
    })
}

/// Judges a file, beside those that were judged before.
fn verdict(file: &Path, cases: &[ContestCase], seen: &mut Seen) -> Verdict {
    let mut verdict = Verdict {
        file: printable(&file.display().to_string()),
        result: None,
        faults: Vec::new(),
        doubts: Vec::new(),
    };
    let (results, case) = match believed(file, cases) {
        Ok(known) => known,
        Err(fault) => {
            verdict.faults.push(fault.to_string());
            return verdict;
        }
    };
    let runs = judge(&results, case);
    for (n, (run, stored)) in runs.iter().zip(&results.runs).enumerate() {
        if let (Outcome::Faulty(fault), StoredEnd::Reply(_)) = (&run.outcome, &stored.ended) {
            verdict.faults.push(format!("runs[{n}]: {fault}"));
        }
    }
    verdict.doubts = doubts(case, &runs).iter().map(ToString::to_string).collect();
    verdict.result = Some(judgement(&results, case, &runs));
    verdict.faults.extend(seen.add(&results).err().map(|fault| fault.to_string()));
    verdict
}

fn believed<'a>(
    file: &Path,
    cases: &'a [ContestCase],
) -> Result<(Results, &'a ContestCase), ResultsFault> {
    let results = Results::read(file)?;
    let case = problem_of(&results, cases)?;
    Ok((results, case))
}

/// What is said of believed results: the errors of answers, and how other runs ended.
fn judgement(results: &Results, case: &ContestCase, runs: &[SolverRun]) -> String {
    let said = runs.iter().map(|run| {
        let answered = run.outcome.answered();
        let error = answered.and_then(|answered| case.error(case.group, answered));
        let end = error.map_or_else(|| run.outcome.label(), |error| percent(error.rms));
        format!("{} m {end}", run.spacing_m)
    });
    let said: Vec<String> = said.collect();
    let what = case.group.label();
    format!("{} on {}, error of the {what}: {}", results.solver, results.problem, said.join(", "))
}

fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut all = Vec::new();
    for path in paths {
        all.extend(result_files(path).with_context(|| format!("cannot read {}", path.display()))?);
    }
    if all.is_empty() {
        bail!("there are no results (*.json) in {}", paths[0].display());
    }
    Ok(all)
}

fn bundled() -> Vec<String> {
    REFERENCES.iter().map(|(name, _)| name.to_string()).collect()
}

/// The benchmark and the problems of the user; bundled cases are unpacked into a folder.
fn problems(own: &OwnProblems, folder: &Path) -> Result<Vec<ContestCase>> {
    cases(&[own.cases.clone(), bundled()].concat(), &own.references, folder)
}

fn cases(names: &[String], references: &[PathBuf], folder: &Path) -> Result<Vec<ContestCase>> {
    let read = |file: &PathBuf| {
        let name = file.display().to_string();
        let text = read_text(file);
        Ok((name.clone(), text.with_context(|| format!("cannot read the reference {name}"))?))
    };
    let references: Vec<(String, String)> = references.iter().map(read).collect::<Result<_>>()?;
    let known = benchmark();
    let case = |name: &String| {
        let problem = known.iter().find(|problem| problem.id == *name);
        let name = problem.map_or(name, |problem| &problem.case);
        let source = Source::find(name, folder, &[]).context("the case cannot be used")?;
        ContestCase::new(source, &references)
    };
    names.iter().map(case).collect()
}

/// mtled and the others, each with a name of its own.
fn entrants(arguments: &RunArgs) -> Result<Vec<Entrant>> {
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
