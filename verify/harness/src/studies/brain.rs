//! The experiment of Horton 2007: a slice of brain pushed at a craniotomy.
#![allow(non_snake_case)]

use crate::studies::workbench::Workbench;
use anyhow::{Context, Result};
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{LabelField, Shape};
use mtled::problem::{Dimension, Motion};
use mtled_case::scene::Case;
use mtled_checks::study::{
    Bound, Cell, Check, Column, Drawing, Figure, Kind, Layer, LayerStyle, Study, Table, number,
};
use mtled_run::run::{MassCentre, Recorder, Solved, centres_of_mass, integrate};
use mtled_run::specimens::spacing::{respaced, spacing_of};

/// One solution of the slice.
struct SliceRun {
    case: Case,
    solved: Solved,
    /// At the start, at the release and at the end.
    moments: [Moment; 3],
    centres: Vec<MassCentre>,
    energy_drift: f64,
}

/// Nodal parameters \[m\] at one instant.
struct Moment {
    time: f64,
    touching: usize,
    displacement: Vec<f64>,
}

/// Largest difference of two codes in a centre of mass \[m\] (Horton 2007, table 1: ventricles and
/// tumour).
const DIFFERENCE_OF_CODES: f64 = 0.32e-3;

pub(crate) fn brain(bench: &Workbench, study: &mut Study) -> Result<()> {
    let case = bench.case("brain_slice")?;
    let spacing = spacing_of(&case.problem)?;
    let finer = respaced(&case, bench.pick(0.75, 0.5) * spacing)?;
    let smaller_step = with_half_steps(&case);
    let (run, (finer, smaller_step)) =
        rayon::join(|| solve(case), || rayon::join(|| solve(finer), || solve(smaller_step)));
    let (run, finer, smaller_step) = (run?, finer?, smaller_step?);
    check_motion(study, &run);
    check_changes(study, &run, &finer, &smaller_step);
    study.tables.push(centres_table(&run));
    study.tables.push(changes_table(&run, &finer, &smaller_step));
    for (moment, when) in [(1, "at the release"), (2, "at the end")] {
        study.figures.push(Figure::Drawing(drawing(&run, moment, when)?));
    }
    study.leading = study.figures.len();
    let discretisation = &run.solved.simulation.discretisation;
    study.notes.push(format!(
        "{} nodes, {} quadrature points, {} steps of {:.1} µs; damping, push and skull gap are those of \
         the case file. Coordinates are RAS in the frame of the template.",
        discretisation.cloud.positions.len(),
        discretisation.supports.len(),
        run.solved.summary.steps,
        1e6 * run.solved.summary.time_steps.1
    ));
    Ok(())
}

fn with_half_steps(case: &Case) -> Case {
    let mut case = case.clone();
    if let Motion::Dynamic { step, .. } = &mut case.problem.motion {
        step.safety_factor *= 0.5;
    }
    case
}

fn solve(case: Case) -> Result<SliceRun> {
    let simulation = Simulation::with_any_recipe(&case.problem)?;
    let centres = centres_of_mass(&case.problem, &simulation.discretisation);
    // Two frames per second of the case: start, release and end among them.
    let mut recorder = Recorder::new(&case, &simulation, 2)?;
    let solved = integrate(simulation, &mut recorder)?;
    let record = recorder.finish();
    let at = |time: f64| -> Result<Moment> {
        let frame = record
            .frames
            .iter()
            .min_by(|a, b| (a.time - time).abs().total_cmp(&(b.time - time).abs()))
            .context("the record has no frame")?;
        let sample = record
            .samples
            .iter()
            .min_by(|a, b| (a.time - time).abs().total_cmp(&(b.time - time).abs()));
        Ok(Moment {
            time: frame.time,
            touching: sample.map_or(0, |sample| sample.touching),
            displacement: frame.displacement.clone(),
        })
    };
    let release = case.problem.conditions[0].release.context("the push is not released")?;
    let moments = [at(0.0)?, at(release)?, at(solved.summary.time)?];
    let balances: Vec<f64> = record.samples.iter().map(|s| s.energies.balance().abs()).collect();
    let largest =
        record.samples.iter().map(|s| s.energies.strain + s.energies.kinetic).fold(0.0, f64::max);
    let energy_drift = balances.iter().fold(0.0f64, |a, b| a.max(*b)) / largest;
    Ok(SliceRun { case, solved, moments, centres, energy_drift })
}

impl SliceRun {
    fn moved(&self, region: usize, moment: usize) -> Vector3 {
        let d = self.solved.simulation.model.components;
        self.centres[region].displacement(&self.moments[moment].displacement, d)
    }

    /// Displacement of the centre of mass of everything \[m\].
    fn whole(&self, moment: usize) -> Vector3 {
        let total: f64 = self.centres.iter().map(|centre| centre.mass).sum();
        let weighted =
            (0..self.centres.len()).map(|r| self.moved(r, moment) * self.centres[r].mass);
        weighted.sum::<Vector3>() / total
    }

