//! Orders, bounds, table and figures of the manufactured solutions.

use crate::specimens::manufactured::Scheme;
use crate::studies::manufactured::{CLOUDS, Errors, Rung, Scenario};
use anyhow::{Context, Result};
use mtled_checks::measure::log_log_fit;
use mtled_checks::study::shorthand::{axis, number, text};
use mtled_checks::study::{
    Bound, Cell, Check, Figure, Kind, Plot, Series, SeriesStyle, Study, Table,
};

/// A quantity, how it is read from the errors of a cloud, and what the error of
/// a linear basis promises for its order.
struct Quantity {
    name: &'static str,
    of: fn(&Errors) -> f64,
    promised: f64,
}

const QUANTITIES: [Quantity; 4] = [
    Quantity { name: "displacement", of: |e| e.displacement, promised: 2.0 },
    Quantity { name: "gradient", of: |e| e.gradient, promised: 1.0 },
    Quantity { name: "pressure", of: |e| e.pressure, promised: 1.0 },
    Quantity { name: "pressure_deviation", of: |e| e.pressure_deviation, promised: 1.0 },
];

/// The worst of 21 families of clouds (`--seed` 0 to 20) with the default recipe: order
/// over the first [`BOUNDED_SIZES`] and mean error at the last of them, of displacement,
/// gradient, pressure and pressure less its mean.
const MEASURED: [(&str, [[f64; 2]; 4]); 8] = [
    ("log_j-nu300", [[1.18, 0.0084], [0.33, 0.0696], [0.67, 0.0415], [0.66, 0.0415]]),
    ("isochoric-nu300", [[1.05, 0.0105], [0.21, 0.0847], [0.58, 0.0429], [0.58, 0.0429]]),
    ("log_j-nu490", [[1.66, 0.0083], [0.66, 0.0571], [0.95, 0.0602], [0.95, 0.0601]]),
    ("isochoric-nu490", [[1.63, 0.0086], [0.64, 0.0586], [0.95, 0.0571], [0.94, 0.0571]]),
    ("mooney_rivlin-nu490", [[1.67, 0.0082], [0.67, 0.0566], [0.96, 0.0636], [0.96, 0.0636]]),
    ("log_j-nu499", [[1.67, 0.0085], [0.67, 0.0572], [1.01, 0.0663], [0.94, 0.0622]]),
    ("isochoric-nu499", [[1.64, 0.0087], [0.65, 0.0586], [1.03, 0.0639], [0.94, 0.0590]]),
    ("mooney_rivlin-nu499", [[1.68, 0.0084], [0.68, 0.0566], [1.01, 0.0698], [0.95, 0.0660]]),
];

/// Sizes that both suites have and that the bounds are for: 5, 7 and 9 nodes.
const BOUNDED_SIZES: usize = 3;
/// Room below the least order and over the largest error.
const ORDER_BAND: f64 = 0.05;
const ERROR_BAND: f64 = 1.05;

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
    if scenario.scheme != Scheme::Default {
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
        let (name, said) = (quantity.name, words(quantity));
        study.checks.push(Check::new(
            &format!("manufactured/{}/{name}_order", scenario.name),
            &format!(
                "{what}: order of the {said} error, 5 to {nodes} nodes per edge (± {:.2} over \
                 {CLOUDS} clouds; {} is promised)",
                found.deviation, quantity.promised
            ),
            Kind::Regression,
            found.mean,
            Bound::AtLeast(least - ORDER_BAND),
            "1",
            &format!("the least of 21 families of clouds: {least:.2}, less {ORDER_BAND}"),
        ));
        let (error, _) = at_size(last, quantity.of);
        study.checks.push(Check::new(
            &format!("manufactured/{}/{name}", scenario.name),
            &format!("{what}: mean {said} error at {nodes} nodes per edge"),
            Kind::Regression,
            error,
            Bound::AtMost(ERROR_BAND * measured),
            "1",
            &format!("the largest of 21 families of clouds: {measured:.4}, times {ERROR_BAND}"),
        ));
    }
    Ok(())
}

/// What is wished for: orders of the displacement with the default recipe and with
/// finer cells, its error at ν = 0.499 over that at 0.49, and the error of the
/// pressure at 13 nodes per edge.
const DEFAULT_ORDER: f64 = 1.7;
const FINER_ORDER: f64 = 1.9;
const LARGEST_RATIO: f64 = 1.1;
const LARGEST_PRESSURE_ERROR: f64 = 0.04;

/// Orders of the displacement over 5, 7, 9 and 13 nodes per edge that miss the wish.
const MISSED_ORDERS: [(&str, f64); 2] = [("log_j-nu300", 1.65), ("isochoric-nu300", 1.55)];
/// Errors of the pressure at 13 nodes per edge that miss it.
const MISSED_PRESSURES: [(&str, &str, f64); 2] = [
    ("mooney_rivlin-nu499", "pressure", 0.0406),
    ("mooney_rivlin-nu499", "pressure_deviation", 0.0403),
];

