//! Orders, checks, table and figures of the manufactured solutions.

use crate::manufactured::RecipeKind;
use crate::studies::manufactured::scenario::{
    Boundary, CLOUDS, CONSISTENT, Errors, Level, SCENARIOS, Scenario,
};
use crate::studies::workbench::{Workbench, exact};
use anyhow::{Context, Result, anyhow};
use mtled_checks::measure::log_log_fit;
use mtled_checks::study::{
    Bound, Cell, Column, Figure, Plot, Series, SeriesStyle, Study, Table, axis, number, text,
};

/// A quantity, its error on one cloud, and the theoretical order of a linear basis.
struct Quantity {
    id: &'static str,
    label: &'static str,
    of: fn(&Errors) -> f64,
    theoretical: f64,
}

const QUANTITIES: [Quantity; 5] = [
    Quantity {
        id: "displacement",
        label: "displacement",
        of: |e| e.displacement,
        theoretical: 2.0,
    },
    Quantity { id: "gradient", label: "gradient", of: |e| e.gradient, theoretical: 1.0 },
    Quantity { id: "pressure", label: "pressure", of: |e| e.pressure, theoretical: 1.0 },
    Quantity {
        id: "pressure_deviation",
        label: "pressure less its mean",
        of: |e| e.pressure_deviation,
        theoretical: 1.0,
    },
    Quantity {
        id: "nodal_pressure",
        label: "pressure at the nodes",
        of: |e| e.nodal_pressure,
        theoretical: 2.0,
    },
];

/// Sizes that both suites have and that the checks are for: 5, 7 and 9 nodes per edge.
const CHECKED_SIZES: usize = 3;
/// Errors of displacement and gradient at 9 nodes per edge, consistent for constant stresses only, over
/// those of the default recipe at ν = 0.3.
const SECOND_ORDER_GAIN: f64 = 1.5;
/// Target of the displacement error at 13 nodes per edge over that of interpolation.
const OVER_INTERPOLATION: f64 = 1.15;
/// Targets: order of the displacement, its error at ν = 0.499 over that at 0.49, and the errors of the
/// pressure at points and at nodes, 13 of them per edge.
const ORDER: f64 = 1.9;
/// The order with tractions on three faces.
const MIXED_ORDER: f64 = 1.85;
const LARGEST_RATIO: f64 = 1.1;
const LARGEST_PRESSURE_ERROR: f64 = 0.03;
const LARGEST_NODAL_PRESSURE_ERROR: f64 = 0.02;

/// Mean and standard deviation over the clouds of the order p in φ = αhᵖ, fitted by least squares to
/// the sizes of each cloud; the mean of the slopes is the slope of the fit to all clouds at once.
fn order(levels: &[Level], of: fn(&Errors) -> f64) -> Option<(f64, f64)> {
    let slopes: Option<Vec<f64>> = (0..CLOUDS as usize)
        .map(|cloud| {
            let series: Vec<(f64, f64)> =
                levels.iter().map(|level| (level.spacing, of(&level.errors[cloud]))).collect();
            Some(log_log_fit(&series)?.slope)
        })
        .collect();
    Some(mean_and_deviation(&slopes?))
}

/// Mean and standard deviation of a sample.
fn mean_and_deviation(sample: &[f64]) -> (f64, f64) {
    let count = sample.len() as f64;
    let mean = sample.iter().sum::<f64>() / count;
    let squares: f64 = sample.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0)).sqrt())
}

fn at_size(level: &Level, of: fn(&Errors) -> f64) -> (f64, f64) {
    mean_and_deviation(&level.errors.iter().map(of).collect::<Vec<_>>())
}

/// Compares orders and errors of the default recipe with the stored ones.
pub(crate) fn check_levels(
    bench: &Workbench,
    study: &mut Study,
    scenario: &Scenario,
    levels: &[Level],
) -> Result<()> {
    if scenario.recipe != RecipeKind::Default {
        return Ok(());
    }
    let checked = &levels[..CHECKED_SIZES.min(levels.len())];
    let last = checked.last().context("no sizes")?;
    let nodes = last.nodes_per_edge;
    let solution = format!("{}, ν = {}", scenario.label, scenario.poisson_ratio);
    for Quantity { id, label, of, theoretical } in QUANTITIES {
        let (mean, deviation) = order(checked, of).context("errors that have no logarithm")?;
        let id = format!("manufactured/{}/{id}", scenario.name);
        let order_label = format!(
            "{solution}: order of the {label} error, 5 to {nodes} nodes per edge (± {deviation:.2} over \
             {CLOUDS} clouds; {theoretical} in theory)"
        );
        study.checks.push(bench.regression(&format!("{id}_order"), &order_label, mean, "1", ""));
        let label = format!("{solution}: mean {label} error at {nodes} nodes per edge");
        study.checks.push(bench.regression(&id, &label, at_size(last, of).0, "1", ""));
    }
    Ok(())
}

