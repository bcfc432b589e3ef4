//! Records as tables and figures.

use super::axis::{Axis, number_of};
use super::curves::curves;
use super::definition::{MeasuredCase, Sweep};
use super::subject::Subject;
use crate::lab::label::{knob_label, optional};
use crate::lab::store::{COMPRESSIONS, RunOutcome, RunRecord};
use mtled_checks::study::{Cell, Column, Figure, Plot, Study, Table, axis, number, text};

/// A figure of a record with its heading and unit.
type ShownFigure = (&'static str, &'static str, &'static str);

const CONSISTENCY: &[ShownFigure] = &[
    ("nodes", "nodes", "1"),
    ("points_per_node", "points per node", "1"),
    ("mean_support", "nodes per support", "1"),
    ("worst_condition", "worst condition", "1"),
    ("enlarged_supports", "enlarged supports", "1"),
    ("defect_of_plain_gradients", "|Σ w Grad φ − ∮ φ N| of plain gradients", "1"),
    ("defect_of_gradients", "of the gradients used", "1"),
    ("correction_iterations", "iterations", "1"),
];

const PATCH: &[ShownFigure] = &[
    ("nodes", "nodes", "1"),
    ("points_per_node", "points per node", "1"),
    ("patch_displacement_error", "largest error of the displacement", "1"),
    ("patch_gradient_error", "largest error of the gradient", "1"),
];

const STABILITY: &[ShownFigure] = &[
    ("nodes", "nodes", "1"),
    ("points_per_node", "points per node", "1"),
    ("smallest_jacobian", "smallest J", "1"),
    ("smallest_time_step_s", "smallest step", "s"),
    ("critical_time_step_s", "critical step at rest", "s"),
];

/// Heading of the column that [`ending`] fills.
pub(crate) const OUTCOME: &str = "outcome";

/// Adds the table of a case and its figure.
pub(crate) fn add_tables(study: &mut Study, sweep: &Sweep, case: &MeasuredCase) {
    let (shown, label, name) = match sweep.subject {
        Subject::TimeStep => return add_steps(study, sweep, case),
        Subject::Consistency => {
            (CONSISTENCY, "defect of the gradients used", "defect_of_gradients")
        }
        Subject::Patch => (PATCH, "error of the displacement", "patch_displacement_error"),
        Subject::Stability | Subject::Convergence => (STABILITY, "smallest J", "smallest_jacobian"),
    };
    let mut columns: Vec<Column> =
        shown.iter().map(|(_, heading, unit)| number(heading, unit)).collect();
    columns.push(text(OUTCOME));
    let cells = |record: &RunRecord| {
        let figures = shown.iter().map(|(name, ..)| optional(record.figure(name)));
        figures.chain([Cell::Text(ending(record))]).collect()
    };
    study.tables.push(table(sweep, case, sweep.subject.name(), columns, &cells));
    add_figure(study, sweep, case, label, &|record| record.figure(name));
}

/// A row for every record: its settings, then `cells`.
fn table(
    sweep: &Sweep,
    case: &MeasuredCase,
    title: &str,
    columns: Vec<Column>,
    cells: &dyn Fn(&RunRecord) -> Vec<Cell>,
) -> Table {
    let row = |record: &RunRecord| [sweep.setting_cells(record), cells(record)].concat();
    Table {
        title: format!("{}: {title}", case.source.name),
        columns: [sweep.setting_columns(), columns].concat(),
        rows: case.records.iter().map(row).collect(),
    }
}

/// Adds the three critical steps of every record, at rest and compressed.
fn add_steps(study: &mut Study, sweep: &Sweep, case: &MeasuredCase) {
    let mut columns = vec![
        number("nodes", "1"),
        number("per-point bound", "s"),
        number("largest stable step", "s"),
        number("bound over stable", "1"),
        number("Lanczos over stable", "1"),
        number("products", "1"),
    ];
    for compression in &COMPRESSIONS[1..] {
        let percent = 100.0 * compression;
        columns.push(number(&format!("stable at {percent} % compression, over that at rest"), "1"));
        columns.push(number(&format!("Lanczos over stable at {percent} %"), "1"));
    }
    columns.push(text(OUTCOME));
    let title = "critical steps by bound, Lanczos and trial";
    study.tables.push(table(sweep, case, title, columns, &step_cells));
    let label = "largest stable step over the per-point bound";
    add_figure(study, sweep, case, label, &|record| {
        Some(record.figure("largest_stable_step_s")? / record.figure("per_point_bound_s")?)
    });
    study.notes.push(
        "Compressed: the whole boundary is prescribed, the body is shortened along its last axis and \
         widened to the same volume; compared with the same body at rest."
            .into(),
    );
}

fn step_cells(record: &RunRecord) -> Vec<Cell> {
    let figure = |name: &str| record.figure(name);
    let compressed = |name: &str, compression: f64| {
        record.figure(&format!("{name}_held_at_{:.0}_percent_s", 100.0 * compression))
    };
    let ratio = |a: Option<f64>, b: Option<f64>| optional(a.zip(b).map(|(a, b)| a / b));
    let (bound, at_rest) = (figure("per_point_bound_s"), figure("largest_stable_step_s"));
    let mut cells = vec![
        optional(figure("nodes")),
        optional(bound),
        optional(at_rest),
        ratio(bound, at_rest),
        ratio(figure("lanczos_s"), at_rest),
        optional(figure("lanczos_products")),
    ];
    for &compression in &COMPRESSIONS[1..] {
        let stable = compressed("largest_stable_step", compression);
        cells.push(ratio(stable, compressed("largest_stable_step", 0.0)));
        cells.push(ratio(compressed("lanczos", compression), stable));
    }
    cells.push(Cell::Text(ending(record)));
    cells
}

/// CPU time and memory of every record: what may differ from one run to the next.
pub(crate) fn timings(sweep: &Sweep, case: &MeasuredCase) -> Table {
    let columns = vec![
        number("set-up", "CPU s"),
        number("solution", "CPU s"),
        number("per point and neighbour", "ns"),
        number("estimated memory", "MB"),
        text("processor"),
    ];
    table(sweep, case, "timings", columns, &|record| {
        vec![
            Cell::Number(record.timings.set_up_cpu_s),
            Cell::Number(record.timings.solve_cpu_s),
            optional(record.nanoseconds_per_visit()),
            optional(record.figure("estimated_memory_bytes").map(|bytes| bytes / 1e6)),
            Cell::Text(record.timings.processor.clone()),
        ]
    })
}

/// How a run ended: "ok", or its warnings or its error.
pub(crate) fn ending(record: &RunRecord) -> String {
    match &record.outcome {
        RunOutcome::Done { warnings, .. } if warnings.is_empty() => "ok".into(),
        RunOutcome::Done { warnings, .. } => format!("warned: {}", warnings.join("; ")),
        RunOutcome::Failed { reason, .. } => format!("failed: {reason}"),
    }
}

/// Adds a figure over the numeric axis with the most levels, with a curve for each
/// combination of the other settings.
fn add_figure(
    study: &mut Study,
    sweep: &Sweep,
    case: &MeasuredCase,
    label: &str,
    value: &dyn Fn(&RunRecord) -> Option<f64>,
) {
    let numeric = |axis: &&Axis| axis.levels.iter().all(|level| number_of(level).is_some());
    let along = sweep.axes.iter().filter(numeric).max_by_key(|axis| axis.levels.len());
    let Some(along) = along.filter(|axis| axis.levels.len() > 1) else { return };
    let curves = curves(case.records.iter().filter_map(|record| {
        let x = number_of(&record.setting(along.knob)?.level)?;
        Some((sweep.curve_name(case, record, along.knob), x, value(record)?))
    }));
    let all = || curves.iter().flat_map(|curve| &curve.points).flat_map(|point| &point.1);
    let log = all().all(|y| *y > 0.0)
        && all().copied().fold(0.0, f64::max) > 20.0 * all().copied().fold(f64::INFINITY, f64::min);
    let mut series: Vec<_> = curves.iter().map(|curve| curve.series()).collect();
    if sweep.clouds == 1 {
        series.iter_mut().for_each(|series| series.error_bars.clear());
    }
    study.figures.push(Figure::Plot(Plot {
        title: format!("{}: {label}", case.source.name),
        caption: match sweep.clouds {
            1 => "One cloud per combination.".into(),
            n => format!("Middle of the range over {n} clouds; bars reach to its ends."),
        },
        x: axis(&knob_label(along.knob), "1", false),
        y: axis(label, "1", log),
        series,
        slopes: Vec::new(),
    }));
}
