//! The contest as tables.

use super::contest::{CaseRuns, Contest};
use super::doubt::false_claim;
use super::outcome::{Outcome, SolverRun};
use super::process::Usage;
use crate::accuracy::{Cost, Group, cost_at};
use crate::lab::label::{optional, percent};
use mtled_checks::escape::printable;
use mtled_checks::measure::log_log_fit;
use mtled_checks::report::four_digits;
use mtled_checks::study::{Cell, Table, number, text};

/// Errors at which costs may be compared \[–\].
const ERRORS: [f64; 8] = [0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005];
/// A fitted order is reported only above this many times its standard deviation.
const SIGNIFICANT: f64 = 2.0;

fn label(text: impl Into<String>) -> Cell {
    Cell::Text(text.into())
}

/// Counts of the endings of the runs of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Endings {
    pub runs: usize,
    pub answered: usize,
    pub refused: usize,
    pub timed_out: usize,
    pub faulty: usize,
    /// Cases with doubtful answers.
    pub doubtful: usize,
}

/// The endings of a program on all cases.
pub fn endings(all: &[CaseRuns], entrant: usize) -> Endings {
    let mut endings = Endings::default();
    for case in all {
        for run in &case.runs[entrant] {
            endings.runs += 1;
            match run.outcome {
                Outcome::Answered(_) => endings.answered += 1,
                Outcome::Refused(..) => endings.refused += 1,
                Outcome::TimedOut => endings.timed_out += 1,
                Outcome::Faulty(_) => endings.faulty += 1,
            }
        }
        endings.doubtful += usize::from(!case.doubts(entrant).is_empty());
    }
    endings
}

/// A row per program: who it is and how its runs ended.
pub fn robustness(contest: &Contest, all: &[CaseRuns]) -> Table {
    let row = |(n, entrant): (usize, &super::entrant::Entrant)| {
        let counts = endings(all, n);
        let runs = || all.iter().flat_map(|case| &case.runs[n]);
        let solver = runs().find_map(|run| run.outcome.solver());
        let usages = || runs().filter_map(|run| run.usage);
        let memory = usages().max_by_key(|usage| usage.peak_memory_bytes);
        let least = usages().map(|usage| usage.cpu_s).reduce(f64::min);
        let count = |count: usize| Cell::Number(count as f64);
        vec![
            label(printable(&entrant.name)),
            label(solver.map_or("–".into(), |solver| {
                printable(&format!("{} {}", solver.name, solver.version))
            })),
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
            text("cases with doubtful answers"),
            number("CPU time of all runs", "s"),
            number("of the shortest", "s"),
            number("largest peak memory", "MB"),
        ],
        rows: contest.entrants.iter().enumerate().map(row).collect(),
    }
}

/// CPU time at equal error, a column per program.
pub fn equal_errors(contest: &Contest, all: &[CaseRuns]) -> Table {
    let mut columns = vec![text("case"), text("quantity"), text("rms error")];
    let names = contest.entrants.iter().map(|entrant| printable(&entrant.name));
    columns.extend(names.map(|name| number(&name, "s")));
    Table {
        title: "CPU time at equal error".into(),
        columns,
        rows: all.iter().flat_map(costs_of).collect(),
    }
}

/// A row for each error above the error bar of the reference that a program reaches.
fn costs_of(case: &CaseRuns) -> Vec<Vec<Cell>> {
    let bar = bar_of(case).unwrap_or(0.0);
    let series: Vec<Vec<(f64, f64)>> = (0..case.runs.len())
        .map(|n| case.costs(n).iter().map(|&(cpu, error)| (error, cpu)).collect())
        .collect();
    let row = |error: f64| {
        let costs: Vec<Option<Cost>> = series.iter().map(|runs| cost_at(runs, error)).collect();
        let interpolated = costs.iter().flatten().any(|cost| !cost.at_most);
        interpolated.then(|| {
            let name = label(&case.of.source.name);
            let mut cells = vec![name, label(case.of.group.label()), label(percent(error))];
            cells.extend(series.iter().zip(&costs).map(|(runs, cost)| cost_cell(runs, *cost)));
            cells
        })
    };
    ERRORS.into_iter().filter(|error| *error >= bar).filter_map(row).collect()
}

fn cost_cell(runs: &[(f64, f64)], cost: Option<Cost>) -> Cell {
    match cost {
        _ if runs.is_empty() => label("–"),
        None => label("not reached"),
        Some(Cost { value, at_most: true }) => label(format!("< {}", four_digits(value))),
        Some(Cost { value, .. }) => Cell::Number(value),
    }
}

/// The error bar of the reference of a case, in the group that is compared first \[–\].
pub fn bar_of(case: &CaseRuns) -> Option<f64> {
    let values: Vec<Vec<f64>> =
        case.of.reference.quantities.iter().map(|known| known.values.clone()).collect();
    let known = case.of.reference.difference(&case.of.source.case, case.of.group, &values)?;
    Some(known.bar)
}

