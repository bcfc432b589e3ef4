//! Dynamic relaxation against Newton's method on the same discretisation: their difference is the
//! error of the relaxation, without that of the discretisation.
#![allow(non_snake_case)]

use crate::studies::workbench::{Workbench, exact};
use anyhow::{Context, Result, bail};
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::force::{Workspace, stiffness_times};
use mtled::motion::observe::{Continue, Observer, Unobserved, View};
use mtled::problem::{Cloud, Motion, Newton, Problem, Relaxation, RelaxationMass};
use mtled_case::scene::Case;
use mtled_checks::study::{Cell, Figure, Plot, Study, Table, axis, line, number, text};
use mtled_run::run::{Solved, Work, integrate};
use mtled_run::specimens::spacing::{respaced, spacing_of};
use rayon::prelude::*;

/// Names of cases with their labels.
const CASES: [(&str, &str); 6] = [
    ("bonded_block", "cube, ν = 0.49, compressed by 20 %"),
    ("soft_inclusion", "inclusion ten times softer, graded"),
    ("indented_block", "indented block, graded"),
    ("twisted_cylinder", "cylinder twisted by 45°"),
    ("sphere_gravity", "sphere under its weight"),
    ("cook_membrane", "Cook's membrane"),
];
/// Requested relative error of relaxation \[–\].
const TOLERANCE: f64 = 1e-5;
/// The same of the default solver: what a case file that leaves it out gets \[–\].
const PRESET: f64 = 1e-4;
/// Requested relative residual of Newton's method \[–\].
const RESIDUAL: f64 = 1e-10;
/// Asymmetry of the tangent by round-off \[–\].
const SYMMETRY: f64 = 1e-12;
/// Errors to which steps are counted, relative to the largest displacement \[–\].
const LEVELS: [f64; 3] = [1e-2, 1e-3, 1e-4];
/// Steps between two samples of the error.
const SAMPLE_EVERY: usize = 10;
/// Steps over which the load is applied: fewer than usual, so that the steps after them dominate.
const LOAD_STEPS: usize = 200;

/// Records the error during relaxation.
struct Trace<'a> {
    exact: &'a [f64],
    /// (step, largest error over the largest displacement)
    history: Vec<(usize, f64)>,
}

impl Observer for Trace<'_> {
    fn observe(&mut self, view: &mut View) -> Continue {
        if view.state.step > 0 && view.state.step.is_multiple_of(SAMPLE_EVERY) {
            let error = difference(&view.state.displacement, self.exact);
            self.history.push((view.state.step, error));
        }
        Continue::Yes
    }
}

/// One case solved four times.
struct Compared {
    name: &'static str,
    label: &'static str,
    newton: Solved,
    /// As a case file that names no solver.
    automatic: Solved,
    /// With masses proportional to the stiffness.
    relaxed: Relaxed,
    lumped: Relaxed,
}

struct Relaxed {
    solved: Solved,
    history: Vec<(usize, f64)>,
}

/// Solves every case by Newton's method and by relaxation with both kinds of masses.
pub(crate) fn statics(bench: &Workbench, study: &mut Study) -> Result<()> {
    let run = |&(name, label): &(&'static str, &'static str)| {
        let case = bench.case(name)?;
        // As stated in the full suite, coarser in the quick one.
        let spacing = spacing_of(&case.problem)? * bench.pick(1.5, 1.0);
        compare(&jittered(bench, respaced(&case, spacing)?), name, label)
            .with_context(|| format!("case \"{name}\""))
    };
    let compared: Vec<Compared> = CASES.par_iter().map(run).collect::<Result<_>>()?;
    compared.iter().for_each(|one| add_checks(study, one));
    let settling = |relaxed: &Relaxed| relaxed.solved.summary.steps - LOAD_STEPS;
    let saved = compared.iter().map(|one| settling(&one.lumped)).sum::<usize>() as f64
        / compared.iter().map(|one| settling(&one.relaxed)).sum::<usize>() as f64;
    study.checks.push(bench.regression(
        "statics/all/saved",
        "steps after loading that relaxation takes with lumped masses over those with masses \
         proportional to the stiffness, all cases",
        saved,
        "1",
        "masses like the diagonal of the stiffness pay",
    ));
    study.tables = vec![steps_table(&compared), newton_table(&compared)];
    study.figures.push(Figure::Plot(error_plot(&compared)));
    study.notes.push(format!(
        "Newton's method solves the equations of the same discretisation to a residual of \
         {RESIDUAL:e}; the error of relaxation is the largest difference of a nodal parameter from \
         it over the largest nodal parameter. Steps are counted to the first sample, every \
         {SAMPLE_EVERY} steps, from which on the error stays below the level. The load takes the first \
         {LOAD_STEPS} steps. Nodes are jittered by 0.3 of the spacing where the case has a lattice."
    ));
    Ok(())
}

