//! Records as a tidy table: one row for each run and number that it gave.

use super::table::{Cells, Column, Table};
use crate::explore::store::{RunOutcome, RunRecord, Stage};
use crate::reference::Quantity;
use crate::run::Work;
use crate::scene::{Knob, Level, Levels};

/// Figures that have a column of their own, since others depend on them.
const SIZES: [&str; 3] = ["spacing_m", "nodes", "points"];

const AXES: [&str; 3] = ["x", "y", "z"];

/// One number of a run; a run without numbers has a row with none.
struct Row<'a> {
    record: &'a RunRecord,
    number: Option<Number<'a>>,
}

/// A number and what it is.
struct Number<'a> {
    quantity: &'a str,
    unit: &'static str,
    value: f64,
    /// Of a probe with several positions.
    position: Option<usize>,
    component: Option<&'static str>,
    time_s: Option<f64>,
}

/// The table of records. Settings that a run leaves as they are in its case are empty.
pub fn runs_table(records: &[RunRecord]) -> Table {
    let rows: Vec<Row> = records.iter().flat_map(rows).collect();
    let mut columns = about_the_run(&rows);
    columns.extend(settings(&rows));
    columns.extend(sizes(&rows));
    columns.extend(about_the_number(&rows));
    columns.extend(effort(&rows));
    Table { columns, rows: rows.len() }
}

/// Whether a record does not say what its values are, as those of earlier versions; they are
/// left out of the table.
pub fn quantities_are_missing(record: &RunRecord) -> bool {
    match &record.outcome {
        RunOutcome::Done { quantities, values, .. } => quantities.len() != values.len(),
        RunOutcome::Failed { .. } => false,
    }
}

fn rows(record: &RunRecord) -> Vec<Row<'_>> {
    let numbers = numbers(record);
    match numbers.is_empty() {
        true => vec![Row { record, number: None }],
        false => numbers.into_iter().map(|number| Row { record, number: Some(number) }).collect(),
    }
}

fn numbers(record: &RunRecord) -> Vec<Number<'_>> {
    let RunOutcome::Done { figures, quantities, values, .. } = &record.outcome else {
        return Vec::new();
    };
    let others = figures.iter().filter(|(name, _)| !SIZES.contains(&name.as_str()));
    let mut all: Vec<Number> = others
        .map(|(name, value)| {
            let (unit, value) = (unit_of_figure(name), *value);
            Number { quantity: name, unit, value, position: None, component: None, time_s: None }
        })
        .collect();
    if !quantities_are_missing(record) {
        let series = quantities.iter().zip(values);
        all.extend(series.flat_map(|(quantity, values)| series_of(record, quantity, values)));
    }
    all
}

/// The numbers of a quantity, instant by instant and position by position.
fn series_of<'a>(
    record: &'a RunRecord,
    quantity: &'a Quantity,
    values: &'a [f64],
) -> impl Iterator<Item = Number<'a>> {
    let (components, width) = (quantity.family.components(), quantity.width.max(1));
    values.iter().enumerate().map(move |(index, value)| Number {
        quantity: &quantity.name,
        unit: quantity.family.unit(),
        value: *value,
        position: (width > components).then_some(index % width / components),
        component: (components > 1).then(|| AXES[index % components]),
        time_s: match quantity.changes {
            true => record.times_s.get(index / width).copied(),
            false => None,
        },
    })
}

/// The name of a figure ends with its unit.
fn unit_of_figure(name: &str) -> &'static str {
    match name {
        _ if name.ends_with("_s") => "s",
        _ if name.ends_with("_m") => "m",
        _ if name.contains("bytes") => "B",
        _ => "1",
    }
}

fn text(name: &'static str, rows: &[Row], cell: impl Fn(&Row) -> Option<String>) -> Column {
    Column { name, cells: Cells::Text(rows.iter().map(cell).collect()) }
}

fn count(name: &'static str, rows: &[Row], cell: impl Fn(&Row) -> Option<i64>) -> Column {
    Column { name, cells: Cells::Count(rows.iter().map(cell).collect()) }
}

fn number(name: &'static str, rows: &[Row], cell: impl Fn(&Row) -> Option<f64>) -> Column {
    Column { name, cells: Cells::Number(rows.iter().map(cell).collect()) }
}

