//! All solvers on all problems as tables.

use super::judged::{CaseRuns, Judged, JudgedSolver, RunCost, Spent};
use super::outcome::{Outcome, SolverRun};
use super::results::OWN;
use super::run_tables::{label, memory_cell};
use crate::lab::label::{optional, percent};
use mtled_checks::escape::printable;
use mtled_checks::report::four_digits;
use mtled_checks::study::{Cell, Table, number, text};
use mtled_run::accuracy::{Cost, cost_at};

/// Errors at which costs may be compared \[–\].
const ERRORS: [f64; 8] = [0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005];
/// CPU times for which the best error is looked for \[s\].
const BUDGETS_S: [f64; 4] = [0.1, 1.0, 10.0, 100.0];

/// Counts of the endings of the runs of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Endings {
    pub runs: usize,
    pub answered: usize,
    pub refused: usize,
    pub timed_out: usize,
    pub faulty: usize,
    /// Problems with doubtful answers.
    pub doubtful: usize,
}

/// The endings of a program on some cases.
pub(crate) fn endings(cases: &[CaseRuns], solver: usize) -> Endings {
    let mut endings = Endings::default();
    for case in cases {
        for run in &case.runs[solver] {
            endings.runs += 1;
            match run.outcome {
                Outcome::Answered(_) => endings.answered += 1,
                Outcome::Refused(..) => endings.refused += 1,
                Outcome::TimedOut => endings.timed_out += 1,
                Outcome::Faulty(_) => endings.faulty += 1,
            }
        }
        endings.doubtful += usize::from(!case.doubts[solver].is_empty());
    }
    endings
}

/// A row per program: who it is and how its runs ended.
pub(crate) fn robustness(all: &Judged) -> Table {
    let row = |(n, entrant): (usize, &JudgedSolver)| {
        let counts = endings(&all.cases, n);
        let runs = || all.cases.iter().flat_map(|case| &case.runs[n]);
        let replies = runs().filter_map(|run| run.outcome.solver());
        let mut replies: Vec<String> = replies
            .map(|solver| printable(&format!("{} {}", solver.name, solver.version)))
            .collect();
        replies.sort_unstable();
        replies.dedup();
        let usages = || runs().filter_map(|run| run.usage);
        let memory = usages().max_by_key(|usage| usage.peak_memory_bytes);
        let least = usages().map(|usage| usage.cpu_s).reduce(f64::min);
        let count = |count: usize| Cell::Number(count as f64);
        vec![
            label(printable(&entrant.name)),
            label(if replies.is_empty() { "–".into() } else { replies.join(", ") }),
            count(counts.runs),
            count(counts.answered),
            count(counts.refused),
            count(counts.timed_out),
            count(counts.faulty),
            count(counts.doubtful),
            Cell::Number(usages().map(|usage| usage.cpu_s).sum()),
            optional(least),
            memory_cell(memory),
        ]
    };
    Table {
        title: "Solvers and how their runs ended".into(),
        columns: vec![
            text("solver"),
            text("replies as"),
            text("runs"),
            text("answered"),
            text("refused"),
            text("timed out"),
            text("faulty"),
            text("problems with doubtful answers"),
            number("CPU time of all runs", "s"),
            number("of the shortest", "s"),
            number("largest peak memory", "MB"),
        ],
        rows: all.solvers.iter().enumerate().map(row).collect(),
    }
}

/// CPU time at equal error, a column per program.
pub(crate) fn equal_errors(all: &Judged, spent: Spent) -> Table {
    let mut columns = vec![text("problem"), text("quantity"), text("rms error")];
    columns.extend(names(all).map(|name| number(&name, "s")));
    let title = match spent {
        Spent::Process => "CPU time at equal error",
        Spent::Solution => "CPU time of the solution at equal error",
    };
    Table {
        title: title.into(),
        columns,
        rows: all.cases.iter().flat_map(|case| costs_of(case, spent)).collect(),
    }
}