/// The case with jittered nodes: regular ones would favour lumped masses.
fn jittered(bench: &Workbench, mut case: Case) -> Case {
    let cloud = &mut case.problem.recipe.cloud;
    if let Cloud::Regular { spacing } | Cloud::Jittered { spacing, .. } = *cloud {
        *cloud = Cloud::Jittered { spacing, jitter: 0.3, seed: bench.seed(1) };
    }
    case
}

fn compare(case: &Case, name: &'static str, label: &'static str) -> Result<Compared> {
    let Some(&settings) = case.problem.motion.relaxation() else { bail!("the case is not static") };
    let motion = Motion::Newton(Newton {
        load_end: settings.load_end,
        tolerance: RESIDUAL,
        ..Newton::default()
    });
    let problem = Problem { motion, ..case.problem.clone() };
    let newton = integrate(Simulation::with_any_recipe(&problem)?, &mut Unobserved)?;
    let preset = Motion::Static(Relaxation { tolerance: PRESET, ..settings });
    let problem = Problem { motion: preset, ..case.problem.clone() };
    let automatic = integrate(Simulation::with_any_recipe(&problem)?, &mut Unobserved)?;
    let relax = |mass| -> Result<Relaxed> {
        let mut settings = settings;
        settings.tolerance = TOLERANCE;
        settings.load_steps = LOAD_STEPS;
        settings.mass = mass;
        let problem = Problem { motion: Motion::Relaxed(settings), ..case.problem.clone() };
        let mut trace = Trace { exact: &newton.simulation.state.displacement, history: Vec::new() };
        let solved = integrate(Simulation::with_any_recipe(&problem)?, &mut trace)?;
        Ok(Relaxed { solved, history: trace.history })
    };
    let (relaxed, lumped) = (relax(RelaxationMass::Stiffness)?, relax(RelaxationMass::Lumped)?);
    Ok(Compared { name, label, newton, automatic, relaxed, lumped })
}

/// Largest difference over the largest entry of `v`.
fn difference(u: &[f64], v: &[f64]) -> f64 {
    let difference = u.iter().zip(v).fold(0.0f64, |a, (u, v)| a.max((u - v).abs()));
    difference / v.iter().fold(0.0f64, |a, v| a.max(v.abs()))
}

/// Largest difference of a reaction force over the largest reaction force.
fn reaction_difference(a: &Solved, b: &Solved) -> f64 {
    let reactions = |solved: &Solved| -> Vec<Vector3> {
        let (model, state) = (&solved.simulation.model, &solved.simulation.state);
        let (forces, factor) = (&state.constraint_forces, state.force_factor);
        let (about, u) = (Vector3::zeros(), &state.displacement);
        let all = model.constraints.reactions(forces, factor, &about, &model.positions, u);
        all.iter().map(|reaction| reaction.force).collect()
    };
    let (a, b) = (reactions(a), reactions(b));
    let difference = a.iter().zip(&b).fold(0.0f64, |most, (a, b)| most.max((a - b).norm()));
    difference / b.iter().fold(0.0f64, |most, b| most.max(b.norm()))
}

/// |v·Kw − w·Kv|/(|v||Kw|) of two irregular directions.
fn asymmetry(solved: &Solved) -> f64 {
    let (model, u) = (&solved.simulation.model, &solved.simulation.state.displacement);
    let irregular = |factor: f64| -> Vec<f64> {
        // Fractional parts of multiples of an irrational number are distributed evenly.
        (1..=u.len()).map(|i| (i as f64 * factor).fract() - 0.5).collect()
    };
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let times = |v: &[f64]| {
        let mut product = vec![0.0; u.len()];
        stiffness_times(&model.points, u, v, &mut Workspace::new(&model.points), &mut product);
        product
    };
    let (v, w) = (irregular(std::f64::consts::SQRT_2), irregular(std::f64::consts::E));
    let (Kv, Kw) = (times(&v), times(&w));
    (dot(&v, &Kw) - dot(&w, &Kv)).abs() / (dot(&v, &v) * dot(&Kw, &Kw)).sqrt()
}

