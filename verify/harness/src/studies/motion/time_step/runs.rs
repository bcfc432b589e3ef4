//! The time step of runs against the stability limit of the deforming body.

use crate::studies::workbench::{Workbench, range};
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::force::Workspace;
use mtled::model::Model;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::motion::observe::{Continue, Observer, View};
use mtled::problem::{
    Amplitude, Dimension, EssentialCondition, Motion, Prescribed, Problem, Relaxation,
};
use mtled_checks::study::{Bound, Cell, Figure, Plot, Study, Table, axis, line, number, text};
use mtled_run::specimens::simple::{
    SIZE, block_shape, bonded_face, free_body, recipe, relaxation, tissue,
};
use rayon::prelude::*;

/// Steps between two comparisons with the limit.
const SAMPLE_EVERY: usize = 20;

/// Records the step over the limit, which is computed anew from a random start.
struct Limits {
    workspace: Workspace,
    /// (progress of the run \[–\], step over limit, limit \[s\])
    samples: Vec<(f64, f64, f64)>,
}

impl Limits {
    fn new(model: &Model) -> Limits {
        Limits { workspace: Workspace::new(&model.points), samples: Vec::new() }
    }
}

impl Observer for Limits {
    fn observe(&mut self, view: &mut View) -> Continue {
        let state = view.state;
        if state.step > 0 && state.step.is_multiple_of(SAMPLE_EVERY) {
            let (u, t) = (&state.displacement, state.time);
            let limit = critical_time_step(view.model, u, t, None, &mut self.workspace).time_step;
            self.samples.push((view.progress, state.time_step / limit, limit));
        }
        Continue::Yes
    }
}

/// One run and its samples.
struct SampledRun {
    id: &'static str,
    label: &'static str,
    steps: usize,
    /// Evaluations of the internal force for critical steps over steps \[–\].
    cost: f64,
    samples: Vec<(f64, f64, f64)>,
}

/// Checks the step of every run and the cost of its control.
pub(crate) fn runs(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    let problems = problems(bench)?;
    let runs: anyhow::Result<Vec<SampledRun>> = problems
        .into_par_iter()
        .map(|(id, label, problem)| {
            run(id, label, &problem).map_err(|error| error.context(format!("run \"{label}\"")))
        })
        .collect();
    let runs = runs?;
    for run in &runs {
        add_checks(bench, study, run);
    }
    study.tables.push(Table {
        title: "Steps of runs over the limit of the deformed body".into(),
        columns: vec![
            text("run"),
            number("steps", "1"),
            number("smallest limit over the first", "1"),
            number("step over limit, least", "1"),
            number("step over limit, most", "1"),
            number("evaluations for the step, over steps", "1"),
        ],
        rows: runs.iter().map(row).collect(),
    });
    let curve = |run: &SampledRun| {
        line(run.label, run.samples.iter().map(|(at, ratio, _)| (*at, *ratio)).collect())
    };
    study.figures.push(Figure::Plot(Plot {
        title: "Step over the limit during runs".into(),
        caption: "The limit is computed anew every 20 steps. Above 1 a run diverges.".into(),
        x: axis("progress of the run", "1", false),
        y: axis("step over limit", "1", false),
        series: runs.iter().map(curve).collect(),
        slopes: Vec::new(),
    }));
    Ok(())
}

fn run(id: &'static str, label: &'static str, problem: &Problem) -> anyhow::Result<SampledRun> {
    let mut simulation = Simulation::with_any_recipe(problem)?;
    let mut limits = Limits::new(&simulation.model);
    let summary = simulation.run(&mut limits)?;
    // The first Lanczos run belongs to the set-up.
    let fresh = vec![0.0; simulation.model.size()];
    let mut workspace = Workspace::new(&simulation.model.points);
    let first =
        critical_time_step(&simulation.model, &fresh, 0.0, None, &mut workspace).products + 1;
    let cost = (summary.lanczos_evaluations - first) as f64 / summary.steps as f64;
    Ok(SampledRun { id, label, steps: summary.steps, cost, samples: limits.samples })
}

fn problems(bench: &Workbench) -> anyhow::Result<Vec<(&'static str, &'static str, Problem)>> {
    let spacing = SIZE / bench.pick(5.0, 8.0);
    let block = |poisson_ratio: f64, fraction: f64| -> anyhow::Result<Problem> {
        let recipe = recipe(spacing, 0.3, 5);
        let mut problem =
            free_body(Dimension::Three, block_shape(), tissue(poisson_ratio)?, recipe);
        let smooth = Amplitude::Smooth { duration: 1.0 };
        problem.conditions = vec![
            bonded_face(2, 0.0, 0.0, Amplitude::Constant),
            bonded_face(2, SIZE, fraction * SIZE, smooth),
        ];
        problem.motion = relaxation(2000, 1e-4);
        Ok(problem)
    };
    let mut twisted = block(0.49, 0.0)?;
    twisted.conditions[1] = EssentialCondition {
        prescribed: Prescribed::Rotation {
            point: Vector3::new(0.5 * SIZE, 0.5 * SIZE, SIZE),
            axis: Vector3::z(),
            angle: std::f64::consts::FRAC_PI_2,
        },
        ..twisted.conditions[1].clone()
    };
    let mut indented = bench.case("indented_block")?.problem;
    indented.motion = Motion::Relaxed(Relaxation::default());
    let mut all = vec![
        ("compressed", "compressed by 50 %, ν = 0.3", block(0.3, -0.5)?),
        ("stretched", "stretched by 70 %, ν = 0.49", block(0.49, 0.7)?),
        ("twisted", "twisted by 90°, ν = 0.49", twisted),
        ("indented", "indented block, with contact", indented),
        ("beam", "falling beam, undamped", bench.case("falling_beam")?.problem),
    ];
    all[..3].iter_mut().for_each(|(_, _, problem)| bench.reseed(problem));
    if let Motion::Dynamic { end, .. } = &mut all[4].2.motion {
        *end *= bench.pick(0.25, 1.0);
    }
    Ok(all)
}

fn ratios(run: &SampledRun) -> (f64, f64) {
    range(run.samples.iter().map(|sample| sample.1))
}

fn row(run: &SampledRun) -> Vec<Cell> {
    let (least, most) = ratios(run);
    let limits = || run.samples.iter().map(|sample| sample.2);
    let shrunk = limits().fold(f64::INFINITY, f64::min) / limits().next().unwrap_or(f64::NAN);
    let mut row = vec![Cell::Text(run.label.into())];
    row.extend([run.steps as f64, shrunk, least, most, run.cost].map(Cell::Number));
    row
}

fn add_checks(bench: &Workbench, study: &mut Study, run: &SampledRun) {
    let (_, most) = ratios(run);
    study.checks.push(bench.target(
        &format!("time_step/runs/{}", run.id),
        &format!("largest step over the limit of the deformed body: {}", run.label),
        most,
        Bound::AtMost(1.0),
        "2/√λ_max of the tangent at that instant is the stability limit",
    ));
    study.checks.push(bench.regression(
        &format!("time_step/runs/{}_cost", run.id),
        &format!("evaluations for the critical step over steps: {}", run.label),
        run.cost,
        "1",
        "the target is a twentieth of a run; half the height in 2000 steps, with a limit that falls to \
         0.6, takes more: with rarer evaluations the hard case \"bonded, compressed by 50 %\" fails",
    ));
}
