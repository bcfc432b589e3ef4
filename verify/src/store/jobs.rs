//! One run, from its task to its record.
#![allow(non_snake_case)]

use super::patch::patch_errors;
use super::record::{Outcome, Record, SCHEMA_VERSION, Stage, Timings};
use super::task::{Job, Task, solver_identity};
use crate::accuracy::{SAMPLES, values};
use crate::machine::provenance;
use crate::reference::is_dynamic;
use crate::run::{Footprint, Prepared, Recorder, Solved, Work, march, prepare_to_run};
use crate::scene::Case;
use crate::studies::{largest_stable_step, trial_velocity};
use anyhow::Result;
use cpu_time::ThreadTime;
use mtled::critical_time_step::critical_time_step;
use mtled::error::Error;
use mtled::internal_force::Workspace;
use mtled::model::Model;
use mtled::tensor::Vector3;
use std::collections::BTreeMap;

type Figures = BTreeMap<String, f64>;

/// Runs a task on this thread alone. None where the user has stopped it.
pub fn perform(task: &Task) -> Result<Option<Record>> {
    let mut case = task.source.with(&task.settings)?;
    if is_dynamic(&case) {
        case.outputs.history = case.outputs.history.max(SAMPLES);
    }
    let start = ThreadTime::now();
    let mut set_up = 0.0;
    let outcome = match crate::run::refuse_beyond_memory(&case.problem) {
        Err(shortage) => Some(refused(shortage.to_string())),
        Ok(()) => match prepare_to_run(&case.problem) {
            Err(error) => Some(refused(error.to_string())),
            Ok(prepared) => {
                set_up = start.elapsed().as_secs_f64();
                carry_out(task, &case, prepared)?
            }
        },
    };
    let spent = start.elapsed().as_secs_f64();
    if set_up == 0.0 {
        set_up = spent;
    }
    let provenance = provenance();
    Ok(outcome.map(|outcome| Record {
        schema_version: SCHEMA_VERSION,
        key: String::new(),
        job: task.job,
        case: task.source.name.clone(),
        solver: solver_identity().to_string(),
        settings: task.settings.clone(),
        times_s: task.times.clone(),
        outcome,
        timings: Timings {
            set_up_cpu_s: set_up,
            march_cpu_s: spent - set_up,
            processor: provenance.processor,
            date: provenance.date,
        },
    }))
}

fn refused(reason: String) -> Outcome {
    Outcome::Failed { stage: Stage::Refused, reason }
}

fn failed(error: &Error) -> Outcome {
    Outcome::Failed { stage: Stage::Marching, reason: error.to_string() }
}

fn carry_out(task: &Task, case: &Case, prepared: Prepared) -> Result<Option<Outcome>> {
    match task.job {
        Job::Solve => solve(task, case, prepared),
        Job::Consistency => Ok(Some(plain(discretisation_figures(case, &prepared), &prepared))),
        Job::TimeStep => {
            let mut figures = discretisation_figures(case, &prepared);
            figures.append(&mut step_figures(&prepared));
            Ok(Some(plain(figures, &prepared)))
        }
        Job::Patch => Ok(Some(match patch_errors(&case.problem) {
            Ok(mut errors) => {
                let mut figures = discretisation_figures(case, &prepared);
                figures.append(&mut errors);
                plain(figures, &prepared)
            }
            Err(error) => failed(&error),
        })),
    }
}

/// A run that has figures only.
fn plain(figures: Figures, prepared: &Prepared) -> Outcome {
    Outcome::Done { figures, values: Vec::new(), work: None, warnings: warnings(prepared) }
}

fn warnings(prepared: &Prepared) -> Vec<String> {
    prepared.discretisation.warnings().iter().map(|warning| warning.to_string()).collect()
}

