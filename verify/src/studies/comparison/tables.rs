//! Tables and figures of the comparison with the references.

use crate::accuracy::{Difference, Group};
use crate::reference::agreement::rms_of_points;
use crate::reference::{CODES, Family, Mesh};
use crate::studies::comparison::compared::Compared;
use mtled_checks::study::{Cell, Plot, SeriesStyle, Table, axis, number, styled, text};

/// A row per case and kind of quantity.
pub fn differences_table(compared: &[Compared]) -> Table {
    let mut rows = Vec::new();
    for case in compared {
        for group in Group::ALL {
            let Some(Difference { rms, max, bar }) = case.of(group) else { continue };
            let nodes = case.solved.prepared.discretisation.cloud.positions.len();
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
pub fn brain_table(brain: &Compared) -> Table {
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

/// CPU seconds against the error of displacements, all cases.
pub fn cost_figure(compared: &[Compared]) -> Plot {
    let mut series = Vec::new();
    for code in CODES {
        let mut points = Vec::new();
        for case in compared {
            let meshes = case.file.solutions.iter().filter(|s| s.code == code);
            for mesh in meshes.flat_map(|solution| &solution.meshes) {
                points.extend(error_of(case, mesh).map(|error| (mesh.cpu_s, error)));
            }
        }
        let name = format!("{code}, on the machine of the references");
        series.push(styled(&name, points, SeriesStyle::Points));
    }
    let own = |case: &Compared| {
        let difference = case.of(Group::Displacement).or_else(|| case.of(Group::CentreOfMass))?;
        Some((case.cpu, difference.rms))
    };
    let points = compared.iter().filter_map(own).collect();
    series.push(styled("mtled, on this machine", points, SeriesStyle::Points));
    Plot {
        title: "Speed against error".into(),
        caption: "A point per case and mesh: CPU seconds of one thread, set-up included, and rms \
                  difference of the displacements from the reference over its largest \
                  displacement. The finite-element codes ran on another machine; their finest meshes made \
                  the reference."
            .into(),
        x: axis("CPU time", "s", true),
        y: axis("error of the displacement", "1", true),
        series,
        slopes: Vec::new(),
    }
}

/// rms error of all displacements on a mesh, relative to the largest one; none
/// where the mesh differs from the reference by no more than its error bar.
fn error_of(case: &Compared, mesh: &Mesh) -> Option<f64> {
    let (mut differences, mut bars, mut largest) = (Vec::new(), Vec::new(), 0.0f64);
    for reference in &case.references {
        if reference.quantity.family == Family::Displacement {
            let values = mesh.values[&reference.quantity.name].flat();
            differences.extend(values.iter().zip(&reference.values).map(|(a, b)| a - b));
            bars.extend(std::iter::repeat_n(reference.error, values.len() / 3));
            let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            largest = reference.values.chunks(3).map(length).fold(largest, f64::max);
        }
    }
    let error = rms_of_points(&differences, 3) / largest;
    (error > rms_of_points(&bars, 1) / largest).then_some(error)
}
