//! Records as tables and figures.

use super::{Measured, Subject, Sweep, number_of};
use crate::explore::store::{COMPRESSIONS, Outcome, Record};
use crate::scene::{Knob, Level};
use mtled_checks::study::shorthand::{axis, curve, number, text};
use mtled_checks::study::{Cell, Column, Figure, Plot, Study, Table};

/// A figure of a record with its heading and unit.
type Shown = (&'static str, &'static str, &'static str);

const CONSISTENCY: &[Shown] = &[
    ("nodes", "nodes", "1"),
    ("points_per_node", "points per node", "1"),
    ("mean_support", "nodes per support", "1"),
    ("worst_condition", "worst condition", "1"),
    ("enlarged_supports", "enlarged supports", "1"),
    ("defect_of_plain_gradients", "|Σ w Grad φ − ∮ φ N| of plain gradients", "1"),
    ("defect_of_gradients", "of the gradients used", "1"),
    ("correction_iterations", "iterations", "1"),
];

const PATCH: &[Shown] = &[
    ("nodes", "nodes", "1"),
    ("points_per_node", "points per node", "1"),
    ("patch_displacement_error", "largest error of the displacement", "1"),
    ("patch_gradient_error", "largest error of the gradient", "1"),
];

const STABILITY: &[Shown] = &[
    ("nodes", "nodes", "1"),
    ("points_per_node", "points per node", "1"),
    ("smallest_jacobian", "smallest J", "1"),
    ("smallest_time_step_s", "smallest step", "s"),
    ("critical_time_step_s", "critical step at rest", "s"),
];

/// The table of a case and its figure.
pub fn add(study: &mut Study, sweep: &Sweep, case: &Measured) {
    let shown = match sweep.subject {
        Subject::TimeStep => {
            study.tables.push(steps(sweep, case));
            add_figure(
                study,
                sweep,
                case,
                "largest stable step over the per-point bound",
                &|record| {
                    ratio(
                        record.figure("largest_stable_step_s"),
                        record.figure("per_point_bound_s"),
                    )
                },
            );
            study.notes.push(
                "Compressed: the body held on its whole boundary, shortened along its last axis and \
                 widened to the same volume, against the same at rest."
                    .into(),
            );
            return;
        }
        Subject::Consistency => CONSISTENCY,
        Subject::Patch => PATCH,
        Subject::Stability | Subject::Convergence => STABILITY,
    };
    let mut columns = setting_columns(sweep);
    columns.extend(shown.iter().map(|(_, heading, unit)| number(heading, unit)));
    columns.push(text("what came of it"));
    let row = |record: &Record| {
        let mut cells = setting_cells(sweep, record);
        cells.extend(shown.iter().map(|(name, ..)| optional(record.figure(name))));
        cells.push(Cell::Text(ending(record)));
        cells
    };
    study.tables.push(Table {
        title: format!("{}: {}", case.source.name, sweep.subject.name()),
        columns,
        rows: case.records.iter().map(row).collect(),
    });
    match sweep.subject {
        Subject::Consistency => {
            add_figure(study, sweep, case, "defect of the gradients used", &|record| {
                record.figure("defect_of_gradients")
            });
        }
        Subject::Patch => {
            add_figure(study, sweep, case, "error of the displacement", &|record| {
                record.figure("patch_displacement_error")
            });
        }
        _ => add_figure(study, sweep, case, "smallest J", &|record| {
            record.figure("smallest_jacobian")
        }),
    }
}

/// The three steps of every record at rest and compressed.
fn steps(sweep: &Sweep, case: &Measured) -> Table {
    let mut columns = setting_columns(sweep);
    columns.extend([
        number("nodes", "1"),
        number("per-point bound", "s"),
        number("largest stable step", "s"),
        number("bound over stable", "1"),
        number("Lanczos over stable", "1"),
        number("products", "1"),
    ]);
    for compression in &COMPRESSIONS[1..] {
        let percent = 100.0 * compression;
        columns.push(number(&format!("stable at {percent} % compression, over that at rest"), "1"));
        columns.push(number(&format!("Lanczos over stable at {percent} %"), "1"));
    }
    columns.push(text("what came of it"));
    let row = |record: &Record| {
        let mut cells = setting_cells(sweep, record);
        let at_rest = record.figure("largest_stable_step_s");
        let bound = record.figure("per_point_bound_s");
        cells.push(optional(record.figure("nodes")));
        cells.push(optional(bound));
        cells.push(optional(at_rest));
        cells.push(optional(ratio(bound, at_rest)));
        cells.push(optional(ratio(record.figure("lanczos_s"), at_rest)));
        cells.push(optional(record.figure("lanczos_products")));
        for &compression in &COMPRESSIONS[1..] {
            let compressed = stable(record, compression);
            cells.push(optional(ratio(compressed, stable(record, 0.0))));
            cells.push(optional(ratio(lanczos(record, compression), compressed)));
        }
        cells.push(Cell::Text(ending(record)));
        cells
    };
    Table {
        title: format!("{}: critical steps by bound, Lanczos and trial", case.source.name),
        columns,
        rows: case.records.iter().map(row).collect(),
    }
}

fn stable(record: &Record, compression: f64) -> Option<f64> {
    record.figure(&format!("largest_stable_step_held_at_{:.0}_percent_s", 100.0 * compression))
}

fn lanczos(record: &Record, compression: f64) -> Option<f64> {
    record.figure(&format!("lanczos_held_at_{:.0}_percent_s", 100.0 * compression))
}

fn ratio(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    Some(a? / b?)
}

/// CPU time and memory of every record: what may differ from one run to the next.
pub fn timings(sweep: &Sweep, case: &Measured) -> Table {
    let mut columns = setting_columns(sweep);
    columns.extend([
        number("set-up", "CPU s"),
        number("march", "CPU s"),
        number("per point and neighbour", "ns"),
        number("estimated memory", "MB"),
        text("processor"),
    ]);
    let row = |record: &Record| {
        let mut cells = setting_cells(sweep, record);
        let visits = record.work().map(|work| work.neighbour_visits as f64);
        cells.push(Cell::Number(record.timings.set_up_cpu_s));
        cells.push(Cell::Number(record.timings.march_cpu_s));
        cells.push(optional(visits.map(|visits| 1e9 * record.timings.march_cpu_s / visits)));
        cells.push(optional(record.figure("estimated_memory_bytes").map(|bytes| bytes / 1e6)));
        cells.push(Cell::Text(record.timings.processor.clone()));
        cells
    };
    Table {
        title: format!("{}: timings", case.source.name),
        columns,
        rows: case.records.iter().map(row).collect(),
    }
}

pub fn setting_columns(sweep: &Sweep) -> Vec<Column> {
    let name = |knob: Knob| text(&knob.name().replace('_', " "));
    let mut columns: Vec<Column> = sweep.axes.iter().map(|axis| name(axis.knob)).collect();
    if sweep.clouds > 1 {
        columns.push(name(Knob::Cloud));
    }
    columns
}

pub fn setting_cells(sweep: &Sweep, record: &Record) -> Vec<Cell> {
    let cell = |knob: Knob| match record.settings.iter().find(|setting| setting.knob == knob) {
        Some(setting) => match &setting.level {
            Level::Number(number) => Cell::Number(*number),
            Level::Word(word) => Cell::Text(word.clone()),
        },
        None if knob == Knob::Cloud => Cell::Number(0.0),
        None => Cell::Text("as in the case".into()),
    };
    let mut cells: Vec<Cell> = sweep.axes.iter().map(|axis| cell(axis.knob)).collect();
    if sweep.clouds > 1 {
        cells.push(cell(Knob::Cloud));
    }
    cells
}

pub fn optional(value: Option<f64>) -> Cell {
    value.map_or(Cell::Text("–".into()), Cell::Number)
}

/// How a run ended, in words.
pub fn ending(record: &Record) -> String {
    match &record.outcome {
        Outcome::Done { warnings, .. } if warnings.is_empty() => "sound".into(),
        Outcome::Done { warnings, .. } => format!("warned: {}", warnings.join("; ")),
        Outcome::Failed { reason, .. } => format!("failed: {reason}"),
    }
}

/// A name, and at each level the values of all clouds.
type Curve = (String, Vec<(f64, Vec<f64>)>);

/// A figure over the levels of the axis with the most numbers, a curve for each
/// combination of the others; the median of the clouds with their range as bars.
fn add_figure(
    study: &mut Study,
    sweep: &Sweep,
    case: &Measured,
    what: &str,
    value: &dyn Fn(&Record) -> Option<f64>,
) {
    let numeric = |axis: &&super::Axis| axis.levels.iter().all(|l| number_of(l).is_some());
    let along = sweep.axes.iter().filter(numeric).max_by_key(|axis| axis.levels.len());
    let Some(along) = along.filter(|axis| axis.levels.len() > 1) else { return };
    let mut curves: Vec<Curve> = Vec::new();
    for record in &case.records {
        let setting = record.settings.iter().find(|setting| setting.knob == along.knob);
        let (Some(x), Some(y)) =
            (setting.and_then(|setting| number_of(&setting.level)), value(record))
        else {
            continue;
        };
        let name = sweep.curve_name(case, record, along.knob);
        let index = curves.iter().position(|curve| curve.0 == name).unwrap_or_else(|| {
            curves.push((name, Vec::new()));
            curves.len() - 1
        });
        let points = &mut curves[index].1;
        match points.iter_mut().find(|point| point.0 == x) {
            Some(point) => point.1.push(y),
            None => points.push((x, vec![y])),
        }
    }
    let all = || curves.iter().flat_map(|c| &c.1).flat_map(|p| &p.1);
    let log = all().all(|y| *y > 0.0)
        && all().copied().fold(0.0, f64::max) > 20.0 * all().copied().fold(f64::INFINITY, f64::min);
    let series = curves.iter().map(|(name, points)| {
        let (centres, bars): (Vec<(f64, f64)>, Vec<f64>) =
            points.iter().map(|(x, ys)| ((*x, middle(ys).0), middle(ys).1)).unzip();
        let mut series = curve(name, centres);
        if sweep.clouds > 1 {
            series.error_bars = bars;
        }
        series
    });
    study.figures.push(Figure::Plot(Plot {
        title: format!("{}: {what}", case.source.name),
        caption: match sweep.clouds {
            1 => "One cloud per combination.".into(),
            n => format!("Middle of the range over {n} clouds; bars reach to its ends."),
        },
        x: axis(&along.knob.name().replace('_', " "), "1", false),
        y: axis(what, "1", log),
        series: series.collect(),
        slopes: Vec::new(),
    }));
}

/// Middle and half-length of a range.
pub fn middle(values: &[f64]) -> (f64, f64) {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (0.5 * (low + high), 0.5 * (high - low))
}

/// A share in per cent, for people: three digits, and no powers of ten.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent.abs() {
        size if !size.is_finite() => "–".into(),
        0.0 => "0 %".into(),
        size if size < 1e-3 => "< 0.001 %".into(),
        size => {
            let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
            format!("{percent:.decimals$} %")
        }
    }
}
