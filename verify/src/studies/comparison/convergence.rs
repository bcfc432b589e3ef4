//! How the error falls with node spacing and with grid density.

use crate::exact::{cook, torsion, turek_hron};
use crate::run::{Work, solve_case};
use crate::scene::Case;
use crate::studies::workbench::{Workbench, relative_error, respaced, spacing_of};
use anyhow::{Context, Result};
use mtled::problem::Prescribed;
use mtled_checks::measure::log_log_fit;
use mtled_checks::study::{
    Axis, Bound, Cell, Check, Column, Figure, Kind, Plot, Series, SeriesStyle, Study, Table,
};
use rayon::prelude::*;

/// A case with a truth and the uncertainty below which no order is claimed.
struct Ladder {
    case: Case,
    what: &'static str,
    truth: f64,
    /// Relative \[–\].
    floor: f64,
    spacings: Vec<f64>,
}

/// One rung: a recipe and how wrong it is.
struct Rung {
    spacing: f64,
    cells_per_spacing: f64,
    points_per_node: f64,
    error: f64,
    neighbour_visits: f64,
}

pub fn convergence(bench: &Workbench, study: &mut Study) -> Result<()> {
    let ladders = ladders(bench)?;
    let spacing = ladders
        .iter()
        .map(|l| in_spacing(l).map(|rungs| (l, rungs)))
        .collect::<Result<Vec<_>>>()?;
    let density = ladders
        .iter()
        .map(|l| in_density(bench, l).map(|rungs| (l, rungs)))
        .collect::<Result<Vec<_>>>()?;
    for (ladder, rungs) in &spacing {
        judge(study, ladder, rungs);
    }
    let curve = |x: fn(&Rung) -> f64| {
        move |(ladder, rungs): &(&Ladder, Vec<Rung>)| Series {
            name: format!("{}, {}", ladder.case.title, ladder.what),
            points: rungs.iter().map(|rung| (x(rung), rung.error)).collect(),
            error_bars: Vec::new(),
            style: SeriesStyle::LineAndPoints,
        }
    };
    study.figures.push(plot(
        "Error against node spacing",
        "Relative error as cells shrink with the spacing (1.26 cells per spacing). Errors near the \
         uncertainty of a published value say no more.",
        ("node spacing", "m", true),
        spacing.iter().map(curve(|rung| rung.spacing)).collect(),
        vec![1.0, 2.0],
    ));
    study.figures.push(plot(
        "Error against grid density",
        "Relative error as cells shrink at a fixed node spacing: what remains on the right is the \
         error of the nodes.",
        ("cells per spacing", "1", false),
        density.iter().map(curve(|rung| rung.cells_per_spacing)).collect(),
        Vec::new(),
    ));
    study.tables.push(table("Node spacing", &spacing));
    study.tables.push(table("Grid density", &density));
    Ok(())
}

fn ladders(bench: &Workbench) -> Result<Vec<Ladder>> {
    let twisted = bench.case("twisted_cylinder")?;
    let Some(Prescribed::Rotation { angle, .. }) =
        twisted.problem.conditions.last().map(|c| c.prescribed.clone())
    else {
        anyhow::bail!("the case does not turn the cylinder");
    };
    let (min, max) = twisted.problem.body.bounding_box().context("the cylinder has no bounds")?;
    let mu = twisted.problem.regions[0].material.law.constants().shear_modulus;
    let moment = torsion::moment(mu, angle / (max.z - min.z), 0.5 * (max.x - min.x));
    Ok(vec![
        Ladder {
            case: twisted,
            what: "moment",
            truth: moment,
            // ν = 0.49 instead of ½ changes the moment by about this much.
            floor: 1e-3,
            spacings: bench.pick(vec![0.014, 0.01, 0.0075], vec![0.014, 0.01, 0.0075, 0.005]),
        },
        Ladder {
            case: bench.case("cook_membrane")?,
            what: "tip",
            truth: cook::TIP.value,
            floor: cook::TIP.uncertainty / cook::TIP.value,
            spacings: bench.pick(
                vec![0.006, 0.004, 0.0028, 0.002],
                vec![0.008, 0.0056, 0.004, 0.0028, 0.002, 0.0014, 0.001],
            ),
        },
        Ladder {
            case: bench.case("turek_hron_csm1")?,
            what: "tip",
            truth: turek_hron::CSM1[1].value,
            floor: 1e-4,
            spacings: bench.pick(
                vec![0.0066667, 0.005, 0.0033333],
                vec![0.0066667, 0.005, 0.0033333, 0.0025, 0.002],
            ),
        },
    ])
}

