//! Stored results, judged: errors against references, doubts, costs.

use super::doubt::{Doubt, about_series, wrong_units};
use super::outcome::{Outcome, SolverRun};
use super::problem::ContestCase;
use super::results::{Machine, Results, ResultsFault};
use crate::accuracy::Difference;

/// Results of solvers on problems.
#[derive(Debug)]
pub struct Judged<'a> {
    /// mtled first, the others in the order of their names.
    pub solvers: Vec<JudgedSolver>,
    /// In the order of their identities.
    pub cases: Vec<CaseRuns<'a>>,
    /// Where and when, each once.
    pub machines: Vec<Machine>,
    /// Time limits on the clock \[s\], each once.
    pub time_limits_s: Vec<f64>,
}

/// Who took part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JudgedSolver {
    /// In tables.
    pub name: String,
    /// How it was started, each command once.
    pub commands: Vec<String>,
}

/// All runs of a case.
#[derive(Debug)]
pub struct CaseRuns<'a> {
    /// The case.
    pub of: &'a ContestCase,
    /// \[program\]\[resolution\]; none of a program without results.
    pub runs: Vec<Vec<SolverRun>>,
}

/// The problem that results are of.
pub fn problem_of<'a>(
    results: &Results,
    cases: &'a [ContestCase],
) -> Result<&'a ContestCase, ResultsFault> {
    let named = cases.iter().find(|case| case.id == results.problem);
    let case = named.ok_or_else(|| ResultsFault::Problem(results.problem.clone()))?;
    let expected = &case.source.case.problem_hash;
    if results.inputs != *expected {
        let (problem, expected) = (case.id.clone(), expected.clone());
        return Err(ResultsFault::Inputs { problem, expected });
    }
    Ok(case)
}

/// Judges the runs of results of a case.
pub fn judge(results: &Results, case: &ContestCase) -> Vec<SolverRun> {
    let instants = case.reference.times.len();
    let run = |(level, stored): (usize, &super::results::StoredRun)| SolverRun {
        level,
        spacing_m: stored.spacing_m,
        outcome: Outcome::judged(&stored.ended, &case.source.case, instants),
        usage: stored.usage,
    };
    results.runs.iter().enumerate().map(run).collect()
}

impl<'a> Judged<'a> {
    /// Judges results, each of one of the cases.
    pub fn new(all: &[Results], cases: &'a [ContestCase]) -> Result<Judged<'a>, ResultsFault> {
        let mut names: Vec<&str> = all.iter().map(|results| results.solver.as_str()).collect();
        names.sort_unstable_by_key(|name| (*name != OWN, *name));
        names.dedup();
        let solver = |name: &&str| {
            let own = all.iter().filter(|results| results.solver == *name);
            JudgedSolver {
                name: name.to_string(),
                commands: each_once(own.map(|results| results.command.clone())),
            }
        };
        let mut judged: Vec<CaseRuns> = Vec::new();
        for results in all {
            let of = problem_of(results, cases)?;
            let known = judged.iter().position(|case| case.of.id == of.id).unwrap_or_else(|| {
                judged.push(CaseRuns { of, runs: vec![Vec::new(); names.len()] });
                judged.len() - 1
            });
            let place = names.iter().position(|name| *name == results.solver);
            judged[known].runs[place.unwrap_or_default()] = judge(results, of);
        }
        judged.sort_by(|a, b| a.of.id.cmp(&b.of.id));
        let mut time_limits_s: Vec<f64> = all.iter().map(|results| results.time_limit_s).collect();
        time_limits_s.sort_unstable_by(f64::total_cmp);
        time_limits_s.dedup();
        Ok(Judged {
            solvers: names.iter().map(solver).collect(),
            cases: judged,
            machines: each_once(all.iter().map(|results| results.machine.clone())),
            time_limits_s,
        })
    }
}

/// Name of this program among the solvers.
pub const OWN: &str = "mtled";

fn each_once<T: Ord>(values: impl Iterator<Item = T>) -> Vec<T> {
    let mut all: Vec<T> = values.collect();
    all.sort_unstable();
    all.dedup();
    all
}

impl CaseRuns<'_> {
    /// The error of a run in the group that is compared first.
    pub fn error(&self, run: &SolverRun) -> Option<Difference> {
        self.of.error(self.of.group, run.outcome.answered()?)
    }

    /// What makes the answers of a program doubtful, each once.
    pub fn doubts(&self, solver: usize) -> Vec<Doubt> {
        doubts(self.of, &self.runs[solver])
    }

    /// CPU time \[s\] and error \[–\] of the runs of a program, from coarse to fine; none where
    /// its answers are doubtful.
    pub fn costs(&self, solver: usize) -> Vec<(f64, f64)> {
        if !self.doubts(solver).is_empty() {
            return Vec::new();
        }
        let runs = self.runs[solver].iter();
        runs.filter_map(|run| Some((run.cpu_s()?, self.error(run)?.rms))).collect()
    }
}

/// What makes the answers of the runs of a case doubtful, each once.
pub fn doubts(case: &ContestCase, runs: &[SolverRun]) -> Vec<Doubt> {
    let answers = runs.iter().filter_map(|run| run.outcome.answered());
    let units = answers.map(|answer| wrong_units(answer, &case.reference.quantities));
    let mut errors = runs.iter().filter_map(|run| case.error(case.group, run.outcome.answered()?));
    let differs = errors.any(|error| error.rms > error.bar);
    units.flatten().take(1).chain(about_series(runs, differs)).collect()
}
