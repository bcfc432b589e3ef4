//! Records as a tidy table: one row for each run and number that it gave.

use super::csv;
use crate::lab::store::{RunOutcome, RunRecord, Stage};
use anyhow::Result;
use mtled_case::reference::Quantity;
use mtled_case::scene::{Knob, Level, Levels};
use mtled_run::run::Work;

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

type Column<'a> = csv::Column<Row<'a>>;

/// The table of records as CSV, and the number of its rows. Settings that a run leaves as they
/// are in its case are empty.
pub fn runs_table(records: &[RunRecord]) -> Result<(Vec<u8>, usize)> {
    let rows: Vec<Row> = records.iter().flat_map(rows).collect();
    let mut columns = about_the_run();
    columns.extend(Knob::ALL.iter().copied().map(setting));
    columns.extend(sizes());
    columns.extend(about_the_number());
    columns.extend(effort());
    Ok((csv::to_csv(&columns, &rows)?, rows.len()))
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
    if numbers.is_empty() {
        return vec![Row { record, number: None }];
    }
    numbers.into_iter().map(|number| Row { record, number: Some(number) }).collect()
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
        time_s: record.times_s.get(index / width).copied().filter(|_| quantity.changes),
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

/// Which run it is and how it ended.
fn about_the_run<'a>() -> Vec<Column<'a>> {
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
        Column::text("key", |row| Some(row.record.key.clone())),
        Column::text("run", |row| Some(row.record.job.name().into())),
        Column::text("case_name", |row| Some(row.record.case.clone())),
        Column::text("overrides", overrides),
        Column::text("outcome", move |row| Some(outcome(row).into())),
        Column::text("reason", |row| row.record.failure().map(String::from)),
        Column::text("warnings", warnings),
    ]
}

/// The column of a knob, of the kind of its levels.
fn setting<'a>(knob: Knob) -> Column<'a> {
    let level = move |row: &Row| row.record.setting(knob).map(|setting| setting.level.clone());
    match knob.levels() {
        // In metres it is a size.
        _ if knob == Knob::Spacing => {
            Column::number("spacing_factor", move |row| match level(row)? {
                Level::Word(factor) => factor.strip_prefix('x')?.parse().ok(),
                Level::Number(_) => None,
            })
        }
        Levels::Word(_) => Column::text(knob.name(), move |row| Some(level(row)?.to_string())),
        Levels::Count => {
            Column::count(knob.name(), move |row| Some(as_number(&level(row)?)? as i64))
        }
        Levels::Number => Column::number(knob.name(), move |row| as_number(&level(row)?)),
    }
}

fn as_number(level: &Level) -> Option<f64> {
    match level {
        Level::Number(number) => Some(*number),
        Level::Word(_) => None,
    }
}

/// How fine the discretisation is; the spacing of a run that failed where it was set.
fn sizes<'a>() -> Vec<Column<'a>> {
    let spacing = |row: &Row| {
        let set = || as_number(&row.record.setting(Knob::Spacing)?.level);
        row.record.figure("spacing_m").or_else(set)
    };
    vec![
        Column::number("spacing_m", spacing),
        Column::count("nodes", |row| row.record.figure("nodes").map(|nodes| nodes as i64)),
        Column::count("points", |row| row.record.figure("points").map(|points| points as i64)),
    ]
}

fn about_the_number<'a>() -> Vec<Column<'a>> {
    vec![
        Column::text("quantity", |row| Some(row.number.as_ref()?.quantity.into())),
        Column::count("position", |row| Some(row.number.as_ref()?.position? as i64)),
        Column::text("component", |row| row.number.as_ref()?.component.map(String::from)),
        Column::number("time_s", |row| row.number.as_ref()?.time_s),
        Column::number("value", |row| row.number.as_ref().map(|number| number.value)),
        Column::text("unit", |row| Some(row.number.as_ref()?.unit.into())),
    ]
}

/// The name of a count of work and where it is.
type Counter = (&'static str, fn(&Work) -> usize);

/// What the run took, where, when and by which program.
fn effort<'a>() -> Vec<Column<'a>> {
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
        Column::number("set_up_cpu_s", |row| Some(row.record.timings.set_up_cpu_s)),
        Column::number("solve_cpu_s", |row| Some(row.record.timings.solve_cpu_s)),
    ];
    columns.extend(
        counters
            .map(|(name, of)| Column::count(name, move |row| Some(of(row.record.work()?) as i64))),
    );
    columns.extend([
        Column::text("processor", |row| Some(row.record.timings.processor.clone())),
        Column::text("date", |row| Some(row.record.timings.date.clone())),
        Column::text("version", |row| Some(row.record.solver.clone())),
    ]);
    columns
}
