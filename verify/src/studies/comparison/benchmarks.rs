//! Published benchmarks: Cook's membrane and the flag of Turek and Hron.

use crate::exact::{Published, cook, turek_hron};
use crate::run::{Record, Work, solve_case};
use crate::scene::Case;
use crate::studies::workbench::{Workbench, relative_error, respaced, solve_ladder};
use anyhow::{Context, Result};
use mtled_checks::study::{
    Axis, Bound, Cell, Check, Column, Figure, Kind, Plot, Series, SeriesStyle, Study, Table,
};

/// The bound on the tips \[–\].
const BOUND: f64 = 0.02;
/// The time step of an undamped oscillation and a coarse cloud cost more.
const BOUND_DYNAMIC: f64 = 0.04;

pub fn benchmarks(bench: &Workbench, study: &mut Study) -> Result<()> {
    let mut rows = Vec::new();
    let finer = bench.pick(vec![0.004, 0.002], vec![0.004, 0.002, 0.001]);
    tip(bench, study, &mut rows, "cook_membrane", &finer, cook::TIP)?;
    let finer = bench.pick(vec![0.005, 0.0025], vec![0.005, 0.0025, 0.00125]);
    tip(bench, study, &mut rows, "turek_hron_csm1", &finer, turek_hron::CSM1[1])?;
    let column = |name: &str, unit: &str| Column { name: name.into(), unit: unit.into() };
    study.tables.push(Table {
        title: "Vertical displacement of the probe".into(),
        columns: vec![
            column("case", ""),
            column("spacing", "m"),
            column("nodes", ""),
            column("points", ""),
            column("steps", ""),
            column("computed", "m"),
            column("published", "m"),
            column("relative difference", "1"),
            column("neighbour visits", ""),
        ],
        rows,
    });
    swing(&bench.case("turek_hron_csm3")?, study, bench.pick(0.0033333, 0.0025))
}

/// The tip of a static case over a ladder of spacings; the finest is gated.
fn tip(
    bench: &Workbench,
    study: &mut Study,
    rows: &mut Vec<Vec<Cell>>,
    name: &str,
    spacings: &[f64],
    published: Published,
) -> Result<()> {
    let case = bench.case(name)?;
    for (spacing, solved, record) in solve_ladder(&case, spacings)? {
        let computed = record.samples.last().context("nothing was recorded")?.displacements[0][0].y;
        let difference = relative_error(computed, published.value);
        rows.push(vec![
            Cell::Text(name.into()),
            Cell::Number(spacing),
            Cell::Number(solved.prepared.discretisation.cloud.positions.len() as f64),
            Cell::Number(solved.prepared.discretisation.supports.len() as f64),
            Cell::Number(solved.summary.steps as f64),
            Cell::Number(computed),
            Cell::Number(published.value),
            Cell::Number(difference),
            Cell::Number(Work::of(&solved).neighbour_visits as f64),
        ]);
        if Some(&spacing) == spacings.last() {
            study.checks.push(Check::new(
                &format!("benchmarks/{name}/tip"),
                &format!("{}: tip at spacing {spacing} m, relative difference", case.title),
                Kind::Reference,
                difference,
                Bound::AtMost(BOUND),
                "1",
                published.source,
            ));
        }
    }
    Ok(())
}

/// The undamped swing of CSM3: mean and amplitude of the tip.
fn swing(case: &Case, study: &mut Study, spacing: f64) -> Result<()> {
    let (_, record) = solve_case(&respaced(case, spacing)?)?;
    let history = tip_history(&record);
    let low = history.iter().map(|(_, y)| *y).fold(f64::INFINITY, f64::min);
    let high = history.iter().map(|(_, y)| *y).fold(f64::NEG_INFINITY, f64::max);
    for (what, computed, published) in [
        ("mean", 0.5 * (low + high), turek_hron::CSM3_MEAN),
        ("amplitude", 0.5 * (high - low), turek_hron::CSM3_AMPLITUDE),
    ] {
        study.checks.push(Check::new(
            &format!("benchmarks/turek_hron_csm3/{what}"),
            &format!(
                "{}: {what} of the tip at spacing {spacing} m, relative difference",
                case.title
            ),
            Kind::Reference,
            relative_error(computed, published.value),
            Bound::AtMost(BOUND_DYNAMIC),
            "1",
            published.source,
        ));
    }
    study.figures.push(Figure::Plot(Plot {
        title: "Turek–Hron CSM3".into(),
        caption: format!(
            "Vertical displacement of the tip, from {low:.4} m to {high:.4} m; published: \
             −0.0636 ± 0.0652 m."
        ),
        x: Axis { label: "time".into(), unit: "s".into(), log: false },
        y: Axis { label: "u_y of the tip".into(), unit: "m".into(), log: false },
        series: vec![Series {
            name: format!("spacing {spacing} m"),
            points: history,
            error_bars: Vec::new(),
            style: SeriesStyle::Line,
        }],
        slopes: Vec::new(),
    }));
    Ok(())
}

fn tip_history(record: &Record) -> Vec<(f64, f64)> {
    record.samples.iter().map(|sample| (sample.time, sample.displacements[0][0].y)).collect()
}
