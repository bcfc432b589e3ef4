//! Errors over spacings and orders with their scatter.

use super::tables::{ending, middle, optional, percent, setting_cells, setting_columns};
use super::{Measured, Sweep};
use crate::explore::store::Record;
use crate::scene::Knob;
use mtled_checks::measure::log_log_fit;
use mtled_checks::study::shorthand::{axis, curve, number, text};
use mtled_checks::study::{Cell, Figure, Plot, Study, Table};

/// A fitted order is called one only above this many times its own deviation.
const SIGNIFICANT: f64 = 2.0;

/// Table of errors, table of orders and figure of a case.
pub fn add(study: &mut Study, sweep: &Sweep, case: &Measured) {
    let Some((truth, group)) = &case.truth else { return };
    let error = |record: &Record| {
        let difference = truth.difference(&case.source.case, *group, record.values()?)?;
        Some((difference.rms, difference.max, difference.bar))
    };
    let mut columns = setting_columns(sweep);
    columns.extend([
        number("spacing", "m"),
        number("nodes", "1"),
        number("points", "1"),
        number("error, rms", "1"),
        number("error, largest", "1"),
        number("error of the truth", "1"),
        number("evaluations of the force", "1"),
        text("what came of it"),
    ]);
    let row = |record: &Record| {
        let found = error(record);
        let mut cells = setting_cells(sweep, record);
        cells.push(optional(record.figure("spacing_m")));
        cells.push(optional(record.figure("nodes")));
        cells.push(optional(record.figure("points")));
        cells.push(optional(found.map(|f| f.0)));
        cells.push(optional(found.map(|f| f.1)));
        cells.push(optional(found.map(|f| f.2)));
        cells.push(optional(record.work().map(|work| work.force_evaluations as f64)));
        cells.push(Cell::Text(ending(record)));
        cells
    };
    study.tables.push(Table {
        title: format!("{}: errors of the {}", case.source.name, group.words()),
        columns,
        rows: case.records.iter().map(row).collect(),
    });
    let families = families(sweep, case, &|record| error(record).map(|found| found.0));
    let bar = case.records.iter().find_map(|record| Some(error(record)?.2)).unwrap_or(0.0);
    study.tables.push(orders(case, &families, bar));
    study.figures.push(Figure::Plot(figure(case, group.words(), &families, bar)));
    study.notes.push(format!(
        "{}: errors are rms differences from {} over the largest value of their kind; its own error \
         is {}. No order is claimed where errors are not larger than that, or where the fit \
         scatters by more than half of itself.",
        case.source.name,
        truth.source,
        percent(bar)
    ));
}

/// (spacing \[m\], error) of every record, by what else was set.
type Family = (String, Vec<(f64, f64)>);

fn families(sweep: &Sweep, case: &Measured, error: &dyn Fn(&Record) -> Option<f64>) -> Vec<Family> {
    let mut families: Vec<Family> = Vec::new();
    for record in &case.records {
        let (Some(h), Some(error)) = (record.figure("spacing_m"), error(record)) else { continue };
        let name = sweep.curve_name(case, record, Knob::Spacing);
        match families.iter_mut().find(|family| family.0 == name) {
            Some(family) => family.1.push((h, error)),
            None => families.push((name, vec![(h, error)])),
        }
    }
    families
}

fn orders(case: &Measured, families: &[Family], bar: f64) -> Table {
    let row = |(name, samples): &Family| {
        let above: Vec<(f64, f64)> = samples.iter().copied().filter(|s| s.1 > bar).collect();
        let fit = log_log_fit(&above).filter(|fit| fit.standard_deviation.is_finite());
        let claimed = fit.filter(|fit| fit.slope > SIGNIFICANT * fit.standard_deviation);
        vec![
            Cell::Text(name.clone()),
            Cell::Number(above.len() as f64),
            optional(fit.map(|fit| fit.slope)),
            optional(fit.map(|fit| fit.standard_deviation)),
            Cell::Text(match (fit, claimed) {
                (_, Some(fit)) => format!("{:.2} ± {:.2}", fit.slope, fit.standard_deviation),
                (Some(_), None) => "none: scatter".into(),
                (None, _) => "none: errors within the bar of the truth, or one spacing only".into(),
            }),
        ]
    };
    Table {
        title: format!("{}: orders", case.source.name),
        columns: vec![
            text("recipe"),
            number("runs above the bar", "1"),
            number("slope of the fit", "1"),
            number("its standard deviation", "1"),
            text("order"),
        ],
        rows: families.iter().map(row).collect(),
    }
}

fn figure(case: &Measured, words: &str, families: &[Family], bar: f64) -> Plot {
    let mut series: Vec<_> = (families.iter())
        .map(|(name, samples)| {
            let mut points: Vec<(f64, Vec<f64>)> = Vec::new();
            for (h, error) in samples {
                // Clouds of one spacing may differ in the last digits of it.
                match points.iter_mut().find(|point| (point.0 / h - 1.0).abs() < 1e-6) {
                    Some(point) => point.1.push(*error),
                    None => points.push((*h, vec![*error])),
                }
            }
            let (centres, bars): (Vec<(f64, f64)>, Vec<f64>) =
                points.iter().map(|(x, ys)| ((*x, middle(ys).0), middle(ys).1)).unzip();
            let mut series = curve(name, centres);
            series.error_bars = bars;
            series
        })
        .collect();
    let spacings = families.iter().flat_map(|family| family.1.iter().map(|s| s.0));
    let (low, high) = spacings.fold((f64::INFINITY, 0.0f64), |(l, h), s| (l.min(s), h.max(s)));
    if bar > 0.0 && high > 0.0 {
        series.push(mtled_checks::study::shorthand::line(
            "error of the truth",
            vec![(low, bar), (high, bar)],
        ));
    }
    Plot {
        title: format!("{}: error of the {words} over the spacing", case.source.name),
        caption: "Middle of the range over the clouds; bars reach to its ends.".into(),
        x: axis("node spacing", "m", true),
        y: axis("rms error over the largest value", "1", true),
        series,
        slopes: vec![1.0, 2.0],
    }
}