fn names(all: &Judged) -> impl Iterator<Item = String> {
    all.solvers.iter().map(|solver| printable(&solver.name))
}

/// What an error costs each program on a case.
pub(crate) struct ErrorCosts<'a> {
    pub case: &'a CaseRuns<'a>,
    pub error: f64,
    /// \[program\]
    pub costs: Vec<Option<Cost>>,
}

/// The errors above the error bar of the reference that a program reaches between two runs.
pub(crate) fn error_costs<'a>(case: &'a CaseRuns<'a>, spent: Spent) -> Vec<ErrorCosts<'a>> {
    let bar = case.of.bar();
    let swapped = |(cpu, error): (f64, f64)| (error, cpu);
    let series: Vec<Vec<(f64, f64)>> = case
        .costs
        .iter()
        .map(|runs| spent.points(runs).into_iter().map(swapped).collect())
        .collect();
    let at = |error: f64| {
        let costs: Vec<Option<Cost>> = series.iter().map(|runs| cost_at(runs, error)).collect();
        let interpolated = costs.iter().flatten().any(|cost| !cost.at_most);
        interpolated.then_some(ErrorCosts { case, error, costs })
    };
    ERRORS.into_iter().filter(|error| *error >= bar).filter_map(at).collect()
}

fn costs_of(case: &CaseRuns, spent: Spent) -> Vec<Vec<Cell>> {
    let row = |at: &ErrorCosts| {
        let mut cells =
            vec![label(&case.of.id), label(case.of.group.label()), label(percent(at.error))];
        let each = at.costs.iter().enumerate();
        cells.extend(each.map(|(n, cost)| cost_cell(!case.costs[n].is_empty(), *cost)));
        cells
    };
    error_costs(case, spent).iter().map(row).collect()
}

pub(crate) fn cost_cell(answered: bool, cost: Option<Cost>) -> Cell {
    match cost {
        _ if !answered => label("–"),
        None => label("not reached"),
        Some(Cost { value, at_most: true }) => label(format!("< {}", four_digits(value))),
        Some(Cost { value, .. }) => Cell::Number(value),
    }
}

/// Error and CPU time of the finest answered run, a pair of columns per program.
pub(crate) fn finest(all: &Judged) -> Table {
    let mut columns = vec![text("problem"), text("quantity"), number("error bar", "1")];
    for name in names(all) {
        columns.push(number(&format!("{name}: rms error"), "1"));
        columns.push(number(&format!("{name}: CPU time"), "s"));
    }
    let row = |case: &CaseRuns| {
        let mut cells =
            vec![label(&case.of.id), label(case.of.group.label()), Cell::Number(case.of.bar())];
        for (n, runs) in case.runs.iter().enumerate() {
            let run = runs.iter().rfind(|run| run.outcome.answered().is_some());
            match (run, runs.last()) {
                (None, Some(last)) => cells.extend([label(short(&last.outcome)), label("–")]),
                (Some(_), _) if !case.doubts[n].is_empty() => {
                    cells.extend([label("doubtful"), label("–")]);
                }
                (run, _) => {
                    let error = run.and_then(|run| case.error(run));
                    cells.push(optional(error.map(|error| error.rms)));
                    cells.push(optional(run.and_then(SolverRun::cpu_s)));
                }
            }
        }
        cells
    };
    Table {
        title: "The finest answered run of each solver".into(),
        columns,
        rows: all.cases.iter().map(row).collect(),
    }
}

fn short(outcome: &Outcome) -> &'static str {
    match outcome {
        Outcome::Answered(_) => "answered",
        Outcome::Refused(..) => "refused",
        Outcome::TimedOut => "timed out",
        Outcome::Faulty(_) => "FAULT",
    }
}

/// The smallest error that each program reaches within a CPU time, a table per time; below the
/// error bar of the reference nothing is decided.
pub(crate) fn budgets(all: &Judged) -> Vec<Table> {
    BUDGETS_S.into_iter().map(|budget_s| best_errors(all, budget_s)).collect()
}

