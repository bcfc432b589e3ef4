//! Work counters of bundled cases, which do not depend on the machine.

use crate::studies::workbench::Workbench;
use mtled_checks::study::{Cell, Study, Table, number, text};
use mtled_run::run::{Work, solve_case};
use rayon::prelude::*;

/// Statics, a plane, free flight under gravity, contact.
const CASES: [&str; 5] =
    ["brain_slice", "cube_compression", "uniaxial_bar", "falling_beam", "cook_membrane"];

/// Counters of one case.
struct Counters {
    case: &'static str,
    points: usize,
    neighbours: usize,
    work: Work,
}

/// Compares the counters of the cases with the stored ones.
pub(crate) fn work(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    let count = |case: &&'static str| -> anyhow::Result<Counters> {
        let (solved, _) = solve_case(&bench.unvaried_case(case)?)?;
        let supports = &solved.simulation.discretisation.supports;
        let (points, neighbours) = (supports.len(), supports.nodes.len());
        Ok(Counters { case, points, neighbours, work: Work::of(&solved) })
    };
    let counters: anyhow::Result<Vec<Counters>> = CASES.par_iter().map(count).collect();
    let counters = counters?;
    counters.iter().for_each(|counters| add_checks(bench, study, counters));
    study.tables.push(table(&counters));
    Ok(())
}

fn add_checks(bench: &Workbench, study: &mut Study, counters: &Counters) {
    let Counters { case, points, neighbours, work } = counters;
    let bytes = work.bytes_streamed as f64 / work.neighbour_visits as f64;
    for (quantity, label, value) in [
        ("points", "quadrature points", *points as f64),
        ("neighbours", "support entries", *neighbours as f64),
        ("evaluations", "evaluations of the internal force", work.force_evaluations as f64),
        ("correction", "iterations for the gradients", work.correction_iterations as f64),
        ("bytes", "bytes read per neighbour", bytes),
    ] {
        let (id, label) = (format!("work/{case}/{quantity}"), format!("{case}: {label}"));
        study.checks.push(bench.regression(&id, &label, value, "1", ""));
    }
}

fn table(counters: &[Counters]) -> Table {
    let counts = [
        "points",
        "neighbours",
        "steps",
        "evaluations of the internal force",
        "for the critical step",
        "iterations for the gradients",
        "points visited",
        "neighbours visited",
        "bytes read",
    ];
    let row = |counters: &Counters| {
        let work = &counters.work;
        let numbers = [
            counters.points,
            counters.neighbours,
            work.steps,
            work.force_evaluations,
            work.lanczos_evaluations,
            work.correction_iterations,
            work.point_evaluations,
            work.neighbour_visits,
            work.bytes_streamed,
        ];
        let mut cells = vec![Cell::Text(counters.case.into())];
        cells.extend(numbers.map(|count| Cell::Number(count as f64)));
        cells
    };
    let mut columns = vec![text("case")];
    columns.extend(counts.map(|name| number(name, "1")));
    Table {
        title: "Work of bundled cases".into(),
        columns,
        rows: counters.iter().map(row).collect(),
    }
}
