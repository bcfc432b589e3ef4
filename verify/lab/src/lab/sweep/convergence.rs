//! Errors over spacings and orders with their scatter.

use super::curves::curves;
use super::definition::{MeasuredCase, Sweep};
use super::tables::{OUTCOME, ending};
use crate::lab::label::{optional, percent};
use crate::lab::store::RunRecord;
use mtled_case::scene::Knob;
use mtled_checks::measure::{LogLogFit, log_log_fit};
use mtled_checks::study::{Cell, Figure, Plot, Study, Table, axis, line, number, text};
use std::collections::BTreeSet;

/// A fitted order is reported only above this many times its standard deviation.
const SIGNIFICANT: f64 = 2.0;

/// (spacing \[m\], rms error) of the runs that differ in spacing and cloud only.
type Family = (String, Vec<(f64, f64)>);

/// Adds the table of errors, the table of orders and the figure of a case.
pub(crate) fn add_convergence(study: &mut Study, sweep: &Sweep, case: &MeasuredCase) {
    let Some((reference, group)) = &case.reference else { return };
    let error =
        |record: &RunRecord| reference.difference(&case.source.case, *group, record.values()?);
    let mut columns = sweep.setting_columns();
    columns.extend([
        number("spacing", "m"),
        number("nodes", "1"),
        number("points", "1"),
        number("error, rms", "1"),
        number("error, largest", "1"),
        number("error of the reference", "1"),
        number("evaluations of the force", "1"),
        text(OUTCOME),
    ]);
    let row = |record: &RunRecord| {
        let error = error(record);
        let mut cells = sweep.setting_cells(record);
        cells.extend(["spacing_m", "nodes", "points"].map(|name| optional(record.figure(name))));
        cells.push(optional(error.map(|error| error.rms)));
        cells.push(optional(error.map(|error| error.max)));
        cells.push(optional(error.map(|error| error.bar)));
        cells.push(optional(record.work().map(|work| work.force_evaluations as f64)));
        cells.push(Cell::Text(ending(record)));
        cells
    };
    study.tables.push(Table {
        title: format!("{}: errors of the {}", case.source.name, group.label()),
        columns,
        rows: case.records.iter().map(row).collect(),
    });
    let families = families(sweep, case, &|record| error(record).map(|error| error.rms));
    let bar = case.records.iter().find_map(|record| Some(error(record)?.bar)).unwrap_or(0.0);
    study.tables.push(orders(case, &families, bar));
    study.undecided.extend(reference.disagreements(&case.source.case, *group).into_iter().map(
        |disagreement| {
            format!("{}: {disagreement}; errors against it decide nothing", case.source.name)
        },
    ));
    study.undecided.extend(families.iter().filter_map(|family| {
        let why = undecided(sweep.clouds, family, bar)?;
        Some(if family.0 == case.source.name {
            format!("{}: {why}", case.source.name)
        } else {
            format!("{}, {}: {why}", case.source.name, family.0)
        })
    }));
    study.figures.push(Figure::Plot(figure(case, group.label(), &families, bar)));
    study.notes.push(format!(
        "{}: errors are rms differences from the reference, over the largest value of their kind. \
         Reference: {}; its own error is {}. No order is reported where errors are not larger than \
         that, or where the fitted order scatters by more than half of itself.",
        case.source.name,
        reference.source,
        percent(bar)
    ));
}

