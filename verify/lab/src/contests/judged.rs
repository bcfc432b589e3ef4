//! Stored results, judged: errors against references, doubts, costs.

use super::doubt::{Doubt, about_series, about_threads, about_time_apart, is_nothing, wrong_units};
use super::outcome::{Outcome, SolverRun};
use super::problem::ContestCase;
use super::results::{Machine, OWN, Results, ResultsFault, Seen, StoredRun};
use mtled_run::accuracy::Difference;

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
    /// The program, of which it is a recipe: who replies.
    pub program: String,
    /// How it was started, each command once.
    pub commands: Vec<String>,
}

/// All runs of a case.
#[derive(Debug, Clone)]
pub struct CaseRuns<'a> {
    /// The case.
    pub of: &'a ContestCase,
    /// \[program\]\[resolution\]; none of a program without results.
    pub runs: Vec<Vec<SolverRun>>,
    /// \[program\]: what makes its answers doubtful, each once.
    pub doubts: Vec<Vec<Doubt>>,
    /// \[program\]: what its runs have cost, from coarse to fine; none where its answers are
    /// doubtful, or times are those of another machine.
    pub costs: Vec<Vec<RunCost>>,
}

/// What a run has cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunCost {
    /// CPU time of the process \[s\].
    pub process_s: f64,
    /// The same without what the program tells apart \[s\].
    pub solution_s: f64,
    /// Its error \[–\].
    pub error: f64,
}

/// Which CPU time counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Spent {
    /// That of the whole process.
    Process,
    /// That of the solution, without what programs tell apart.
    Solution,
}

impl Spent {
    /// CPU time \[s\] and error \[–\] of runs.
    pub(crate) fn points(self, costs: &[RunCost]) -> Vec<(f64, f64)> {
        let spent = |cost: &RunCost| match self {
            Spent::Process => cost.process_s,
            Spent::Solution => cost.solution_s,
        };
        costs.iter().map(|cost| (spent(cost), cost.error)).collect()
    }

    /// In captions.
    pub(crate) fn label(self) -> &'static str {
        match self {
            Spent::Process => "CPU time of the whole process",
            Spent::Solution => "CPU time of the solution",
        }
    }
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
    let run = |(level, stored): (usize, &StoredRun)| SolverRun {
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
        let mut seen = Seen::default();
        all.iter().try_for_each(|results| seen.add(results))?;
        let machine = commonest(all);
        let mut names: Vec<&str> = all.iter().map(|results| results.solver.as_str()).collect();
        names.sort_unstable_by_key(|name| (*name != OWN, *name));
        names.dedup();
        let mut judged: Vec<CaseRuns> = Vec::new();
        for results in all {
            let of = problem_of(results, cases)?;
            let known = judged.iter().position(|case| case.of.id == of.id).unwrap_or_else(|| {
                judged.push(CaseRuns::new(of, names.len()));
                judged.len() - 1
            });
            let solver = names.iter().position(|name| *name == results.solver).unwrap_or_default();
            let comparable = Some(place_of(results)) == machine;
            judged[known].add(solver, judge(results, of), comparable);
        }
        judged.sort_by(|a, b| a.of.id.cmp(&b.of.id));
        let mut time_limits_s: Vec<f64> = all.iter().map(|results| results.time_limit_s).collect();
        time_limits_s.sort_unstable_by(f64::total_cmp);
        time_limits_s.dedup();
        Ok(Judged {
            solvers: names.iter().map(|name| JudgedSolver::new(name, all)).collect(),
            cases: judged,
            machines: each_once(all.iter().map(|results| results.machine.clone())),
            time_limits_s,
        })
    }
}

impl JudgedSolver {
    fn new(name: &str, all: &[Results]) -> JudgedSolver {
        let own = || all.iter().filter(|results| results.solver == name);
        let program = own().find_map(|results| results.runs.iter().find_map(StoredRun::program));
        JudgedSolver {
            name: name.to_string(),
            program: program.unwrap_or(name).to_string(),
            commands: each_once(own().map(|results| results.command.clone())),
        }
    }
}

impl Judged<'_> {
    /// Which CPU time is compared: that of the solution where a program tells others apart.
    pub(crate) fn spent(&self) -> Spent {
        let mut costs = self.cases.iter().flat_map(|case| case.costs.iter().flatten());
        if costs.any(|cost| cost.solution_s < cost.process_s) {
            Spent::Solution
        } else {
            Spent::Process
        }
    }
}

/// Processor and system.
fn place_of(results: &Results) -> (&str, &str) {
    (&results.machine.processor, &results.machine.system)
}

/// The machine that most results are of, the first by name of several.
fn commonest(all: &[Results]) -> Option<(&str, &str)> {
    let mut counts = std::collections::BTreeMap::new();
    for results in all {
        *counts.entry(place_of(results)).or_insert(0usize) += 1;
    }
    let most = counts.values().max().copied()?;
    counts.into_iter().find(|(_, count)| *count == most).map(|(place, _)| place)
}

fn each_once<T: Ord>(values: impl Iterator<Item = T>) -> Vec<T> {
    let mut all: Vec<T> = values.collect();
    all.sort_unstable();
    all.dedup();
    all
}

impl<'a> CaseRuns<'a> {
    fn new(of: &'a ContestCase, solvers: usize) -> CaseRuns<'a> {
        let (runs, doubts) = (vec![Vec::new(); solvers], vec![Vec::new(); solvers]);
        CaseRuns { of, runs, doubts, costs: vec![Vec::new(); solvers] }
    }

    /// Adds the runs of a program, and whether their times compare.
    fn add(&mut self, solver: usize, runs: Vec<SolverRun>, comparable: bool) {
        self.doubts[solver] = doubts(self.of, &runs);
        if comparable && self.doubts[solver].is_empty() {
            let cost = |run: &SolverRun| {
                let (process_s, error) = (run.cpu_s()?, self.error(run)?.rms);
                let solution_s = process_s - run.apart_cpu_s().unwrap_or(0.0);
                Some(RunCost { process_s, solution_s, error })
            };
            self.costs[solver] = runs.iter().filter_map(cost).collect();
        }
        self.runs[solver] = runs;
    }

    /// The error of a run in the group that is compared first.
    pub(crate) fn error(&self, run: &SolverRun) -> Option<Difference> {
        self.of.error(self.of.group, run.outcome.answered()?)
    }
}

/// What makes the answers of the runs of a case doubtful, each once.
pub fn doubts(case: &ContestCase, runs: &[SolverRun]) -> Vec<Doubt> {
    let answers = runs.iter().filter_map(|run| run.outcome.answered());
    let units = answers.map(|answer| wrong_units(answer, &case.reference.quantities));
    let errors = runs.iter().filter_map(|run| case.error(case.group, run.outcome.answered()?));
    let errors: Vec<Difference> = errors.collect();
    let differs = errors.iter().any(|error| error.rms > error.bar);
    let infinite = errors.iter().any(|error| !error.rms.is_finite()).then_some(Doubt::Infinite);
    let threads = runs.iter().filter_map(about_threads).take(1);
    let apart = runs.iter().filter_map(about_time_apart).take(1);
    let quantities = &case.reference.quantities;
    let nothing = differs && runs.iter().any(|run| is_nothing(run, quantities));
    let nothing = nothing.then_some(Doubt::Nothing);
    let single = units.flatten().take(1).chain(infinite).chain(nothing).chain(threads).chain(apart);
    single.chain(about_series(runs, quantities, differs)).collect()
}
