//! The race as tables, figures and checks.

use super::equal_error::{Cost, cost_at};
use super::finite_elements::{RIVALS, Rivals};
use super::{Challenge, Code, Field, Race, Run};
use mtled_checks::report::four_digits;
use mtled_checks::study::{
    Axis, Bound, Cell, Check, Column, Figure, Kind, Plot, Series, SeriesStyle, Study, Table,
};

/// Wanted of the block: error \[mm\], CPU seconds, and times less than each
/// finite-element code.
const AIMS: [(f64, f64); 2] = [(0.4, 0.3), (0.2, 1.5)];
const WANTED_RATIO: f64 = 5.0;

pub fn study(race: &Race, rivals: &Rivals, fields: &[Field]) -> Study {
    let mut study = Study {
        id: "race".into(),
        title: "Speed against error, side by side".into(),
        claim: "The same problems solved by mtled, FEniCSx and scikit-fem on this machine, one \
                thread each, in turn: what an error costs in processor time and in memory."
            .into(),
        command: "mtled study race".into(),
        ..Study::default()
    };
    if fields.iter().any(|field| field.challenge == Challenge::BondedBlock) {
        study.tables.push(aims(fields));
    }
    study.tables.push(equal_errors(fields));
    for field in fields {
        study.tables.push(runs_table(field));
        study.figures.push(figure(field, "CPU time", "s", |run| run.cpu_s));
        study.figures.push(figure(field, "peak memory", "MB", megabytes));
        study.checks.extend(checks(field));
    }
    study.notes = super::notes::notes(race, rivals, fields);
    study
}

fn megabytes(run: &Run) -> f64 {
    run.peak_memory_bytes as f64 / 1e6
}

/// Runs of a code by family, in the order of the ladders.
fn families(field: &Field, code: Code) -> Vec<(&str, Vec<&Run>)> {
    let mut found: Vec<(&str, Vec<&Run>)> = Vec::new();
    for run in field.runs.iter().filter(|run| run.code == code) {
        match found.iter_mut().find(|(name, _)| *name == run.family) {
            Some((_, runs)) => runs.push(run),
            None => found.push((&run.family, vec![run])),
        }
    }
    found
}

/// Whether the runs of a code are from another day.
fn stored(field: &Field, code: Code) -> bool {
    field.runs.iter().any(|run| run.code == code && run.stored)
}

fn title(field: &Field, code: Code) -> String {
    let mark = if stored(field, code) { " (stored)" } else { "" };
    format!("{}{mark}", code.title())
}

/// The cheapest family of a code at an error.
fn cheapest(field: &Field, code: Code, error: f64, cost: fn(&Run) -> f64) -> Option<(&str, Cost)> {
    let priced = families(field, code)
        .into_iter()
        .filter_map(|(name, runs)| Some((name, price(&runs, error, cost)?)));
    priced.min_by(|a, b| a.1.value.total_cmp(&b.1.value))
}

fn price(runs: &[&Run], error: f64, cost: fn(&Run) -> f64) -> Option<Cost> {
    let points: Vec<(f64, f64)> = runs.iter().map(|run| (run.error, cost(run))).collect();
    cost_at(&points, error)
}

fn column(name: &str, unit: &str) -> Column {
    Column { name: name.into(), unit: unit.into() }
}

fn text(text: impl Into<String>) -> Cell {
    Cell::Text(text.into())
}

fn cost_text(cost: Option<Cost>) -> Cell {
    match cost {
        None => text("not reached"),
        Some(Cost { value, at_most: true }) => text(format!("< {}", four_digits(value))),
        Some(Cost { value, .. }) => Cell::Number(value),
    }
}