fn add_checks(study: &mut Study, one: &Compared) {
    let u = &one.newton.simulation.state.displacement;
    let error = |relaxed: &Relaxed| difference(&relaxed.solved.simulation.state.displacement, u);
    let automatic = difference(&one.automatic.simulation.state.displacement, u);
    let residual = one.newton.summary.newton.map_or(f64::NAN, |counts| counts.residual);
    let relaxed = one.relaxed.solved.summary.relaxation;
    let tolerance = "the requested tolerance";
    for (quantity, label, value, bound, source) in [
        ("residual", "residual of Newton's method", residual, RESIDUAL, tolerance),
        ("error", "error of relaxation", error(&one.relaxed), TOLERANCE, tolerance),
        ("automatic_error", "error of the default solver", automatic, PRESET, tolerance),
        (
            "lumped_error",
            "error of relaxation with lumped masses",
            error(&one.lumped),
            TOLERANCE,
            tolerance,
        ),
        (
            "relaxed_residual",
            "residual of relaxation",
            relaxed.map_or(f64::NAN, |convergence| convergence.residual),
            10.0 * TOLERANCE,
            "relaxation also requires the residual to be at most ten times its tolerance",
        ),
        (
            "reaction",
            "reactions of relaxation against those of Newton's method",
            reaction_difference(&one.relaxed.solved, &one.newton),
            10.0 * TOLERANCE,
            "one discretisation has one static solution; bound on the residual of relaxation",
        ),
        (
            "symmetry",
            "|v·Kw − w·Kv| over |v||Kw| at the solution, v and w random",
            asymmetry(&one.newton),
            SYMMETRY,
            "K is a second derivative of the strain energy; what remains is round-off",
        ),
    ] {
        let (id, label) =
            (format!("statics/{}/{quantity}", one.name), format!("{label}: {}", one.label));
        study.checks.push(exact(&id, &label, value, bound, source));
    }
}

/// Steps after which the error stays below a level.
fn steps_to(history: &[(usize, f64)], level: f64) -> Cell {
    let above = history.iter().rposition(|&(_, error)| error.is_nan() || error > level);
    match above {
        Some(last) if last + 1 == history.len() => Cell::Text("not reached".into()),
        Some(last) => Cell::Number(history[last + 1].0 as f64),
        None => Cell::Number(0.0),
    }
}

fn steps_table(compared: &[Compared]) -> Table {
    let row = |one: &Compared, relaxed: &Relaxed, mass: &str| {
        let u = &one.newton.simulation.state.displacement;
        let mut row = vec![Cell::Text(one.label.into()), Cell::Text(mass.into())];
        row.extend(LEVELS.map(|level| steps_to(&relaxed.history, level)));
        row.push(Cell::Number(relaxed.solved.summary.steps as f64));
        row.push(Cell::Number(Work::of(&relaxed.solved).force_evaluations as f64));
        row.push(Cell::Number(
            difference(&relaxed.solved.simulation.state.displacement, u) / TOLERANCE,
        ));
        row
    };
    Table {
        title: "Steps of dynamic relaxation to a given error".into(),
        columns: vec![
            text("case"),
            text("mass"),
            number("to 1 %", "1"),
            number("to 0.1 %", "1"),
            number("to 0.01 %", "1"),
            number("in all", "1"),
            number("internal forces", "1"),
            number("error over tolerance", "1"),
        ],
        rows: compared
            .iter()
            .flat_map(|one| {
                [row(one, &one.relaxed, "as the stiffness"), row(one, &one.lumped, "lumped")]
            })
            .collect(),
    }
}

fn newton_table(compared: &[Compared]) -> Table {
    let row = |one: &Compared| {
        let counts = one.newton.summary.newton.unwrap_or_default();
        let relaxed = Work::of(&one.relaxed.solved).force_evaluations as f64;
        vec![
            Cell::Text(one.label.into()),
            Cell::Number(one.newton.simulation.model.positions.len() as f64),
            Cell::Number(counts.increments as f64),
            Cell::Number(counts.iterations as f64),
            Cell::Number(counts.products as f64),
            Cell::Number(counts.evaluations as f64 / relaxed),
            Cell::Number(Work::of(&one.automatic).force_evaluations as f64 / relaxed),
            Cell::Number(counts.residual),
            Cell::Number(reaction_difference(&one.relaxed.solved, &one.newton)),
        ]
    };
    Table {
        title: "Newton's method".into(),
        columns: vec![
            text("case"),
            number("nodes", "1"),
            number("parts of the load", "1"),
            number("corrections", "1"),
            number("products", "1"),
            number("internal forces over relaxation", "1"),
            number("the same by default", "1"),
            number("residual", "1"),
            number("difference of reactions", "1"),
        ],
        rows: compared.iter().map(row).collect(),
    }
}

fn error_plot(compared: &[Compared]) -> Plot {
    let points = |relaxed: &Relaxed| {
        let positive = relaxed.history.iter().filter(|(_, error)| *error > 0.0);
        positive.map(|&(step, error)| (step as f64, error)).collect()
    };
    Plot {
        title: "Error of dynamic relaxation".into(),
        caption: format!(
            "Masses proportional to the stiffness; the load takes the first {LOAD_STEPS} steps."
        ),
        x: axis("step", "1", false),
        y: axis("error over the largest displacement", "1", true),
        series: compared.iter().map(|one| line(one.label, points(&one.relaxed))).collect(),
        slopes: Vec::new(),
    }
}
