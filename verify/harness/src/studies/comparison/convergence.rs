//! Convergence in node spacing and in grid density.

use crate::exact::{cook, torsion, turek_hron};
use crate::studies::workbench::{Workbench, exact, relative_error};
use anyhow::{Context, Result};
use mtled::problem::Prescribed;
use mtled_case::scene::Case;
use mtled_checks::measure::log_log_fit;
use mtled_checks::study::{Cell, Figure, Plot, Series, Study, Table, axis, curve, number, text};
use mtled_run::run::{Work, solve_case};
use mtled_run::specimens::spacing::{respaced, spacing_of};
use rayon::prelude::*;

/// A case with a reference value and its uncertainty, below which no order is fitted.
struct RefinementSeries {
    case: Case,
    quantity: &'static str,
    reference: f64,
    /// Relative \[–\].
    floor: f64,
    spacings: Vec<f64>,
}

/// One recipe and its error.
struct Level {
    spacing: f64,
    cells_per_spacing: f64,
    points_per_node: f64,
    error: f64,
    neighbour_visits: f64,
}

pub(crate) fn convergence(bench: &Workbench, study: &mut Study) -> Result<()> {
    let all = all_series(bench)?;
    let spacing =
        all.iter().map(|l| in_spacing(l).map(|levels| (l, levels))).collect::<Result<Vec<_>>>()?;
    let density = all
        .iter()
        .map(|l| in_density(bench, l).map(|levels| (l, levels)))
        .collect::<Result<Vec<_>>>()?;
    for (series, levels) in &spacing {
        add_checks(study, series, levels);
    }
    let errors = |x: fn(&Level) -> f64| {
        move |(series, levels): &(&RefinementSeries, Vec<Level>)| {
            let points = levels.iter().map(|level| (x(level), level.error)).collect();
            curve(&format!("{}, {}", series.case.title, series.quantity), points)
        }
    };
    study.figures.push(plot(
        "Error against node spacing",
        "Relative error as cells shrink with the spacing (1.26 cells per spacing). Errors near the \
         uncertainty of a published value mean nothing.",
        ("node spacing", "m", true),
        spacing.iter().map(errors(|level| level.spacing)).collect(),
        vec![1.0, 2.0],
    ));
    study.figures.push(plot(
        "Error against grid density",
        "Relative error as cells shrink at a fixed node spacing: what remains on the right is the \
         error of the nodes.",
        ("cells per spacing", "1", false),
        density.iter().map(errors(|level| level.cells_per_spacing)).collect(),
        Vec::new(),
    ));
    study.tables.push(table("Node spacing", &spacing));
    study.tables.push(table("Grid density", &density));
    Ok(())
}

fn all_series(bench: &Workbench) -> Result<Vec<RefinementSeries>> {
    let twisted = bench.case("twisted_cylinder")?;
    let Some(Prescribed::Rotation { angle, .. }) =
        twisted.problem.conditions.last().map(|c| c.prescribed.clone())
    else {
        anyhow::bail!("the case does not rotate the cylinder");
    };
    let (min, max) = twisted.problem.body.bounding_box().context("the cylinder has no bounds")?;
    let mu = twisted.problem.regions[0].material.law.constants().shear_modulus;
    let moment = torsion::moment(mu, angle / (max.z - min.z), 0.5 * (max.x - min.x));
    Ok(vec![
        RefinementSeries {
            case: twisted,
            quantity: "moment",
            reference: moment,
            // ν = 0.49 instead of ½ changes the moment by about this much.
            floor: 1e-3,
            spacings: bench.pick(vec![0.014, 0.01, 0.0075], vec![0.014, 0.01, 0.0075, 0.005]),
        },
        RefinementSeries {
            case: bench.case("cook_membrane")?,
            quantity: "tip",
            reference: cook::TIP.value,
            floor: cook::TIP.uncertainty / cook::TIP.value,
            spacings: bench.pick(
                vec![0.006, 0.004, 0.0028, 0.002],
                vec![0.008, 0.0056, 0.004, 0.0028, 0.002, 0.0014, 0.001],
            ),
        },
        RefinementSeries {
            case: bench.case("turek_hron_csm1")?,
            quantity: "tip",
            reference: turek_hron::CSM1[1].value,
            floor: 1e-4,
            spacings: bench.pick(
                vec![0.0066667, 0.005, 0.0033333],
                vec![0.0066667, 0.005, 0.0033333, 0.0025, 0.002],
            ),
        },
    ])
}