/// Bounds what is wished for of the whole ladder; what is known to miss the wish
/// is bounded by what was measured.
pub fn judge_full(study: &mut Study, ladders: &[(Scenario, Vec<Rung>)]) -> Result<()> {
    for (scenario, rungs) in ladders {
        judge_order(study, scenario, rungs)?;
        if scenario.poisson_ratio > 0.4 {
            judge_pressure(study, scenario, rungs.last().context("no sizes")?);
        }
    }
    let error = |name: &str| {
        let ladder = ladders.iter().find(|(scenario, _)| scenario.name == name);
        let last = ladder.and_then(|(_, rungs)| rungs.last());
        last.map(|rung| at_size(rung, QUANTITIES[0].of).0).context("a scenario is missing")
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

fn judge_order(study: &mut Study, scenario: &Scenario, rungs: &[Rung]) -> Result<()> {
    let found = order(rungs, QUANTITIES[0].of).context("errors that have no logarithm")?;
    let finer = scenario.scheme == Scheme::Finer;
    let wish = if finer { FINER_ORDER } else { DEFAULT_ORDER };
    let (kind, least, source) = match MISSED_ORDERS.iter().find(|(name, _)| *name == scenario.name)
    {
        None => (Kind::Exact, wish, "A linear basis promises 2".to_string()),
        Some((_, measured)) => (
            Kind::Regression,
            measured - ORDER_BAND,
            format!(
                "at least {wish} is wished for and missed: {measured:.2} was measured, less \
                     {ORDER_BAND}; how the grid is cut at the boundary changes from size to size"
            ),
        ),
    };
    study.checks.push(Check::new(
        &format!("manufactured/{}/promised_order", scenario.name),
        &format!(
            "{}, ν = {}: order of the displacement error, 5 to 13 nodes per edge (± {:.2})",
            scenario.words, scenario.poisson_ratio, found.deviation
        ),
        kind,
        found.mean,
        Bound::AtLeast(least),
        "1",
        &source,
    ));
    Ok(())
}

/// The pressure less its mean is determined; the whole of it hangs on the volume
/// that the boundary prescribes.
fn judge_pressure(study: &mut Study, scenario: &Scenario, finest: &Rung) {
    for quantity in &QUANTITIES[2..] {
        let missed = MISSED_PRESSURES
            .iter()
            .find(|(name, of, _)| *name == scenario.name && *of == quantity.name);
        let wish = LARGEST_PRESSURE_ERROR;
        let (kind, most, source) = match missed {
            None => (Kind::Exact, wish, "wished for at ν = 0.49 and 0.499".to_string()),
            Some((_, _, measured)) => (
                Kind::Regression,
                ERROR_BAND * measured,
                format!(
                    "at most {wish} is wished for and missed by one law of three: {measured:.4} was \
                     measured, times {ERROR_BAND}"
                ),
            ),
        };
        study.checks.push(Check::new(
            &format!("manufactured/{}/finest_{}", scenario.name, quantity.name),
            &format!(
                "{}, ν = {}: mean {} error at {} nodes per edge",
                scenario.words,
                scenario.poisson_ratio,
                words(quantity),
                finest.nodes_per_edge
            ),
            kind,
            at_size(finest, quantity.of).0,
            Bound::AtMost(most),
            "1",
            &source,
        ));
    }
}

fn words(quantity: &Quantity) -> &'static str {
    match quantity.name {
        "pressure_deviation" => "pressure less its mean",
        name => name,
    }
}

/// Errors and orders of all scenarios, mean and standard deviation over clouds.
pub fn table(ladders: &[(Scenario, Vec<Rung>)]) -> Table {
    let mut rows = Vec::new();
    for (scenario, rungs) in ladders {
        let row = |size: String, value: &dyn Fn(&Quantity) -> (f64, f64), volume: Cell| {
            let mut row = vec![
                Cell::Text(scenario.words.into()),
                Cell::Number(scenario.poisson_ratio),
                Cell::Text(size),
            ];
            for quantity in &QUANTITIES {
                let (mean, deviation) = value(quantity);
                row.extend([Cell::Number(mean), Cell::Number(deviation)]);
            }
            row.push(volume);
            row
        };
        for rung in rungs {
            let size = format!("{} nodes per edge", rung.nodes_per_edge);
            let volume = at_size(rung, |e| e.volume.abs()).0;
            rows.push(row(size, &|quantity| at_size(rung, quantity.of), Cell::Number(volume)));
        }
        // The slopes between neighbours show how the fit bends; nothing is judged by them.
        let all = 0..rungs.len();
        let neighbours = (1..rungs.len()).map(|last| last - 1..last + 1);
        for fitted in std::iter::once(all).chain(neighbours) {
            let rungs = &rungs[fitted];
            let [first, last] =
                [&rungs[0], &rungs[rungs.len() - 1]].map(|rung| rung.nodes_per_edge);
            let slope = |quantity: &Quantity| {
                order(rungs, quantity.of).map_or((f64::NAN, f64::NAN), |o| (o.mean, o.deviation))
            };
            rows.push(row(format!("order, {first} to {last}"), &slope, Cell::Text("".into())));
        }
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
            number("pressure less its mean", "1"),
            number("±", "1"),
            number("gain of volume", "1"),
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
                name: format!("{}, {}", scenario.words, words(quantity)),
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
