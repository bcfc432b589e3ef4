//! Tables and figures of the comparison with the references.

use crate::studies::comparison::compared::Compared;
use mtled_checks::study::{Cell, Table, number, text};
use mtled_run::accuracy::{Difference, Group};

/// A row per case and kind of quantity.
pub(crate) fn differences_table(compared: &[Compared]) -> Table {
    let mut rows = Vec::new();
    for case in compared {
        for group in Group::ALL {
            let Some(Difference { rms, max, bar }) = case.of(group) else { continue };
            let nodes = case.solved.simulation.discretisation.cloud.positions.len();
            rows.push(vec![
                Cell::Text(case.case.name.clone()),
                Cell::Number(nodes as f64),
                Cell::Text(group.name().replace('_', " ")),
                Cell::Number(100.0 * rms),
                Cell::Number(100.0 * max),
                Cell::Number(100.0 * bar),
            ]);
        }
    }
    Table {
        title: "Meshless solver less finite-element reference, of the largest value".into(),
        columns: vec![
            text("case"),
            number("nodes", ""),
            text("quantity"),
            number("rms", "%"),
            number("largest", "%"),
            number("reference ±", "%"),
        ],
        rows,
    }
}

/// Table 1 of Horton 2007: centres of mass of the brain slice at the release and at the end.
pub(crate) fn brain_table(brain: &Compared) -> Table {
    let last = brain.file.times_s.len() - 1;
    let nearest = |time: f64| {
        let distance = |index: &usize| (brain.file.times_s[*index] - time).abs();
        (0..=last).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(last)
    };
    let release = brain.case.problem.conditions.iter().find_map(|c| c.release).unwrap_or(0.0);
    let mut rows = Vec::new();
    for instant in [nearest(release), last] {
        for probe in &brain.case.probes {
            rows.extend(centre_rows(brain, &probe.name, instant));
        }
    }
    Table {
        title: "Centres of mass (Horton 2007, table 1), with the reference's error bars".into(),
        columns: vec![
            number("time", "s"),
            text("part"),
            text("direction"),
            number("initial", "mm"),
            number("displaced, solver", "mm"),
            number("displaced, FE", "mm"),
            number("±", "mm"),
            number("difference", "mm"),
            number("difference", "% of displacement"),
            number("reference ±", "% of displacement"),
        ],
        rows,
    }
}

fn centre_rows(brain: &Compared, probe: &str, instant: usize) -> Vec<Vec<Cell>> {
    let index = |name: String| brain.references.iter().position(|r| r.quantity.name == name);
    let (Some(moved), Some(start)) =
        (index(format!("displacement/{probe}")), index(format!("centre/{probe}")))
    else {
        return Vec::new();
    };
    let reference = &brain.references[moved];
    let (fe, bars) = (reference.instant(instant), reference.bars(instant));
    let computed = &brain.computed[moved][3 * instant..];
    let displacement = (fe[0] * fe[0] + fe[1] * fe[1]).sqrt();
    let row = |(axis, name): (usize, &str)| {
        let initial = brain.references[start].values[axis];
        let difference = computed[axis] - fe[axis];
        vec![
            Cell::Number(brain.file.times_s[instant]),
            Cell::Text(probe.into()),
            Cell::Text(name.into()),
            Cell::Number(1e3 * initial),
            Cell::Number(1e3 * (initial + computed[axis])),
            Cell::Number(1e3 * (initial + fe[axis])),
            Cell::Number(1e3 * bars[axis]),
            Cell::Number(1e3 * difference),
            Cell::Number(100.0 * difference.abs() / displacement),
            Cell::Number(100.0 * bars[axis] / displacement),
        ]
    };
    ["x", "y"].into_iter().enumerate().map(row).collect()
}
