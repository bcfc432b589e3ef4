//! The race as tables.

use super::challenge::Challenge;
use super::field::{Field, cost_of, megabytes};
use super::race_run::{CODES, Code, FINITE_ELEMENT_CODES, RaceRun};
use crate::accuracy::Cost;
use mtled_checks::report::four_digits;
use mtled_checks::study::{Cell, Table, number, text};

/// Targets of the bonded block: error \[mm\] and CPU time \[s\].
const TARGETS: [(f64, f64); 2] = [(0.4, 0.3), (0.2, 1.5)];
/// Target CPU time of each finite-element code over that of the solver \[–\].
const TARGET_RATIO: f64 = 5.0;

fn label(text: impl Into<String>) -> Cell {
    Cell::Text(text.into())
}

fn optional(value: Option<f64>) -> Cell {
    value.map_or(label("–"), Cell::Number)
}

fn cost_cell(cost: Option<Cost>) -> Cell {
    match cost {
        None => label("not reached"),
        Some(Cost { value, at_most: true }) => label(format!("< {}", four_digits(value))),
        Some(Cost { value, .. }) => Cell::Number(value),
    }
}

/// The targets of the bonded block and whether they are met.
pub fn targets(fields: &[Field]) -> Table {
    let block = |field: &&Field| field.challenge == Challenge::BondedBlock;
    let rows = fields.iter().filter(block).flat_map(|field| {
        TARGETS.iter().flat_map(move |&(error, cpu_s)| target_rows(field, error, cpu_s))
    });
    let columns = ["quantity", "recipe or element", "measured", "target", "verdict"];
    Table {
        title: "Targets for the bonded block".into(),
        columns: columns.iter().map(|name| text(name)).collect(),
        rows: rows.collect(),
    }
}

fn target_rows(field: &Field, error: f64, cpu_s: f64) -> Vec<Vec<Cell>> {
    let row = |quantity: String, family: &str, value: f64, target: String, met: bool| {
        let verdict = label(if met { "met" } else { "missed" });
        vec![label(quantity), label(family), Cell::Number(value), label(target), verdict]
    };
    let own = field.cheapest(Code::Mtled, error);
    let (family, cost) = own.map_or(("not reached", f64::NAN), |(name, cost)| (name, cost.value));
    let quantity = format!("CPU s to {error} mm rms, set-up and solution");
    let mut rows = vec![row(quantity, family, cost, format!("≤ {cpu_s}"), cost <= cpu_s)];
    for code in FINITE_ELEMENT_CODES {
        if let Some((element, other)) = field.cheapest(code, error) {
            let quantity = format!("{} over mtled at {error} mm", code.title());
            let ratio = other.value / cost;
            let stored = if field.stored(code) { ", stored" } else { "" };
            let best = format!("its best, {element}{stored}");
            let target = format!("≥ {TARGET_RATIO}");
            rows.push(row(quantity, &best, ratio, target, ratio >= TARGET_RATIO));
        }
    }
    rows
}

/// Cost of each family at the same error, and over that of the cheapest recipe of `mtled`.
pub fn equal_errors(fields: &[Field]) -> Table {
    let rows = fields.iter().flat_map(|field| {
        field.challenge.levels().iter().flat_map(move |&error| rows_at(field, error))
    });
    Table {
        title: "Cost at equal error".into(),
        columns: vec![
            text("problem"),
            text("rms error"),
            text("code"),
            text("recipe or element"),
            number("CPU time", "s"),
            number("over the cheapest recipe of mtled", "1"),
            number("the same with the start of Python", "1"),
            number("peak memory", "MB"),
        ],
        rows: rows.collect(),
    }
}

fn rows_at(field: &Field, error: f64) -> Vec<Vec<Cell>> {
    let own = field.cheapest(Code::Mtled, error);
    let ratio =
        |cost: Option<Cost>| optional(cost.zip(own).map(|(cost, (_, own))| cost.value / own.value));
    let mut rows = Vec::new();
    for code in CODES {
        for (name, runs) in field.families(code) {
            let cpu = cost_of(&runs, error, |run| run.cpu_s);
            rows.push(vec![
                label(field.challenge.title()),
                label(format!("{} {}", four_digits(error), field.challenge.unit())),
                label(field.title(code)),
                label(name),
                cost_cell(cpu),
                ratio(cpu),
                ratio(cost_of(&runs, error, RaceRun::with_start)),
                cost_cell(cost_of(&runs, error, megabytes)),
            ]);
        }
    }
    rows
}

/// All runs of a challenge.
pub fn runs_table(field: &Field) -> Table {
    let row = |run: &RaceRun| {
        vec![
            label(field.title(run.code)),
            label(&run.family),
            Cell::Number(run.per_edge as f64),
            Cell::Number(run.unknowns as f64),
            Cell::Number(run.error),
            Cell::Number(run.cpu_s),
            optional(run.set_up_cpu_s),
            optional(run.start_cpu_s),
            optional(run.compile_cpu_s),
            Cell::Number(run.wall_s),
            Cell::Number(megabytes(run)),
            Cell::Number(run.steps as f64),
            optional(run.internal_forces.map(|n| n as f64)),
            optional(run.neighbour_visits.map(|n| n as f64)),
        ]
    };
    Table {
        title: format!("Runs: {}", field.challenge.title()),
        columns: vec![
            text("code"),
            text("recipe or element"),
            text("per edge"),
            text("unknowns"),
            number("rms error", field.challenge.unit()),
            number("CPU time", "s"),
            number("of that set-up", "s"),
            number("start", "s"),
            number("compilation", "s"),
            number("wall time", "s"),
            number("peak memory", "MB"),
            text("steps or iterations"),
            text("internal forces"),
            text("neighbour visits"),
        ],
        rows: field.runs.iter().map(row).collect(),
    }
}