fn solve(task: &Task, case: &Case, prepared: Prepared) -> Result<Option<Outcome>> {
    let mut recorder = Recorder::new(case, &prepared, 0)?;
    let mut figures = discretisation_figures(case, &prepared);
    let mut warnings = warnings(&prepared);
    let solved = match march(&case.problem, prepared, &mut recorder) {
        Ok(solved) => solved,
        Err(error) => return Ok(Some(failed(&error))),
    };
    if solved.summary.stopped {
        return Ok(None);
    }
    let record = recorder.finish();
    figures.append(&mut march_figures(&solved));
    warnings.extend(solved.summary.crushed(&solved.prepared.model).map(|c| c.to_string()));
    Ok(Some(Outcome::Done {
        figures,
        values: values(case, &record, &task.times)?,
        work: Some(Work::of(&solved)),
        warnings,
    }))
}

fn discretisation_figures(case: &Case, prepared: &Prepared) -> Figures {
    let Prepared { discretisation, model, .. } = prepared;
    let points = discretisation.supports.len() as f64;
    let nodes = model.positions.len() as f64;
    let spacing = discretisation.cloud.spacing.iter().copied().fold(0.0, f64::max);
    let mut figures = Figures::from([
        ("spacing_m".into(), spacing),
        ("nodes".into(), nodes),
        ("points".into(), points),
        ("points_per_node".into(), points / nodes),
        ("mean_support".into(), discretisation.mean_support()),
        ("worst_condition".into(), discretisation.worst_condition),
        ("enlarged_supports".into(), discretisation.enlarged as f64),
        ("bytes_per_step".into(), model.bytes_per_step() as f64),
    ]);
    if let Some(correction) = &discretisation.correction {
        figures.insert("defect_of_plain_gradients".into(), correction.defect);
        figures.insert("defect_of_gradients".into(), correction.defect * correction.residual);
        figures.insert("correction_iterations".into(), correction.iterations as f64);
    }
    if let Ok(footprint) = Footprint::of(&case.problem) {
        figures.insert("estimated_memory_bytes".into(), footprint.bytes.round());
    }
    figures
}

fn march_figures(solved: &Solved) -> Figures {
    let summary = &solved.summary;
    let mut figures =
        Figures::from([("smallest_jacobian".into(), summary.smallest_jacobian.jacobian)]);
    if summary.newton.is_none() {
        figures.insert("critical_time_step_s".into(), summary.critical_time_step);
        figures.insert("smallest_time_step_s".into(), summary.time_steps.0);
        figures.insert("largest_time_step_s".into(), summary.time_steps.1);
    }
    figures
}

/// Shares of the height by which a body is compressed for its critical step \[–\].
pub const COMPRESSIONS: [f64; 3] = [0.0, 0.25, 0.5];

/// Bound, estimate and truth of the critical step, at rest and compressed along its
/// last axis without change of volume.
fn step_figures(prepared: &Prepared) -> Figures {
    let model = &prepared.model;
    let mut figures = Figures::from([("per_point_bound_s".into(), model.bound)]);
    let velocity = trial_velocity(model, &prepared.discretisation.cloud.spacing);
    let mut workspace = Workspace::new(model);
    for compression in COMPRESSIONS {
        let u = compressed(model, compression);
        let critical = critical_time_step(model, &u, 0.0, None, &mut workspace);
        let stable = largest_stable_step(model, &u, 0.0, &velocity, critical.time_step);
        let name = |what: &str| format!("{what}_at_{:.0}_percent_s", 100.0 * compression);
        figures.insert(name("lanczos"), critical.time_step);
        figures.insert(name("largest_stable_step"), stable);
        if compression == 0.0 {
            figures.insert("lanczos_products".into(), critical.products as f64);
        }
    }
    figures
}

/// Nodal parameters of an isochoric compression: the last axis becomes shorter, the
/// others longer.
fn compressed(model: &Model, compression: f64) -> Vec<f64> {
    let components = model.components;
    let along = 1.0 - compression;
    let across = along.powf(-1.0 / (components - 1) as f64);
    let stretch = |axis: usize| if axis + 1 == components { along } else { across };
    let moved = |X: &Vector3| (0..components).map(move |k| (stretch(k) - 1.0) * X[k]).collect();
    model.positions.iter().flat_map(|X| -> Vec<f64> { moved(X) }).collect()
}