fn in_spacing(series: &RefinementSeries) -> Result<Vec<Level>> {
    series
        .spacings
        .par_iter()
        .map(|&spacing| level(series, &respaced(&series.case, spacing)?))
        .collect()
}

fn in_density(bench: &Workbench, series: &RefinementSeries) -> Result<Vec<Level>> {
    let densities = bench.pick(vec![1.0, 1.26, 1.6, 2.0], vec![1.0, 1.26, 1.6, 2.0, 2.5, 3.0]);
    let spacing = series.spacings[series.spacings.len() / 2];
    let run = |&density: &f64| {
        let mut case = respaced(&series.case, spacing)?;
        case.problem.recipe.grid.cell = spacing / density;
        level(series, &case)
    };
    densities.par_iter().map(run).collect()
}

fn level(series: &RefinementSeries, case: &Case) -> Result<Level> {
    let (solved, record) = solve_case(case)?;
    let last = record.samples.last().context("the record is empty")?;
    let computed = match series.quantity {
        "moment" => last.reactions.last().context("no condition")?.moment.z,
        _ => last.displacements[0][0].y,
    };
    let spacing = spacing_of(&case.problem)?;
    let discretisation = &solved.simulation.discretisation;
    Ok(Level {
        spacing,
        cells_per_spacing: spacing / case.problem.recipe.grid.cell,
        points_per_node: discretisation.supports.len() as f64
            / discretisation.cloud.positions.len() as f64,
        error: relative_error(computed, series.reference),
        neighbour_visits: Work::of(&solved).neighbour_visits as f64,
    })
}

/// The error at the finest spacing must be below the largest of the others: an error that changes
/// its sign may be small once by chance. Orders are printed.
fn add_checks(study: &mut Study, series: &RefinementSeries, levels: &[Level]) {
    let finest = levels[levels.len() - 1].error;
    let others = levels[..levels.len() - 1].iter().map(|level| level.error);
    let worst = others.fold(0.0, f64::max);
    study.checks.push(exact(
        &format!("convergence/{}/refinement", series.case.name),
        &format!(
            "{}: error at the finest spacing over the largest at the others",
            series.case.title
        ),
        finest / worst,
        1.0,
        "the error of a consistent scheme falls with refinement",
    ));
    let above: Vec<(f64, f64)> = levels
        .iter()
        .filter(|level| level.error > 3.0 * series.floor)
        .map(|level| (level.spacing, level.error))
        .collect();
    study.notes.push(match log_log_fit(&above) {
        Some(fit) if above.len() > 2 => format!(
            "{}: observed order {:.2} ± {:.2} of the {} in the spacing, over {} spacings.",
            series.case.title,
            fit.slope,
            fit.standard_deviation,
            series.quantity,
            above.len()
        ),
        _ => format!(
            "{}: no order of the {} is fitted: fewer than three errors above the noise floor.",
            series.case.title, series.quantity
        ),
    });
}

fn plot(
    title: &str,
    caption: &str,
    x: (&str, &str, bool),
    series: Vec<Series>,
    slopes: Vec<f64>,
) -> Figure {
    Figure::Plot(Plot {
        title: title.into(),
        caption: caption.into(),
        x: axis(x.0, x.1, x.2),
        y: axis("relative error", "1", true),
        series,
        slopes,
    })
}

fn table(title: &str, all: &[(&RefinementSeries, Vec<Level>)]) -> Table {
    let mut rows = Vec::new();
    for (series, levels) in all {
        for level in levels {
            rows.push(vec![
                Cell::Text(format!("{}, {}", series.case.title, series.quantity)),
                Cell::Number(level.spacing),
                Cell::Number(level.cells_per_spacing),
                Cell::Number(level.points_per_node),
                Cell::Number(level.error),
                Cell::Number(level.neighbour_visits),
            ]);
        }
    }
    Table {
        title: title.into(),
        columns: vec![
            text("case"),
            number("spacing", "m"),
            number("cells per spacing", "1"),
            number("points per node", "1"),
            number("relative error", "1"),
            number("neighbour visits", ""),
        ],
        rows,
    }
}
