//! Runs as tables.

use super::doubt::false_claim;
use super::judged::CaseRuns;
use super::outcome::SolverRun;
use super::process::Usage;
use crate::lab::label::optional;
use mtled_checks::escape::printable;
use mtled_checks::measure::log_log_fit;
use mtled_checks::report::four_digits;
use mtled_checks::study::{Cell, Table, number, text};
use mtled_run::accuracy::Group;

/// A fitted order is reported only above this many times its standard deviation.
const SIGNIFICANT: f64 = 2.0;

/// A cell of text.
pub(crate) fn label(text: impl Into<String>) -> Cell {
    Cell::Text(text.into())
}

/// All runs of a program.
pub(crate) fn runs_of(name: &str, cases: &[CaseRuns], solver: usize) -> Table {
    let rows = cases.iter().flat_map(|case| {
        case.runs[solver].iter().map(move |run| run_row(label(&case.of.id), case, run))
    });
    runs_table(format!("{}: all runs", printable(name)), "problem", rows.collect())
}

/// All runs of a problem by programs with these names.
pub(crate) fn runs_on(case: &CaseRuns, names: &[String]) -> Table {
    let rows = case.runs.iter().zip(names).flat_map(|(runs, name)| {
        runs.iter().map(move |run| run_row(label(printable(name)), case, run))
    });
    runs_table("All runs".into(), "solver", rows.collect())
}

fn runs_table(title: String, first: &str, rows: Vec<Vec<Cell>>) -> Table {
    Table {
        title,
        columns: vec![
            text(first),
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
        rows,
    }
}

fn run_row(first: Cell, case: &CaseRuns, run: &SolverRun) -> Vec<Cell> {
    let answered = run.outcome.answered();
    let error = case.error(run);
    let of = |group: Group| answered.and_then(|answered| case.of.error(group, answered));
    let usage = run.usage;
    let outcome = match false_claim(run) {
        Some(claim) => format!("{}; {claim}", run.outcome.label()),
        None => run.outcome.label(),
    };
    vec![
        first,
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
pub(crate) fn memory_cell(usage: Option<Usage>) -> Cell {
    let Some(usage) = usage else { return label("–") };
    let megabytes = usage.peak_memory_bytes as f64 / 1e6;
    if usage.peak_memory_bytes <= usage.least_memory_bytes {
        label(format!("≤ {}", four_digits(megabytes)))
    } else {
        Cell::Number(megabytes)
    }
}

/// Orders and doubts of a program, a row per case with an answer.
pub(crate) fn orders_of(name: &str, cases: &[CaseRuns], solver: usize) -> Table {
    let row = |case: &CaseRuns| {
        let answers = case.runs[solver].iter().filter(|run| run.outcome.answered().is_some());
        let errors: Vec<(f64, mtled_run::accuracy::Difference)> =
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
        let doubts = case.doubts[solver].iter().map(ToString::to_string).collect::<Vec<_>>();
        Some(vec![
            label(&case.of.id),
            label(case.of.group.label()),
            Cell::Number(above.len() as f64),
            label(order),
            label(if doubts.is_empty() { "none".into() } else { doubts.join("; ") }),
        ])
    };
    Table {
        title: format!("{}: observed orders", printable(name)),
        columns: vec![
            text("problem"),
            text("quantity"),
            text("errors above the error bar"),
            text("order in the spacing"),
            text("doubts"),
        ],
        rows: cases.iter().filter_map(row).collect(),
    }
}