    /// Largest penetration of a boundary node into the skull \[m\].
    fn penetration(&self) -> f64 {
        let model = &self.solved.simulation.model;
        let depth = |moment: &Moment, node: u32| {
            let x = model.contact.place(node, &model.positions, &moment.displacement);
            let gaps = model.contact.all_placed(0.0).map(|(_, skull)| skull.gap(&x));
            -gaps.fold(f64::INFINITY, f64::min)
        };
        let nodes = || model.contact.nodes.iter();
        self.moments.iter().flat_map(|m| nodes().map(move |&n| depth(m, n))).fold(0.0, f64::max)
    }

    /// Largest difference of a region's centre of mass from that of another run \[m\].
    fn difference(&self, other: &SliceRun, moment: usize) -> f64 {
        let regions = 0..self.centres.len();
        regions.map(|r| (self.moved(r, moment) - other.moved(r, moment)).norm()).fold(0.0, f64::max)
    }
}

fn check_motion(study: &mut Study, run: &SliceRun) {
    let mut check = |id: &str, quantity: &str, kind, value, bound, unit: &str, source: &str| {
        let id = format!("brain/{id}");
        study.checks.push(Check::new(&id, quantity, kind, value, bound, unit, source));
    };
    let shift = run.whole(1).norm();
    check(
        "shift",
        "centre of mass of the whole slice: displacement at the release",
        Kind::Reference,
        shift,
        Bound::Between(3.5e-3, 4.5e-3),
        "m",
        "Horton 2007, table 1: 3.9 mm for the brain; the push is chosen to give that",
    );
    check(
        "touching",
        "nodes that touch the skull at the release",
        Kind::Reference,
        run.moments[1].touching as f64,
        Bound::AtLeast(1.0),
        "1",
        "Horton 2007, section 3.4: the far side touches the skull",
    );
    // A node at a curved wall is moved back along the normal there: the remainder is of second
    // order in the penetration of one step.
    check(
        "penetration",
        "largest penetration of a node into the skull",
        Kind::Exact,
        run.penetration(),
        Bound::AtMost(0.1e-3),
        "m",
        "contact is enforced on u(t+Δt); a tenth of a voxel",
    );
    check(
        "jacobian",
        "smallest J at any point and step",
        Kind::Exact,
        run.solved.summary.smallest_jacobian.jacobian,
        Bound::AtLeast(0.0),
        "1",
        "no point inverts",
    );
    check(
        "energy",
        "largest imbalance of energy over the largest energy",
        Kind::Exact,
        run.energy_drift,
        Bound::AtMost(0.02),
        "1",
        "central differences conserve the balance up to O(Δt²)",
    );
}

fn check_changes(study: &mut Study, run: &SliceRun, finer: &SliceRun, smaller_step: &SliceRun) {
    for (id, what, other) in
        [("spacing", "a finer cloud", finer), ("step", "half the time step", smaller_step)]
    {
        for (moment, when) in [(1, "release"), (2, "end")] {
            study.checks.push(Check::new(
                &format!("brain/{id}/{when}"),
                &format!("largest change of a centre of mass with {what}, at the {when}"),
                Kind::Reference,
                run.difference(other, moment),
                Bound::AtMost(DIFFERENCE_OF_CODES),
                "m",
                "Horton 2007, table 1: the two codes differ by up to 0.32 mm",
            ));
        }
    }
}

fn columns(names: &[(&str, &str)]) -> Vec<Column> {
    names.iter().map(|(name, unit)| number(name, unit)).collect()
}

/// Table 1 of Horton 2007 for this slice.
fn centres_table(run: &SliceRun) -> Table {
    let mut rows = Vec::new();
    for (index, region) in run.case.problem.regions.iter().enumerate() {
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            let initial = run.centres[index].reference[axis];
            let at = |moment: usize| Cell::Number(1e3 * (initial + run.moved(index, moment)[axis]));
            rows.push(vec![
                Cell::Text(region.name.clone()),
                Cell::Text(name.into()),
                Cell::Number(1e3 * initial),
                at(1),
                at(2),
                Cell::Number(1e3 * run.moved(index, 1)[axis]),
                Cell::Number(1e3 * run.moved(index, 2)[axis]),
            ]);
        }
    }
    let (release, end) = (run.moments[1].time, run.moments[2].time);
    Table {
        title: "Centres of mass (Horton 2007, table 1)".into(),
        columns: columns(&[
            ("part", ""),
            ("direction", ""),
            ("initial", "mm"),
            (&format!("at {release:.2} s"), "mm"),
            (&format!("at {end:.2} s"), "mm"),
            (&format!("moved at {release:.2} s"), "mm"),
            (&format!("moved at {end:.2} s"), "mm"),
        ]),
        rows,
    }
}