/// What was wanted of the bonded block and what came of it.
fn aims(fields: &[Field]) -> Table {
    let block = |field: &&Field| field.challenge == Challenge::BondedBlock;
    let rows = fields.iter().filter(block).flat_map(|field| {
        AIMS.iter().flat_map(move |&(error, wanted)| aim_rows(field, error, wanted))
    });
    Table {
        title: "What was wanted of the bonded block".into(),
        columns: vec![
            column("quantity", ""),
            column("recipe or element", ""),
            column("measured", ""),
            column("wanted", ""),
            column("verdict", ""),
        ],
        rows: rows.collect(),
    }
}

fn aim_rows(field: &Field, error: f64, wanted: f64) -> Vec<Vec<Cell>> {
    let row = |quantity: String, family: &str, value: f64, wanted: String, met: bool| {
        let verdict = text(if met { "met" } else { "missed" });
        vec![text(quantity), text(family), Cell::Number(value), text(wanted), verdict]
    };
    let own = cheapest(field, Code::Mtled, error, |run| run.cpu_s);
    let (family, cost) = own.map_or(("not reached", f64::NAN), |(name, cost)| (name, cost.value));
    let quantity = format!("CPU s to {error} mm rms, set-up and solution");
    let mut rows = vec![row(quantity, family, cost, format!("≤ {wanted}"), cost <= wanted)];
    for code in RIVALS {
        if let Some((element, rival)) = cheapest(field, code, error, |run| run.cpu_s) {
            let (quantity, ratio) =
                (format!("{} over mtled at {error} mm", code.title()), rival.value / cost);
            let met = ratio >= WANTED_RATIO;
            let best =
                format!("its best, {element}{}", if stored(field, code) { ", stored" } else { "" });
            rows.push(row(quantity, &best, ratio, format!("≥ {WANTED_RATIO}"), met));
        }
    }
    rows
}

/// What each family costs at the same error, and over the cheapest of ours.
fn equal_errors(fields: &[Field]) -> Table {
    let rows = fields.iter().flat_map(|field| {
        field.challenge.levels().iter().flat_map(move |&error| rows_at(field, error))
    });
    Table {
        title: "Cost at equal error".into(),
        columns: vec![
            column("problem", ""),
            column("rms error", ""),
            column("code", ""),
            column("recipe or element", ""),
            column("CPU time", "s"),
            column("over the cheapest recipe of mtled", "1"),
            column("the same with the start of Python", "1"),
            column("peak memory", "MB"),
        ],
        rows: rows.collect(),
    }
}

fn rows_at(field: &Field, error: f64) -> Vec<Vec<Cell>> {
    let own = cheapest(field, Code::Mtled, error, |run| run.cpu_s);
    let ratio = |cost: Option<Cost>| match (cost, own) {
        (Some(cost), Some((_, own))) => Cell::Number(cost.value / own.value),
        _ => text("–"),
    };
    let mut rows = Vec::new();
    for code in [Code::Mtled, Code::Fenicsx, Code::ScikitFem] {
        for (name, runs) in families(field, code) {
            let cpu = price(&runs, error, |run| run.cpu_s);
            rows.push(vec![
                text(field.challenge.title()),
                text(format!("{} {}", four_digits(error), field.challenge.unit())),
                text(title(field, code)),
                text(name),
                cost_text(cpu),
                ratio(cpu),
                ratio(price(&runs, error, Run::with_start)),
                cost_text(price(&runs, error, megabytes)),
            ]);
        }
    }
    rows
}

fn runs_table(field: &Field) -> Table {
    let number = |value: Option<f64>| value.map_or(text("–"), Cell::Number);
    let row = |run: &Run| {
        vec![
            text(title(field, run.code)),
            text(&run.family),
            Cell::Number(run.per_edge as f64),
            Cell::Number(run.unknowns as f64),
            Cell::Number(run.error),
            Cell::Number(run.cpu_s),
            number(run.set_up_cpu_s),
            number(run.start_cpu_s),
            number(run.compile_cpu_s),
            Cell::Number(run.wall_s),
            Cell::Number(megabytes(run)),
            Cell::Number(run.steps as f64),
            number(run.internal_forces.map(|n| n as f64)),
            number(run.neighbour_visits.map(|n| n as f64)),
        ]
    };
    Table {
        title: format!("Runs: {}", field.challenge.title()),
        columns: vec![
            column("code", ""),
            column("recipe or element", ""),
            column("per edge", ""),
            column("unknowns", ""),
            column("rms error", field.challenge.unit()),
            column("CPU time", "s"),
            column("of that set-up", "s"),
            column("start", "s"),
            column("compilation", "s"),
            column("wall time", "s"),
            column("peak memory", "MB"),
            column("steps or corrections", ""),
            column("internal forces", ""),
            column("neighbour visits", ""),
        ],
        rows: field.runs.iter().map(row).collect(),
    }
}