fn in_spacing(ladder: &Ladder) -> Result<Vec<Rung>> {
    ladder
        .spacings
        .par_iter()
        .map(|&spacing| rung(ladder, &respaced(&ladder.case, spacing)?))
        .collect()
}

fn in_density(bench: &Workbench, ladder: &Ladder) -> Result<Vec<Rung>> {
    let densities = bench.pick(vec![1.0, 1.26, 1.6, 2.0], vec![1.0, 1.26, 1.6, 2.0, 2.5, 3.0]);
    let spacing = ladder.spacings[ladder.spacings.len() / 2];
    let run = |&density: &f64| {
        let mut case = respaced(&ladder.case, spacing)?;
        case.problem.recipe.grid.cell = spacing / density;
        rung(ladder, &case)
    };
    densities.par_iter().map(run).collect()
}

fn rung(ladder: &Ladder, case: &Case) -> Result<Rung> {
    let (solved, record) = solve_case(case)?;
    let last = record.samples.last().context("nothing was recorded")?;
    let computed = match ladder.what {
        "moment" => last.reactions.last().context("no condition")?.moment.z,
        _ => last.displacements[0][0].y,
    };
    let spacing = spacing_of(&case.problem)?;
    let discretisation = &solved.prepared.discretisation;
    Ok(Rung {
        spacing,
        cells_per_spacing: spacing / case.problem.recipe.grid.cell,
        points_per_node: discretisation.supports.len() as f64
            / discretisation.cloud.positions.len() as f64,
        error: relative_error(computed, ladder.truth),
        neighbour_visits: Work::of(&solved).neighbour_visits as f64,
    })
}

/// The finest spacing must be better than the worst of the others: an error that
/// changes its sign may be small once by luck. Orders are printed.
fn judge(study: &mut Study, ladder: &Ladder, rungs: &[Rung]) {
    let finest = rungs[rungs.len() - 1].error;
    let others = rungs[..rungs.len() - 1].iter().map(|rung| rung.error);
    let worst = others.fold(0.0, f64::max);
    study.checks.push(Check::new(
        &format!("convergence/{}/refinement", ladder.case.name),
        &format!(
            "{}: error at the finest spacing over the largest at the others",
            ladder.case.title
        ),
        Kind::Exact,
        finest / worst,
        Bound::AtMost(1.0),
        "1",
        "a consistent scheme gets better as it is refined",
    ));
    let above: Vec<(f64, f64)> = rungs
        .iter()
        .filter(|rung| rung.error > 3.0 * ladder.floor)
        .map(|rung| (rung.spacing, rung.error))
        .collect();
    study.notes.push(match log_log_fit(&above) {
        Some(fit) if above.len() > 2 => format!(
            "{}: observed order {:.2} ± {:.2} of the {} in the spacing, over {} spacings.",
            ladder.case.title,
            fit.slope,
            fit.standard_deviation,
            ladder.what,
            above.len()
        ),
        _ => format!(
            "{}: no order of the {} is claimed: fewer than three errors above the noise floor.",
            ladder.case.title, ladder.what
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
        x: Axis { label: x.0.into(), unit: x.1.into(), log: x.2 },
        y: Axis { label: "relative error".into(), unit: "1".into(), log: true },
        series,
        slopes,
    })
}

fn table(title: &str, ladders: &[(&Ladder, Vec<Rung>)]) -> Table {
    let column = |name: &str, unit: &str| Column { name: name.into(), unit: unit.into() };
    let mut rows = Vec::new();
    for (ladder, rungs) in ladders {
        for rung in rungs {
            rows.push(vec![
                Cell::Text(format!("{}, {}", ladder.case.title, ladder.what)),
                Cell::Number(rung.spacing),
                Cell::Number(rung.cells_per_spacing),
                Cell::Number(rung.points_per_node),
                Cell::Number(rung.error),
                Cell::Number(rung.neighbour_visits),
            ]);
        }
    }
    Table {
        title: title.into(),
        columns: vec![
            column("case", ""),
            column("spacing", "m"),
            column("cells per spacing", "1"),
            column("points per node", "1"),
            column("relative error", "1"),
            column("neighbour visits", ""),
        ],
        rows,
    }
}
