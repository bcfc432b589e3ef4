//! Published benchmarks: Cook's membrane and the flag of Turek and Hron.

use crate::exact::{Published, cook, turek_hron};
use crate::studies::workbench::{Workbench, relative_error};
use anyhow::{Context, Result};
use mtled_case::scene::Case;
use mtled_checks::study::{
    Bound, Cell, Check, Figure, Kind, Plot, Study, Table, axis, line, number, text,
};
use mtled_run::run::{Recording, Solved, Work, solve_case};
use mtled_run::specimens::spacing::respaced;
use rayon::prelude::*;

/// Bound on the tips \[–\].
const BOUND: f64 = 0.02;
/// The same of an undamped oscillation on a coarse cloud.
const BOUND_DYNAMIC: f64 = 0.04;

pub(crate) fn benchmarks(bench: &Workbench, study: &mut Study) -> Result<()> {
    let mut rows = Vec::new();
    let finer = bench.pick(vec![0.004, 0.002], vec![0.004, 0.002, 0.001]);
    tip(bench, study, &mut rows, "cook_membrane", &finer, cook::TIP)?;
    let finer = bench.pick(vec![0.005, 0.0025], vec![0.005, 0.0025, 0.00125]);
    tip(bench, study, &mut rows, "turek_hron_csm1", &finer, turek_hron::CSM1[1])?;
    study.tables.push(Table {
        title: "Vertical displacement of the probe".into(),
        columns: vec![
            text("case"),
            number("spacing", "m"),
            number("nodes", ""),
            number("points", ""),
            number("steps", ""),
            number("computed", "m"),
            number("published", "m"),
            number("relative difference", "1"),
            number("neighbour visits", ""),
        ],
        rows,
    });
    swing(&bench.case("turek_hron_csm3")?, study, bench.pick(0.0033333, 0.0025))
}

/// The tip of a static case at several spacings; the finest is checked.
fn tip(
    bench: &Workbench,
    study: &mut Study,
    rows: &mut Vec<Vec<Cell>>,
    name: &str,
    spacings: &[f64],
    published: Published,
) -> Result<()> {
    let case = bench.case(name)?;
    for (spacing, solved, record) in solve_levels(&case, spacings)? {
        let computed = record.samples.last().context("the record is empty")?.displacements[0][0].y;
        let difference = relative_error(computed, published.value);
        rows.push(vec![
            Cell::Text(name.into()),
            Cell::Number(spacing),
            Cell::Number(solved.simulation.discretisation.cloud.positions.len() as f64),
            Cell::Number(solved.simulation.discretisation.supports.len() as f64),
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

/// A case solved at several spacings \[m\] in parallel.
fn solve_levels(case: &Case, spacings: &[f64]) -> Result<Vec<(f64, Solved, Recording)>> {
    let solve = |&spacing: &f64| {
        let (solved, record) = solve_case(&respaced(case, spacing)?)?;
        Ok((spacing, solved, record))
    };
    spacings.par_iter().map(solve).collect()
}

/// The undamped oscillation of CSM3: mean and amplitude of the tip.
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
        x: axis("time", "s", false),
        y: axis("u_y of the tip", "m", false),
        series: vec![line(&format!("spacing {spacing} m"), history)],
        slopes: Vec::new(),
    }));
    Ok(())
}

fn tip_history(record: &Recording) -> Vec<(f64, f64)> {
    record.samples.iter().map(|sample| (sample.time, sample.displacements[0][0].y)).collect()
}
