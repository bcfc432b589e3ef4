//! Cost of the set-up: everything before the first step.

use crate::studies::workbench::{Workbench, exact};
use mtled::discretisation::Discretisation;
use mtled::force::{Workspace, internal_force};
use mtled::model::Model;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::problem::{Amplitude, Dimension, Gradients, Problem};
use mtled_checks::measure::larger;
use mtled_checks::study::{Cell, Figure, Plot, Study, Table, axis, curve, number, text};
use mtled_run::specimens::simple::{
    SIZE, block_shape, bonded_face, free_body, recipe, relaxation, tissue,
};
use std::time::Instant;

/// Wall seconds of each part, and the work of the correction.
struct Costs {
    label: String,
    nodes: usize,
    points: usize,
    iterations: usize,
    residual: f64,
    /// Nodes, quadrature points, supports and MLS.
    approximation: f64,
    correction: f64,
    /// Masses, conditions, loads and blocks.
    model: f64,
    critical: f64,
    /// One evaluation of the internal force.
    step: f64,
}

impl Costs {
    fn set_up(&self) -> f64 {
        self.approximation + self.correction + self.model + self.critical
    }
}

/// Measures the set-up of cubes of several sizes and of bundled cases.
pub(crate) fn set_up(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    let sizes: &[f64] = bench.pick(&[8.0, 16.0], &[8.0, 16.0, 30.0, 45.0]);
    let mut rows = Vec::new();
    for &cells in sizes {
        let mut problem = cube(cells)?;
        bench.reseed(&mut problem);
        rows.push(measure(format!("bonded cube, {cells} spacings per edge"), problem)?);
    }
    for name in ["brain_slice", "cook_membrane", "soft_inclusion", "falling_beam"] {
        let case = bench.case(name)?;
        rows.push(measure(case.title.clone(), case.problem)?);
    }
    add_checks(study, &rows);
    study.tables.push(table(&rows));
    let cubes = &rows[..sizes.len()];
    study.figures.push(Figure::Plot(Plot {
        title: "Iterations of the correction".into(),
        caption: "Bonded cubes, to a tolerance of 1e-3.".into(),
        x: axis("nodes", "1", true),
        y: axis("iterations", "1", false),
        series: vec![curve(
            "iterations",
            cubes.iter().map(|row| (row.nodes as f64, row.iterations as f64)).collect(),
        )],
        slopes: Vec::new(),
    }));
    study.notes.push(
        "Wall times on all threads, each part once, while other studies run: they are shown and \
         not checked. The correction is the time of consistent gradients less that of plain ones, \
         boundary panels included."
            .into(),
    );
    Ok(())
}

fn table(rows: &[Costs]) -> Table {
    let row = |costs: &Costs| {
        let Costs { nodes, points, iterations, approximation, correction, model, .. } = *costs;
        let parts = [approximation, correction, model, costs.critical, costs.set_up()];
        let mut row = vec![Cell::Text(costs.label.clone())];
        row.extend([nodes, points, iterations].map(|count| Cell::Number(count as f64)));
        row.push(Cell::Number(costs.residual));
        row.extend(parts.map(|seconds| Cell::Number(seconds / costs.step)));
        row.push(Cell::Number(correction / approximation));
        row
    };
    Table {
        title: "Set-up in units of one evaluation of the internal force".into(),
        columns: vec![
            text("case"),
            number("nodes", "1"),
            number("points", "1"),
            number("iterations to 1e-3", "1"),
            number("residual", "1"),
            number("nodes, cells and MLS", "1"),
            number("correction and boundary", "1"),
            number("masses, conditions, loads", "1"),
            number("critical step", "1"),
            number("all", "1"),
            number("correction over nodes, cells and MLS", "1"),
        ],
        rows: rows.iter().map(row).collect(),
    }
}

/// A jittered cube between bonded faces, ν = 0.49, with the default tolerance of the gradients.
fn cube(cells: f64) -> anyhow::Result<Problem> {
    let mut recipe = recipe(SIZE / cells, 0.3, 5);
    recipe.gradients = Gradients::Consistent { tolerance: 1e-3 };
    let mut problem = free_body(Dimension::Three, block_shape(), tissue(0.49)?, recipe);
    problem.conditions = vec![
        bonded_face(2, 0.0, 0.0, Amplitude::Constant),
        bonded_face(2, SIZE, -0.2 * SIZE, Amplitude::Smooth { duration: 1.0 }),
    ];
    problem.motion = relaxation(1000, 1e-4);
    Ok(problem)
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = work();
    (result, start.elapsed().as_secs_f64())
}

fn measure(label: String, problem: Problem) -> anyhow::Result<Costs> {
    let mut plain = problem.clone();
    plain.recipe.gradients = Gradients::Plain;
    let (_, approximation) = timed(|| Discretisation::new(&plain));
    let (discretisation, both) = timed(|| Discretisation::new(&problem));
    let discretisation = discretisation?;
    let (model, model_seconds) = timed(|| Model::new(&problem, &discretisation));
    let model = model?;
    let mut workspace = Workspace::new(&model.points);
    let u = vec![0.0; model.size()];
    let (_, critical) = timed(|| critical_time_step(&model, &u, 0.0, None, &mut workspace));
    let mut f = u.clone();
    let mut steps: Vec<f64> = (0..9)
        .map(|_| timed(|| internal_force(&model.points, &u, &mut workspace, &mut f)).1)
        .collect();
    steps.sort_by(f64::total_cmp);
    let correction = discretisation
        .correction
        .ok_or_else(|| anyhow::anyhow!("{label}: the gradients are not made consistent"))?;
    Ok(Costs {
        nodes: model.positions.len(),
        points: model.point_positions.len(),
        iterations: correction.iterations,
        residual: correction.residual,
        approximation,
        correction: (both - approximation).max(0.0),
        model: model_seconds,
        critical,
        step: steps[4],
        label,
    })
}

fn add_checks(study: &mut Study, rows: &[Costs]) {
    let most = rows.iter().map(|row| row.iterations).max().unwrap_or(usize::MAX);
    study.checks.push(exact(
        "set_up/iterations",
        "iterations of the correction to 1e-3, most of all cases",
        most as f64,
        20.0,
        "a multilevel preconditioner makes them independent of the number of nodes",
    ));
    study.checks.push(exact(
        "set_up/residual",
        "remaining defect of the divergence theorem, largest of all cases",
        rows.iter().map(|row| row.residual).fold(0.0, larger),
        1e-3,
        "the requested tolerance",
    ));
}
