//! Orders, bounds, table and figures of the manufactured solutions.

use super::manufactured::{CLOUDS, Errors, Rung, Scenario};
use super::plain::{axis, number, text};
use crate::measure::log_log_fit;
use crate::study::{Bound, Cell, Check, Figure, Kind, Plot, Series, SeriesStyle, Study, Table};
use anyhow::{Context, Result};

/// A quantity, how it is read from the errors of a cloud, and what the error of
/// a linear basis promises for its order.
struct Quantity {
    name: &'static str,
    of: fn(&Errors) -> f64,
    promised: f64,
}

const QUANTITIES: [Quantity; 3] = [
    Quantity { name: "displacement", of: |e| e.displacement, promised: 2.0 },
    Quantity { name: "gradient", of: |e| e.gradient, promised: 1.0 },
    Quantity { name: "pressure", of: |e| e.pressure, promised: 1.0 },
];

/// Measured with the default recipe: order over the first [`BOUNDED_SIZES`] and mean
/// error at the last of them, of displacement, gradient and pressure.
const MEASURED: [(&str, [[f64; 2]; 3]); 8] = [
    ("log_j-nu300", [[1.51, 0.0075], [0.57, 0.0634], [0.89, 0.0379]]),
    ("isochoric-nu300", [[1.42, 0.0091], [0.49, 0.0755], [0.83, 0.0396]]),
    ("log_j-nu490", [[1.81, 0.0078], [0.84, 0.0534], [1.28, 0.0629]]),
    ("isochoric-nu490", [[1.79, 0.0080], [0.82, 0.0545], [1.30, 0.0612]]),
    ("mooney_rivlin-nu490", [[1.82, 0.0077], [0.84, 0.0530], [1.28, 0.0653]]),
    ("log_j-nu499", [[1.81, 0.0079], [0.84, 0.0536], [1.98, 0.2473]]),
    ("isochoric-nu499", [[1.79, 0.0081], [0.82, 0.0547], [2.03, 0.2593]]),
    ("mooney_rivlin-nu499", [[1.82, 0.0079], [0.84, 0.0532], [1.96, 0.2458]]),
];

/// Sizes that both suites have and that the bounds are for: 5, 7 and 9 nodes.
const BOUNDED_SIZES: usize = 3;
/// Room around measured orders and over measured errors.
const ORDER_BAND: f64 = 0.1;
const ERROR_BAND: f64 = 1.1;

/// An observed order with its standard deviation over the clouds.
#[derive(Debug, Clone, Copy)]
struct Order {
    mean: f64,
    deviation: f64,
}

/// Fits φ = αhᵖ by least squares to each cloud's own ladder of sizes; the mean
/// of the slopes is the slope of the fit to all clouds at once.
fn order(rungs: &[Rung], of: fn(&Errors) -> f64) -> Option<Order> {
    let slopes: Option<Vec<f64>> = (0..CLOUDS as usize)
        .map(|cloud| {
            let ladder: Vec<(f64, f64)> =
                rungs.iter().map(|rung| (rung.spacing, of(&rung.errors[cloud]))).collect();
            Some(log_log_fit(&ladder)?.slope)
        })
        .collect();
    let (mean, deviation) = spread(&slopes?);
    Some(Order { mean, deviation })
}

/// Mean and standard deviation of a sample.
fn spread(sample: &[f64]) -> (f64, f64) {
    let count = sample.len() as f64;
    let mean = sample.iter().sum::<f64>() / count;
    let squares: f64 = sample.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0)).sqrt())
}

fn at_size(rung: &Rung, of: fn(&Errors) -> f64) -> (f64, f64) {
    spread(&rung.errors.iter().map(of).collect::<Vec<_>>())
}

/// Bounds orders and errors by what was measured before, of the default recipe.
pub fn judge(study: &mut Study, scenario: &Scenario, rungs: &[Rung]) -> Result<()> {
    if scenario.cells_per_spacing.is_some() {
        return Ok(());
    }
    let figures = MEASURED.iter().find(|(name, _)| *name == scenario.name).map(|(_, f)| *f);
    let figures = figures.with_context(|| format!("no measured figures for {}", scenario.name))?;
    let bounded = &rungs[..BOUNDED_SIZES.min(rungs.len())];
    let last = bounded.last().context("no sizes")?;
    let nodes = last.nodes_per_edge;
    let what = format!("{}, ν = {}", scenario.words, scenario.poisson_ratio);
    for (quantity, [least, measured]) in QUANTITIES.iter().zip(figures) {
        let found = order(bounded, quantity.of).context("errors that have no logarithm")?;
        let name = quantity.name;
        study.checks.push(Check::new(
            &format!("manufactured/{}/{name}_order", scenario.name),
            &format!(
                "{what}: order of the {name} error, 5 to {nodes} nodes per edge (± {:.2} over \
                 {CLOUDS} clouds; {} is promised)",
                found.deviation, quantity.promised
            ),
            Kind::Regression,
            found.mean,
            Bound::AtLeast(least - ORDER_BAND),
            "1",
            &format!("the default recipe: {least:.2}, less {ORDER_BAND}"),
        ));
        let (error, _) = at_size(last, quantity.of);
        study.checks.push(Check::new(
            &format!("manufactured/{}/{name}", scenario.name),
            &format!("{what}: mean {name} error at {nodes} nodes per edge"),
            Kind::Regression,
            error,
            Bound::AtMost(ERROR_BAND * measured),
            "1",
            &format!("the default recipe: {measured:.4}, times {ERROR_BAND}"),
        ));
    }
    Ok(())
}

