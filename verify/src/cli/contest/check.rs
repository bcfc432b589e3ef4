//! `mtled contest check`.

use super::problems::{OwnProblems, believed, files, problems};
use crate::cli::common::Common;
use anyhow::{Context, Result};
use clap::Args;
use mtled_checks::escape::printable;
use mtled_lab::contests::{
    ContestCase, Outcome, Results, Seen, SolverRun, StoredEnd, doubts, judge,
};
use mtled_lab::lab::label::percent;
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// Files of results, or folders of them.
    #[arg(required = true)]
    results: Vec<PathBuf>,
    #[command(flatten)]
    own: OwnProblems,
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
pub(crate) fn check(arguments: &CheckArgs, common: &Common) -> Result<u8> {
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