fn best_errors(all: &Judged, budget_s: f64) -> Table {
    let row = |case: &CaseRuns| {
        let bar = case.of.bar();
        let within = |runs: &Vec<RunCost>| {
            let affordable = runs.iter().filter(|run| run.process_s <= budget_s);
            affordable.map(|run| run.error.max(bar)).reduce(f64::min)
        };
        let errors: Vec<Option<f64>> = case.costs.iter().map(within).collect();
        let best = errors.iter().flatten().copied().reduce(f64::min)?;
        let cell = |error: &Option<f64>| match error {
            None => label("–"),
            Some(error) if *error <= best => label(format!("{} ●", percent(*error))),
            Some(error) => label(percent(*error)),
        };
        let mut cells = vec![label(&case.of.id)];
        cells.extend(errors.iter().map(cell));
        Some(cells)
    };
    let mut columns = vec![text("problem")];
    columns.extend(names(all).map(|name| text(&name)));
    Table {
        title: format!("Smallest error for {budget_s} CPU s; ● marks the best"),
        columns,
        rows: all.cases.iter().filter_map(row).collect(),
    }
}

/// Where another program reaches an error for less, or alone: a row per problem and error. None
/// where mtled did not take part.
pub(crate) fn losses(all: &Judged) -> Option<Table> {
    let own = all.solvers.iter().position(|solver| solver.name == OWN)?;
    let row = |at: &ErrorCosts| {
        let value = |n: usize| at.costs[n].map(|cost| cost.value);
        let others = (0..at.costs.len()).filter(|n| *n != own);
        let best = others.filter_map(|n| Some((value(n)?, n))).min_by(|a, b| a.0.total_cmp(&b.0));
        let (cost, n) = best.filter(|(cost, _)| value(own).is_none_or(|own| own > *cost))?;
        Some(vec![
            label(&at.case.of.id),
            label(percent(at.error)),
            cost_cell(!at.case.costs[own].is_empty(), at.costs[own]),
            label(printable(&all.solvers[n].name)),
            cost_cell(true, at.costs[n]),
            optional(value(own).map(|own| own / cost)),
        ])
    };
    let rows = all.cases.iter().flat_map(|case| {
        error_costs(case, Spent::Process).iter().filter_map(row).collect::<Vec<_>>()
    });
    Some(Table {
        title: "Where mtled loses: errors that another solver reaches for less CPU time".into(),
        columns: vec![
            text("problem"),
            text("rms error"),
            number("mtled", "s"),
            text("cheapest"),
            number("its CPU time", "s"),
            number("ratio", "1"),
        ],
        rows: rows.collect(),
    })
}

/// At how many errors of all problems each program is the cheapest, and of how many it reaches.
pub(crate) fn wins(all: &Judged) -> Table {
    let at: Vec<ErrorCosts> =
        all.cases.iter().flat_map(|case| error_costs(case, Spent::Process)).collect();
    let row = |(n, solver): (usize, &JudgedSolver)| {
        let value = |at: &ErrorCosts, n: usize| at.costs[n].map(|cost| cost.value);
        let cheapest = |at: &&ErrorCosts| {
            value(at, n).is_some_and(|own| {
                (0..at.costs.len()).all(|m| value(at, m).is_none_or(|cost| own <= cost))
            })
        };
        vec![
            label(printable(&solver.name)),
            Cell::Number(at.iter().filter(cheapest).count() as f64),
            Cell::Number(at.iter().filter(|at| at.costs[n].is_some()).count() as f64),
            Cell::Number(at.len() as f64),
        ]
    };
    Table {
        title: "Levels of error reached, and reached for the least CPU time".into(),
        columns: vec![text("solver"), text("cheapest at"), text("reached"), text("of")],
        rows: all.solvers.iter().enumerate().map(row).collect(),
    }
}