fn changes_table(run: &SliceRun, finer: &SliceRun, smaller_step: &SliceRun) -> Table {
    let row = |name: &str, other: &SliceRun| {
        vec![
            Cell::Text(name.into()),
            Cell::Number(other.solved.simulation.discretisation.cloud.positions.len() as f64),
            Cell::Number(other.solved.summary.steps as f64),
            Cell::Number(1e3 * run.difference(other, 1)),
            Cell::Number(1e3 * run.difference(other, 2)),
        ]
    };
    Table {
        title: "Changes of the centres of mass".into(),
        columns: columns(&[
            ("run", ""),
            ("nodes", ""),
            ("steps", ""),
            ("largest change at the release", "mm"),
            ("largest change at the end", "mm"),
        ]),
        rows: vec![
            row("as stated", run),
            row("finer cloud", finer),
            row("half the step", smaller_step),
        ],
    }
}

/// Outlines at the start and at a moment, with the skull and the pushed nodes.
fn drawing(run: &SliceRun, moment: usize, when: &str) -> Result<Drawing> {
    let Dimension::PlaneStrain { z, .. } = run.case.problem.dimension else {
        anyhow::bail!("the slice is not plane");
    };
    let Shape::Labels(field) = &run.case.problem.body else {
        anyhow::bail!("the slice is not a label map");
    };
    let pixel = field.map().voxel().x;
    let part = |labels: &[u32]| -> Result<Vec<Vec<[f64; 2]>>> {
        let shape = LabelField::section(field.map().clone(), labels, field.smoothing(), z)?;
        Ok(Shape::Labels(std::sync::Arc::new(shape)).outline(z, pixel))
    };
    let parts =
        [("brain", part(&[1, 2, 3])?), ("ventricles", part(&[2])?), ("tumour", part(&[3])?)];
    let skull = &run.solved.simulation.model.contact.obstacles[0];
    let mut layers = vec![Layer {
        name: "skull".into(),
        style: LayerStyle::Outline,
        colour: 7,
        closed: true,
        lines: in_millimetres(&grown(&parts[0].1, &skull.shape, skull.offset, z)),
    }];
    for (colour, (name, lines)) in parts.iter().enumerate() {
        let layer = |moment: &str, style, lines: &[Vec<[f64; 2]>]| Layer {
            name: format!("{name} {moment}"),
            style,
            colour,
            closed: true,
            lines: in_millimetres(lines),
        };
        layers.push(layer("before", LayerStyle::Dashed, lines));
        layers.push(layer(when, LayerStyle::Outline, &displaced(run, lines, moment, z)?));
    }
    layers.push(Layer {
        name: "pushed nodes".into(),
        style: LayerStyle::Dots,
        colour: 3,
        closed: false,
        lines: in_millimetres(&[pushed_nodes(run, moment)]),
    });
    let seconds = run.moments[moment].time;
    Ok(Drawing {
        title: format!("Brain slice before and {when}"),
        caption: format!(
            "Dashed: before. Solid: {when}, t = {seconds:.1} s. Dots: the nodes that were pushed inward at the \
             craniotomy. The skull is rigid, {:.0} mm from the brain.",
            1e3 * skull.offset
        ),
        unit: "mm".into(),
        layers,
        scale: None,
    })
}

/// Positions of the nodes of the craniotomy at a moment \[m\].
fn pushed_nodes(run: &SliceRun, moment: usize) -> Vec<[f64; 2]> {
    let model = &run.solved.simulation.model;
    let u = &run.moments[moment].displacement;
    let sets = model.constraints.active(0.0);
    let rows = sets.first().map_or(&[][..], |set| set.rows.as_slice());
    let position = |node: usize| {
        let X = model.positions[node];
        [X.x + u[model.components * node], X.y + u[model.components * node + 1]]
    };
    rows.iter().map(|row| position(row.node as usize)).collect()
}

/// Outlines displaced by the field of a moment.
fn displaced(
    run: &SliceRun,
    lines: &[Vec<[f64; 2]>],
    moment: usize,
    z: f64,
) -> Result<Vec<Vec<[f64; 2]>>> {
    let simulation = &run.solved.simulation;
    let u = &run.moments[moment].displacement;
    let displace = |line: &Vec<[f64; 2]>| -> Result<Vec<[f64; 2]>> {
        let positions: Vec<Vector3> = line.iter().map(|p| Vector3::new(p[0], p[1], z)).collect();
        let rows = simulation.discretisation.rows_at(&positions)?;
        let moved = positions.iter().enumerate().map(|(i, position)| {
            let x = position + rows.interpolate(i, u, simulation.model.components);
            [x.x, x.y]
        });
        Ok(moved.collect())
    };
    lines.iter().map(displace).collect()
}

/// Outlines moved outward by `offset` \[m\] along the gradient of the distance.
fn grown(lines: &[Vec<[f64; 2]>], shape: &Shape, offset: f64, z: f64) -> Vec<Vec<[f64; 2]>> {
    let push = |p: &[f64; 2]| {
        let normal = shape.gradient(&Vector3::new(p[0], p[1], z));
        [p[0] + offset * normal.x, p[1] + offset * normal.y]
    };
    lines.iter().map(|line| line.iter().map(push).collect()).collect()
}

fn in_millimetres(lines: &[Vec<[f64; 2]>]) -> Vec<Vec<[f64; 2]>> {
    lines.iter().map(|line| line.iter().map(|p| [1e3 * p[0], 1e3 * p[1]]).collect()).collect()
}