/// Which run it is and how it ended.
fn about_the_run(rows: &[Row]) -> Vec<Column> {
    let outcome = |row: &Row| match &row.record.outcome {
        RunOutcome::Done { .. } => "done",
        RunOutcome::Failed { stage: Stage::Refused, .. } => "refused",
        RunOutcome::Failed { stage: Stage::Running, .. } => "failed",
    };
    let overrides = |row: &Row| {
        let all: Vec<String> = row.record.overrides.iter().map(ToString::to_string).collect();
        (!all.is_empty()).then(|| all.join("; "))
    };
    let warnings = |row: &Row| match &row.record.outcome {
        RunOutcome::Done { warnings, .. } if !warnings.is_empty() => Some(warnings.join("; ")),
        _ => None,
    };
    vec![
        text("key", rows, |row| Some(row.record.key.clone())),
        text("run", rows, |row| Some(row.record.job.name().into())),
        text("case_name", rows, |row| Some(row.record.case.clone())),
        text("overrides", rows, overrides),
        text("outcome", rows, |row| Some(outcome(row).into())),
        text("reason", rows, |row| row.record.failure().map(String::from)),
        text("warnings", rows, warnings),
    ]
}

/// A column for every knob, of the kind of its levels.
fn settings(rows: &[Row]) -> Vec<Column> {
    let column = |&knob: &Knob| {
        let level = |row: &Row| row.record.setting(knob).map(|setting| setting.level.clone());
        match knob.levels() {
            // In metres it is a size.
            _ if knob == Knob::Spacing => number("spacing_factor", rows, |row| match level(row)? {
                Level::Word(factor) => factor.strip_prefix('x')?.parse().ok(),
                Level::Number(_) => None,
            }),
            Levels::Word(_) => text(knob.name(), rows, |row| Some(level(row)?.to_string())),
            Levels::Count => count(knob.name(), rows, |row| Some(as_number(&level(row)?)? as i64)),
            Levels::Number => number(knob.name(), rows, |row| as_number(&level(row)?)),
        }
    };
    Knob::ALL.iter().map(column).collect()
}

fn as_number(level: &Level) -> Option<f64> {
    match level {
        Level::Number(number) => Some(*number),
        Level::Word(_) => None,
    }
}

/// How fine the discretisation is; the spacing of a run that failed where it was set.
fn sizes(rows: &[Row]) -> Vec<Column> {
    let spacing = |row: &Row| {
        let set = || as_number(&row.record.setting(Knob::Spacing)?.level);
        row.record.figure("spacing_m").or_else(set)
    };
    vec![
        number("spacing_m", rows, spacing),
        count("nodes", rows, |row| row.record.figure("nodes").map(|nodes| nodes as i64)),
        count("points", rows, |row| row.record.figure("points").map(|points| points as i64)),
    ]
}

fn about_the_number(rows: &[Row]) -> Vec<Column> {
    let is = |row: &Row, field: fn(&Number) -> Option<String>| row.number.as_ref().and_then(field);
    vec![
        text("quantity", rows, |row| is(row, |number| Some(number.quantity.into()))),
        count("position", rows, |row| Some(row.number.as_ref()?.position? as i64)),
        text("component", rows, |row| is(row, |number| number.component.map(String::from))),
        number("time_s", rows, |row| row.number.as_ref()?.time_s),
        number("value", rows, |row| row.number.as_ref().map(|number| number.value)),
        text("unit", rows, |row| is(row, |number| Some(number.unit.into()))),
    ]
}

/// The name of a count of work and where it is.
type Counter = (&'static str, fn(&Work) -> usize);

/// What the run took, where, when and by which program.
fn effort(rows: &[Row]) -> Vec<Column> {
    let counters: [Counter; 7] = [
        ("steps", |work| work.steps),
        ("force_evaluations", |work| work.force_evaluations),
        ("lanczos_evaluations", |work| work.lanczos_evaluations),
        ("correction_iterations", |work| work.correction_iterations),
        ("point_evaluations", |work| work.point_evaluations),
        ("neighbour_visits", |work| work.neighbour_visits),
        ("bytes_streamed", |work| work.bytes_streamed),
    ];
    let mut columns = vec![
        number("set_up_cpu_s", rows, |row| Some(row.record.timings.set_up_cpu_s)),
        number("solve_cpu_s", rows, |row| Some(row.record.timings.solve_cpu_s)),
    ];
    columns.extend(
        counters
            .map(|(name, of)| count(name, rows, move |row| Some(of(row.record.work()?) as i64))),
    );
    columns.extend([
        text("processor", rows, |row| Some(row.record.timings.processor.clone())),
        text("date", rows, |row| Some(row.record.timings.date.clone())),
        text("version", rows, |row| Some(row.record.solver.clone())),
    ]);
    columns
}