/// Compares the default gradients with those of constant stresses where quadrature is what the
/// latter lack.
pub(crate) fn check_second_order(
    bench: &Workbench,
    study: &mut Study,
    all: &[(Scenario, Vec<Level>)],
) -> Result<()> {
    let find = |name: &str| all.iter().find(|(scenario, _)| scenario.name == name);
    let (Some((_, default)), Some((_, consistent))) =
        (find(SCENARIOS[0].name), find(CONSISTENT.name))
    else {
        return Err(anyhow!("a scenario is missing"));
    };
    let at = CHECKED_SIZES.min(default.len()) - 1;
    let nodes = default[at].nodes_per_edge;
    for Quantity { id, label, of, .. } in &QUANTITIES[..2] {
        study.checks.push(bench.target(
            &format!("manufactured/{}/{id}_over_default", CONSISTENT.name),
            &format!(
                "log-J, ν = 0.3: {label} error of gradients consistent for constant stresses over that of \
                 second order, {nodes} nodes per edge"
            ),
            at_size(&consistent[at], *of).0 / at_size(&default[at], *of).0,
            Bound::AtLeast(SECOND_ORDER_GAIN),
            "our own target: noise of one point per cell is what second order removes",
        ));
    }
    Ok(())
}

/// Compares orders and the errors on the finest clouds with the targets.
pub(crate) fn check_targets(
    bench: &Workbench,
    study: &mut Study,
    all: &[(Scenario, Vec<Level>)],
) -> Result<()> {
    for (scenario, levels) in all.iter().filter(|(s, _)| s.recipe != RecipeKind::Consistent) {
        check_order(bench, study, scenario, levels)?;
        check_interpolation(bench, study, scenario, levels.last().context("no sizes")?);
        if scenario.poisson_ratio > 0.4 {
            check_pressure(bench, study, scenario, levels.last().context("no sizes")?);
        }
    }
    let error = |name: &str| {
        let series = all.iter().find(|(scenario, _)| scenario.name == name);
        let last = series.and_then(|(_, levels)| levels.last());
        last.map(|level| at_size(level, QUANTITIES[0].of).0).context("a scenario is missing")
    };
    study.checks.push(exact(
        "manufactured/log_j/displacement_ratio",
        "displacement error at ν = 0.499 over that at ν = 0.49, log-J, finest clouds",
        error("log_j-nu499")? / error("log_j-nu490")?,
        LARGEST_RATIO,
        "No locking: the error does not depend on λ/μ",
    ));
    Ok(())
}

fn check_order(
    bench: &Workbench,
    study: &mut Study,
    scenario: &Scenario,
    levels: &[Level],
) -> Result<()> {
    let (mean, deviation) =
        order(levels, QUANTITIES[0].of).context("errors that have no logarithm")?;
    study.checks.push(bench.target(
        &format!("manufactured/{}/promised_order", scenario.name),
        &format!(
            "{}, ν = {}: order of the displacement error, 5 to 13 nodes per edge (± {deviation:.2})",
            scenario.label, scenario.poisson_ratio
        ),
        mean,
        Bound::AtLeast(match scenario.boundary {
            Boundary::Prescribed => ORDER,
            Boundary::Mixed => MIXED_ORDER,
        }),
        "a linear basis has 2 in theory",
    ));
    Ok(())
}

fn check_interpolation(bench: &Workbench, study: &mut Study, scenario: &Scenario, finest: &Level) {
    study.checks.push(bench.target(
        &format!("manufactured/{}/over_interpolation", scenario.name),
        &format!(
            "{}, ν = {}: displacement error over that of the field through the solution at the nodes, \
             {} nodes per edge",
            scenario.label, scenario.poisson_ratio, finest.nodes_per_edge
        ),
        at_size(finest, |e| e.displacement).0 / at_size(finest, |e| e.interpolation).0,
        Bound::AtMost(OVER_INTERPOLATION),
        "our own target",
    ));
}