/// Families of a code that a figure shows, which can tell eight curves apart: the
/// first of its ladders and those with the smallest products of error and cost.
fn drawn(field: &Field, code: Code, cost: fn(&Run) -> f64) -> Vec<(&str, Vec<&Run>)> {
    let room = if code == Code::ScikitFem { 2 } else { 3 };
    let mut all = families(field, code);
    let product =
        |runs: &[&Run]| runs.iter().map(|run| run.error * cost(run)).fold(f64::INFINITY, f64::min);
    let others = all.get_mut(1..).unwrap_or_default();
    others.sort_by(|a, b| product(&a.1).total_cmp(&product(&b.1)));
    all.truncate(room);
    all
}

/// Error against a cost, a curve per family.
fn figure(field: &Field, label: &str, unit: &str, cost: fn(&Run) -> f64) -> Figure {
    let mut series = Vec::new();
    for code in [Code::Mtled, Code::Fenicsx, Code::ScikitFem] {
        for (name, runs) in drawn(field, code, cost) {
            series.push(Series {
                name: format!("{} {name}", title(field, code)),
                points: runs.iter().map(|run| (cost(run), run.error)).collect(),
                error_bars: Vec::new(),
                style: SeriesStyle::LineAndPoints,
            });
        }
    }
    let known = match field.uncertainty > 0.0 {
        true => format!(
            "Errors below the error bar of the reference, {} {}, say nothing.",
            four_digits(field.uncertainty),
            field.challenge.unit()
        ),
        false => "The solution is known exactly.".to_string(),
    };
    Figure::Plot(Plot {
        title: format!("{}: error against {label}", field.challenge.title()),
        caption: format!(
            "rms error of the displacement on a lattice over {label}, one thread; left and below is \
             better. Of each code the first family and the best ones; all are in the table. {known}"
        ),
        x: Axis { label: label.into(), unit: unit.into(), log: true },
        y: Axis { label: "rms error".into(), unit: field.challenge.unit().into(), log: true },
        series,
        slopes: Vec::new(),
    })
}

/// What does not depend on the machine: the error of a recipe and its work.
fn checks(field: &Field) -> Vec<Check> {
    let name = field.challenge.name();
    let (error, visits) = field.challenge.earlier();
    let newton = |run: &&Run| run.family == "Newton to 1e-2" && run.per_edge == 8;
    let Some(run) = field.runs.iter().find(newton) else { return Vec::new() };
    let visited = run.neighbour_visits.map_or(f64::NAN, |visits| visits as f64);
    let title = field.challenge.title();
    let check = |what: &str, words: &str, value: f64, earlier: f64, margin: f64, unit: &str| {
        Check::new(
            &format!("race/{name}/{what}"),
            &format!("{title}: {words}, Newton's method with 8 spacings per edge"),
            Kind::Regression,
            value,
            Bound::AtMost((1.0 + margin) * earlier),
            unit,
            &format!("our own earlier figure, {}, and {margin} of it", four_digits(earlier)),
        )
    };
    vec![
        check("error", "rms error", run.error, error, 0.1, field.challenge.unit()),
        // A correction more or less is no fault.
        check("work", "neighbour visits of the solution", visited, visits, 0.25, "1"),
    ]
}