/// Error and CPU time of the finest answered run, a pair of columns per program.
pub fn finest(contest: &Contest, all: &[CaseRuns]) -> Table {
    let mut columns = vec![text("case"), text("quantity"), number("error bar", "1")];
    for entrant in &contest.entrants {
        let name = printable(&entrant.name);
        columns.push(number(&format!("{name}: rms error"), "1"));
        columns.push(number(&format!("{name}: CPU time"), "s"));
    }
    let row = |case: &CaseRuns| {
        let mut cells =
            vec![label(&case.of.source.name), label(case.of.group.label()), optional(bar_of(case))];
        for (n, runs) in case.runs.iter().enumerate() {
            let run = runs.iter().rfind(|run| run.outcome.answered().is_some());
            match (run, runs.last()) {
                (None, Some(last)) => cells.extend([label(short(&last.outcome)), label("–")]),
                (Some(_), _) if !case.doubts(n).is_empty() => {
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
        rows: all.iter().map(row).collect(),
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

/// All runs of a program.
pub fn runs_of(contest: &Contest, all: &[CaseRuns], entrant: usize) -> Table {
    let rows =
        all.iter().flat_map(|case| case.runs[entrant].iter().map(move |run| run_row(case, run)));
    Table {
        title: format!("{}: all runs", printable(&contest.entrants[entrant].name)),
        columns: vec![
            text("case"),
            text("level"),
            number("spacing", "m"),
            text("unknowns"),
            text("compared"),
            number("error, rms", "1"),
            number("error, largest", "1"),
            text("against the error bar of the reference"),
            number("reactions, rms error", "1"),
            number("strain energy, error", "1"),
            number("CPU time", "s"),
            number("claimed", "s"),
            number("wall time", "s"),
            number("peak memory", "MB"),
            text("outcome"),
        ],
        rows: rows.collect(),
    }
}

fn run_row(case: &CaseRuns, run: &SolverRun) -> Vec<Cell> {
    let answered = run.outcome.answered();
    let error = case.error(run);
    let of = |group: Group| answered.and_then(|answered| case.of.error(group, answered));
    let usage = run.usage;
    let outcome = match false_claim(run) {
        Some(claim) => format!("{}; {claim}", run.outcome.label()),
        None => run.outcome.label(),
    };
    vec![
        label(&case.of.source.name),
        Cell::Number(run.level as f64),
        Cell::Number(run.spacing_m),
        answered.map_or(label("–"), |answered| label(answered.unknowns.to_string())),
        label(case.of.group.label()),
        optional(error.map(|error| error.rms)),
        optional(error.map(|error| error.max)),
        label(match error {
            None => "–",
            Some(error) if error.rms <= error.bar => "inconclusive: not larger",
            Some(_) => "larger",
        }),
        optional(of(Group::Force).map(|error| error.rms)),
        optional(of(Group::StrainEnergy).map(|error| error.rms)),
        optional(run.cpu_s()),
        optional(answered.and_then(|answered| answered.claimed_cpu_s)),
        optional(usage.map(|usage| usage.wall_s)),
        memory_cell(usage),
        label(outcome),
    ]
}

/// Peak memory \[MB\]; an upper bound where the system cannot tell it from that of this program.
fn memory_cell(usage: Option<Usage>) -> Cell {
    let Some(usage) = usage else { return label("–") };
    let megabytes = usage.peak_memory_bytes as f64 / 1e6;
    if usage.peak_memory_bytes <= usage.least_memory_bytes {
        label(format!("≤ {}", four_digits(megabytes)))
    } else {
        Cell::Number(megabytes)
    }
}

/// Orders and doubts of a program, a row per case with an answer.
pub fn orders_of(contest: &Contest, all: &[CaseRuns], entrant: usize) -> Table {
    let row = |case: &CaseRuns| {
        let answers = case.runs[entrant].iter().filter(|run| run.outcome.answered().is_some());
        let errors: Vec<(f64, crate::accuracy::Difference)> =
            answers.filter_map(|run| Some((run.spacing_m, case.error(run)?))).collect();
        if errors.is_empty() {
            return None;
        }
        let above: Vec<(f64, f64)> =
            errors.iter().filter(|(_, e)| e.rms > e.bar).map(|(h, e)| (*h, e.rms)).collect();
        let fit = log_log_fit(&above).filter(|fit| fit.standard_deviation.is_finite());
        let order = match fit {
            Some(fit) if fit.slope > SIGNIFICANT * fit.standard_deviation => {
                format!("{:.2} ± {:.2}", fit.slope, fit.standard_deviation)
            }
            Some(_) => "none: scatter".into(),
            None => "inconclusive: fewer than three errors above the error bar".into(),
        };
        let doubts = case.doubts(entrant).iter().map(ToString::to_string).collect::<Vec<_>>();
        Some(vec![
            label(&case.of.source.name),
            label(case.of.group.label()),
            Cell::Number(above.len() as f64),
            label(order),
            label(if doubts.is_empty() { "none".into() } else { doubts.join("; ") }),
        ])
    };
    Table {
        title: format!("{}: observed orders", printable(&contest.entrants[entrant].name)),
        columns: vec![
            text("case"),
            text("quantity"),
            text("errors above the error bar"),
            text("order in the spacing"),
            text("doubts"),
        ],
        rows: all.iter().filter_map(row).collect(),
    }
}