/// The pressure less its mean is determined; its mean depends on the volume that the boundary
/// prescribes.
fn check_pressure(bench: &Workbench, study: &mut Study, scenario: &Scenario, finest: &Level) {
    for quantity in &QUANTITIES[2..] {
        let most = match quantity.id {
            "nodal_pressure" => LARGEST_NODAL_PRESSURE_ERROR,
            _ => LARGEST_PRESSURE_ERROR,
        };
        study.checks.push(bench.target(
            &format!("manufactured/{}/finest_{}", scenario.name, quantity.id),
            &format!(
                "{}, ν = {}: mean {} error at {} nodes per edge",
                scenario.label, scenario.poisson_ratio, quantity.label, finest.nodes_per_edge
            ),
            at_size(finest, quantity.of).0,
            Bound::AtMost(most),
            "the target at ν = 0.49 and 0.499",
        ));
    }
}

/// Errors and orders of all scenarios, mean and standard deviation over clouds.
pub(crate) fn table(all: &[(Scenario, Vec<Level>)]) -> Table {
    let mut rows = Vec::new();
    for (scenario, levels) in all {
        let row = |size: String,
                   value: &dyn Fn(&Quantity) -> (f64, f64),
                   interpolation: f64,
                   volume: Cell| {
            let mut row = vec![
                Cell::Text(scenario.label.into()),
                Cell::Number(scenario.poisson_ratio),
                Cell::Text(size),
            ];
            for quantity in &QUANTITIES {
                let (mean, deviation) = value(quantity);
                row.extend([Cell::Number(mean), Cell::Number(deviation)]);
            }
            row.extend([Cell::Number(interpolation), volume]);
            row
        };
        for level in levels {
            let size = format!("{} nodes per edge", level.nodes_per_edge);
            let volume = at_size(level, |e| e.volume.abs()).0;
            let interpolation = at_size(level, |e| e.interpolation).0;
            let value = |quantity: &Quantity| at_size(level, quantity.of);
            rows.push(row(size, &value, interpolation, Cell::Number(volume)));
        }
        // The slopes between neighbours show the curvature of the fit; they are not checked.
        let all = 0..levels.len();
        let neighbours = (1..levels.len()).map(|last| last - 1..last + 1);
        for fitted in std::iter::once(all).chain(neighbours) {
            let levels = &levels[fitted];
            let [first, last] =
                [&levels[0], &levels[levels.len() - 1]].map(|level| level.nodes_per_edge);
            let slope =
                |quantity: &Quantity| order(levels, quantity.of).unwrap_or((f64::NAN, f64::NAN));
            let interpolation =
                order(levels, |e| e.interpolation).map_or(f64::NAN, |order| order.0);
            let size = format!("order, {first} to {last}");
            rows.push(row(size, &slope, interpolation, Cell::Text("".into())));
        }
    }
    Table {
        title: format!("Relative errors and orders, mean and deviation over {CLOUDS} clouds"),
        columns: columns(),
        rows,
    }
}

fn columns() -> Vec<Column> {
    vec![
        text("law"),
        number("Poisson's ratio", "1"),
        text("size"),
        number("displacement", "1"),
        number("±", "1"),
        number("gradient", "1"),
        number("±", "1"),
        number("pressure", "1"),
        number("±", "1"),
        number("pressure less its mean", "1"),
        number("±", "1"),
        number("pressure at the nodes", "1"),
        number("±", "1"),
        number("interpolated displacement", "1"),
        number("gain of volume", "1"),
    ]
}

/// Errors against the spacing for one Poisson's ratio.
pub(crate) fn figure(poisson_ratio: f64, all: &[(Scenario, Vec<Level>)]) -> Figure {
    let mut series = Vec::new();
    for (scenario, levels) in all.iter().filter(|(s, _)| s.poisson_ratio == poisson_ratio) {
        for quantity in &QUANTITIES {
            let samples: Vec<(f64, f64)> = levels.iter().map(|r| at_size(r, quantity.of)).collect();
            let spacings = levels.iter().map(|level| level.spacing);
            series.push(Series {
                name: format!("{}, {}", scenario.label, quantity.label),
                points: spacings.zip(samples.iter().map(|s| s.0)).collect(),
                error_bars: samples.iter().map(|s| s.1).collect(),
                style: SeriesStyle::LineAndPoints,
                colour: None,
            });
        }
    }
    Figure::Plot(Plot {
        title: format!("Manufactured solutions, ν = {poisson_ratio}"),
        caption: format!(
            "Relative L2 errors, mean and standard deviation over {CLOUDS} clouds of jitter 0.3. In \
             theory a linear basis has order 2 in the displacement and 1 in gradient and pressure."
        ),
        x: axis("node spacing", "m", true),
        y: axis("relative error", "1", true),
        series,
        slopes: vec![1.0, 2.0],
    })
}