fn families(
    sweep: &Sweep,
    case: &MeasuredCase,
    error: &dyn Fn(&RunRecord) -> Option<f64>,
) -> Vec<Family> {
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

fn orders(case: &MeasuredCase, families: &[Family], bar: f64) -> Table {
    let row = |(name, samples): &Family| {
        let above = above(samples, bar);
        let fit = fit(&above);
        let order = match fit {
            Some(fit) if is_order(&fit) => {
                format!("{:.2} ± {:.2}", fit.slope, fit.standard_deviation)
            }
            Some(fit) if fit.slope <= 0.0 => "none: errors do not fall".into(),
            Some(_) => "none: scatter".into(),
            None => "none: errors below that of the reference, or a single spacing".into(),
        };
        vec![
            Cell::Text(name.clone()),
            Cell::Number(above.len() as f64),
            optional(fit.map(|fit| fit.slope)),
            optional(fit.map(|fit| fit.standard_deviation)),
            Cell::Text(order),
        ]
    };
    Table {
        title: format!("{}: orders", case.source.name),
        columns: vec![
            text("recipe"),
            number("runs above the error of the reference", "1"),
            number("slope of the fit", "1"),
            number("its standard deviation", "1"),
            text("order"),
        ],
        rows: families.iter().map(row).collect(),
    }
}

/// Errors that are larger than that of the reference.
fn above(samples: &[(f64, f64)], bar: f64) -> Vec<(f64, f64)> {
    samples.iter().copied().filter(|sample| sample.1 > bar).collect()
}

fn fit(above: &[(f64, f64)]) -> Option<LogLogFit> {
    log_log_fit(above).filter(|fit| fit.standard_deviation.is_finite())
}

fn is_order(fit: &LogLogFit) -> bool {
    fit.slope > SIGNIFICANT * fit.standard_deviation
}

/// Why the errors of a family show no order, and what would.
fn undecided(clouds: usize, (_, samples): &Family, bar: f64) -> Option<String> {
    let above = above(samples, bar);
    let spacings: BTreeSet<u64> = above.iter().map(|sample| sample.0.to_bits()).collect();
    if above.is_empty() {
        return Some(format!(
            "no error is larger than that of the reference ({}), so no order can be told: take \
             coarser spacings (--spacing) or a better reference (--reference)",
            percent(bar)
        ));
    }
    if spacings.len() < 2 {
        return Some(format!(
            "one spacing has errors above that of the reference ({}), and an order needs two: take \
             more and coarser spacings (--spacing)",
            percent(bar)
        ));
    }
    match fit(&above) {
        Some(fit) if is_order(&fit) && clouds == 1 => Some(
            "the order of one cloud says nothing about its scatter over clouds: take three \
             (--clouds 3)"
                .into(),
        ),
        Some(fit) if is_order(&fit) => None,
        Some(fit) if fit.slope <= 0.0 => Some(format!(
            "the errors do not fall with the spacing, the fitted order is {:.2} ± {:.2}: take finer spacings \
             (--spacing), or look what limits them (--reference)",
            fit.slope, fit.standard_deviation
        )),
        Some(fit) => Some(format!(
            "the fitted order, {:.2} ± {:.2}, scatters by more than half of itself: take more clouds \
             (--clouds) or a wider range of spacings (--spacing)",
            fit.slope, fit.standard_deviation
        )),
        None => Some("two errors show no scatter: take a third spacing (--spacing)".into()),
    }
}

fn figure(case: &MeasuredCase, group: &str, families: &[Family], bar: f64) -> Plot {
    let samples = families.iter().flat_map(|(name, samples)| {
        samples.iter().map(move |(h, error)| (name.clone(), *h, *error))
    });
    let mut series: Vec<_> = curves(samples).iter().map(|curve| curve.series()).collect();
    let spacings = families.iter().flat_map(|family| family.1.iter().map(|sample| sample.0));
    let (low, high) = spacings.fold((f64::INFINITY, 0.0f64), |(l, h), s| (l.min(s), h.max(s)));
    if bar > 0.0 && high > 0.0 {
        series.push(line("error of the reference", vec![(low, bar), (high, bar)]));
    }
    Plot {
        title: format!("{}: error of the {group} over the spacing", case.source.name),
        caption: "Middle of the range over the clouds; bars reach to its ends.".into(),
        x: axis("node spacing", "m", true),
        y: axis("rms error over the largest value", "1", true),
        series,
        slopes: vec![1.0, 2.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn why(clouds: usize, samples: &[(f64, f64)]) -> Option<String> {
        undecided(clouds, &("recipe".into(), samples.to_vec()), 1e-3)
    }

    #[test]
    fn errors_show_an_order_or_it_is_said_why_not() {
        let second = |factor: f64| [1.0, 0.5, 0.25].map(|h| (h, factor * h * h)).to_vec();
        assert_eq!(why(3, &second(1.0)), None);
        let with = |clouds: usize, samples: &[(f64, f64)], reason: &str| {
            let why = why(clouds, samples).unwrap();
            assert!(why.contains(reason) && why.contains("--"), "{why}");
        };
        with(3, &second(1e-4), "no error is larger than that of the reference (0.100 %)");
        with(3, &second(0.003), "one spacing");
        with(1, &second(1.0), "one cloud");
        with(3, &[(1.0, 0.5), (0.5, 0.1), (0.5, 0.6), (0.25, 0.2)], "scatters");
        with(3, &[(1.0, 0.5), (0.5, 0.1)], "two errors");
        with(3, &[(1.0, 0.1), (0.5, 0.11), (0.25, 0.2)], "do not fall");
    }
}
