//! Histories as plots.

use crate::run::record::{Recording, Sample};
use mtled::problem::Motion;
use mtled_case::scene::{Case, ProbeKind};
use mtled_checks::study::{Axis, Figure, Plot, Series, axis, line};

/// Fewer samples than this are no history.
const FEWEST: usize = 3;
/// The most curves of a plot.
const MOST_CURVES: usize = 8;

/// Displacements of probes, forces and energies over the run; nothing where it has too few
/// samples.
pub(crate) fn histories(case: &Case, record: &Recording) -> Vec<Figure> {
    if record.samples.len() < FEWEST {
        return Vec::new();
    }
    let (x, end) = match case.problem.motion {
        Motion::Dynamic { .. } => (axis("time", "s", false), 1.0),
        _ => (axis("part of the load", "1", false), case.problem.motion.end()),
    };
    let curve = |name: &str, value: &dyn Fn(&Sample) -> f64| -> Series {
        let samples = record.samples.iter();
        line(name, samples.map(|sample| (sample.time / end, value(sample))).collect())
    };
    let single =
        case.probes.iter().enumerate().filter(|(probe, _)| record.references[*probe].len() == 1);
    let probes = single.map(|(number, probe)| {
        let name = match probe.kind {
            ProbeKind::CentreOfMass { .. } => format!("{} (centre)", probe.name),
            _ => probe.name.clone(),
        };
        curve(&name, &|sample: &Sample| sample.displacements[number][0].norm())
    });
    let conditions = case.problem.conditions.iter().enumerate().map(|(number, condition)| {
        curve(&condition.name, &|sample: &Sample| sample.reactions[number].force.norm())
    });
    let obstacles = case.problem.obstacles.iter().enumerate().map(|(number, obstacle)| {
        curve(&obstacle.name, &|sample: &Sample| sample.contact_forces[number].norm())
    });
    let energies = [
        curve("strain", &|sample: &Sample| sample.energies.strain),
        curve("kinetic", &|sample: &Sample| sample.energies.kinetic),
        curve("external work", &|sample: &Sample| sample.energies.external_work),
        curve("work of conditions", &|sample: &Sample| sample.energies.constraint_work),
        curve("kept in contact", &|sample: &Sample| sample.energies.contact_energy),
    ];
    let moves = |series: &Series| series.points.iter().any(|(_, y)| *y != 0.0);
    let plots = [
        ("Displacement of probes", "size of the displacement", "m", probes.collect::<Vec<_>>()),
        ("Forces", "size of the force", "N", conditions.chain(obstacles).collect()),
        ("Energies", "energy", "J", energies.into_iter().filter(moves).collect()),
    ];
    let drawn = plots.into_iter().filter(|(.., series)| !series.is_empty());
    drawn
        .map(|(title, label, unit, series)| plot(title, &x, axis(label, unit, false), series))
        .collect()
}

fn plot(title: &str, x: &Axis, y: Axis, mut series: Vec<Series>) -> Figure {
    let caption = match series.len() {
        0..=MOST_CURVES => String::new(),
        all => format!("The first {MOST_CURVES} of {all}; all of them are in history.csv."),
    };
    series.truncate(MOST_CURVES);
    Figure::Plot(Plot { title: title.into(), caption, x: x.clone(), y, series, slopes: Vec::new() })
}