/// Sizes whose orders are promised: 7, 9, 11 and 13 nodes per edge.
const PROMISED_SIZES: usize = 4;
/// Displacement error at ν = 0.499 over that at ν = 0.49.
const LARGEST_RATIO: f64 = 1.1;

/// Bounds the orders of the displacement that the method promises, and what it
/// may lose near the incompressible limit.
pub fn judge_full(study: &mut Study, ladders: &[(Scenario, Vec<Rung>)]) -> Result<()> {
    let displacement = &QUANTITIES[0];
    for (scenario, rungs) in ladders {
        let last = &rungs[rungs.len() - PROMISED_SIZES..];
        let found = order(last, displacement.of).context("errors that have no logarithm")?;
        let least = if scenario.cells_per_spacing.is_some() { 1.9 } else { 1.7 };
        study.checks.push(Check::new(
            &format!("manufactured/{}/promised_order", scenario.name),
            &format!(
                "{}, ν = {}: order of the displacement error, 7 to 13 nodes per edge (± {:.2})",
                scenario.words, scenario.poisson_ratio, found.deviation
            ),
            Kind::Exact,
            found.mean,
            Bound::AtLeast(least),
            "1",
            "A linear basis promises 2",
        ));
    }
    let error = |name: &str| {
        let ladder = ladders.iter().find(|(scenario, _)| scenario.name == name);
        let last = ladder.and_then(|(_, rungs)| rungs.last());
        last.map(|rung| at_size(rung, displacement.of).0).context("a scenario is missing")
    };
    study.checks.push(Check::new(
        "manufactured/log_j/displacement_ratio",
        "displacement error at ν = 0.499 over that at ν = 0.49, log-J, finest clouds",
        Kind::Exact,
        error("log_j-nu499")? / error("log_j-nu490")?,
        Bound::AtMost(LARGEST_RATIO),
        "1",
        "No locking: the error does not depend on λ/μ",
    ));
    Ok(())
}

/// Errors and orders of all scenarios, mean and standard deviation over clouds.
pub fn table(ladders: &[(Scenario, Vec<Rung>)]) -> Table {
    let mut rows = Vec::new();
    for (scenario, rungs) in ladders {
        let row = |size: String, value: &dyn Fn(&Quantity) -> (f64, f64)| {
            let mut row = vec![
                Cell::Text(scenario.words.into()),
                Cell::Number(scenario.poisson_ratio),
                Cell::Text(size),
            ];
            for quantity in &QUANTITIES {
                let (mean, deviation) = value(quantity);
                row.extend([Cell::Number(mean), Cell::Number(deviation)]);
            }
            row
        };
        for rung in rungs {
            let size = format!("{} nodes per edge", rung.nodes_per_edge);
            rows.push(row(size, &|quantity| at_size(rung, quantity.of)));
        }
        rows.push(row("order".into(), &|quantity| {
            order(rungs, quantity.of).map_or((f64::NAN, f64::NAN), |o| (o.mean, o.deviation))
        }));
    }
    Table {
        title: format!("Relative errors and orders, mean and deviation over {CLOUDS} clouds"),
        columns: vec![
            text("law"),
            number("Poisson's ratio", "1"),
            text("size"),
            number("displacement", "1"),
            number("±", "1"),
            number("gradient", "1"),
            number("±", "1"),
            number("pressure", "1"),
            number("±", "1"),
        ],
        rows,
    }
}

/// Errors against the spacing for one Poisson's ratio.
pub fn figure(poisson_ratio: f64, ladders: &[(Scenario, Vec<Rung>)]) -> Figure {
    let mut series = Vec::new();
    for (scenario, rungs) in ladders.iter().filter(|(s, _)| s.poisson_ratio == poisson_ratio) {
        for quantity in &QUANTITIES {
            let samples: Vec<(f64, f64)> = rungs.iter().map(|r| at_size(r, quantity.of)).collect();
            let spacings = rungs.iter().map(|rung| rung.spacing);
            series.push(Series {
                name: format!("{}, {}", scenario.words, quantity.name),
                points: spacings.zip(samples.iter().map(|s| s.0)).collect(),
                error_bars: samples.iter().map(|s| s.1).collect(),
                style: SeriesStyle::LineAndPoints,
            });
        }
    }
    Figure::Plot(Plot {
        title: format!("Manufactured solutions, ν = {poisson_ratio}"),
        caption: format!(
            "Relative L2 errors, mean and standard deviation over {CLOUDS} clouds of jitter 0.3. A \
             linear basis promises order 2 in the displacement and 1 in gradient and pressure."
        ),
        x: axis("node spacing", "m", true),
        y: axis("relative error", "1", true),
        series,
        slopes: vec![1.0, 2.0],
    })
}
