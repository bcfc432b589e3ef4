//! One run, from its task to its record.
#![allow(non_snake_case)]

use super::boundary_misfit::boundary_misfit;
use super::patch_test::{patch_errors, with_affine_boundary};
use super::record::{Figures, RunOutcome, RunRecord, SCHEMA_VERSION, Stage, Timings};
use super::task::{Job, Task, solver_identity};
use anyhow::Result;
use cpu_time::ThreadTime;
use mtled::Simulation;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::error::Error;
use mtled::force::Workspace;
use mtled::motion::critical_time_step::critical_time_step;
use mtled_case::reference::{is_dynamic, quantities};
use mtled_case::scene::Case;
use mtled_run::accuracy::{SAMPLES, values};
use mtled_run::machine::provenance;
use mtled_run::run::{
    Recorder, Solved, Work, estimated_memory, integrate, refuse_beyond_memory, warnings,
};
use mtled_run::specimens::stable_step::{largest_stable_step, trial_velocity};

/// A run that came to an end.
pub(crate) struct Performed {
    pub record: RunRecord,
    /// Whether it would end like this elsewhere too: where there was too little memory it would not.
    pub lasts: bool,
}

/// Runs a task on this thread alone. None where the user has stopped it.
pub(crate) fn perform(task: &Task) -> Result<Option<Performed>> {
    let mut case = task.source.with(&task.settings)?;
    if is_dynamic(&case) {
        case.outputs.history = case.outputs.history.max(SAMPLES);
    }
    let start = ThreadTime::now();
    let mut set_up_cpu_s = None;
    let fits = refuse_beyond_memory(&case);
    let lasts = fits.is_ok();
    let simulation = match fits {
        Err(shortage) => Err(shortage.to_string()),
        Ok(()) => Simulation::new(&case.problem).map_err(|error| error.to_string()),
    };
    let outcome = match simulation {
        Err(reason) => Some(RunOutcome::Failed { stage: Stage::Refused, reason }),
        Ok(simulation) => {
            set_up_cpu_s = Some(start.elapsed().as_secs_f64());
            run_job(task, &case, simulation)?
        }
    };
    let cpu_s = start.elapsed().as_secs_f64();
    let set_up_cpu_s = set_up_cpu_s.unwrap_or(cpu_s);
    let provenance = provenance();
    let outcome = outcome.map(with_finite_figures);
    let record = outcome.map(|outcome| RunRecord {
        schema_version: SCHEMA_VERSION,
        key: String::new(),
        job: task.job,
        case: task.source.name.clone(),
        solver: solver_identity().to_string(),
        overrides: task.source.case.overrides().to_vec(),
        settings: task.settings.clone(),
        times_s: task.times.clone(),
        outcome,
        timings: Timings {
            set_up_cpu_s,
            solve_cpu_s: cpu_s - set_up_cpu_s,
            processor: provenance.processor,
            date: provenance.date,
        },
    });
    Ok(record.map(|record| Performed { record, lasts }))
}

/// JSON has no infinity and no NaN: a record with one could not be read again.
fn with_finite_figures(mut outcome: RunOutcome) -> RunOutcome {
    if let RunOutcome::Done { figures, .. } = &mut outcome {
        figures.retain(|_, figure| figure.is_finite());
    }
    outcome
}

fn run_job(task: &Task, case: &Case, simulation: Simulation) -> Result<Option<RunOutcome>> {
    let (stage, more) = match task.job {
        Job::Solve => return solve(task, case, simulation),
        Job::Consistency => (Stage::Refused, Ok(Figures::new())),
        Job::TimeStep => (Stage::Refused, step_figures(case, &simulation)),
        Job::Patch => (Stage::Running, patch_errors(&case.problem)),
    };
    Ok(Some(match more {
        Err(error) => RunOutcome::Failed { stage, reason: error.to_string() },
        Ok(mut more) => {
            let mut figures = discretisation_figures(case, &simulation);
            figures.append(&mut more);
            let warnings = warnings(case, &simulation);
            let (quantities, values) = (Vec::new(), Vec::new());
            RunOutcome::Done { figures, quantities, values, work: None, warnings }
        }
    }))
}

fn solve(task: &Task, case: &Case, simulation: Simulation) -> Result<Option<RunOutcome>> {
    let mut recorder = Recorder::new(case, &simulation, 0)?;
    let mut figures = discretisation_figures(case, &simulation);
    let mut warnings = warnings(case, &simulation);
    let solved = match integrate(simulation, &mut recorder) {
        Ok(solved) => solved,
        Err(error) => {
            let reason = error.to_string();
            return Ok(Some(RunOutcome::Failed { stage: Stage::Running, reason }));
        }
    };
    if solved.summary.stopped {
        return Ok(None);
    }
    let record = recorder.finish();
    figures.append(&mut simulation_figures(&solved));
    if let Some(misfit) = boundary_misfit(&case.problem, &solved)? {
        figures.insert("held_misfit".into(), misfit);
    }
    warnings.extend(solved.doubts());
    Ok(Some(RunOutcome::Done {
        figures,
        quantities: quantities(case),
        values: values(case, &record, &task.times)?,
        work: Some(Work::of(&solved)),
        warnings,
    }))
}

fn discretisation_figures(case: &Case, simulation: &Simulation) -> Figures {
    let Simulation { discretisation, model, .. } = simulation;
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
    let memory = estimated_memory(case, discretisation);
    figures.insert("estimated_memory_bytes".into(), memory.round());
    figures
}

fn simulation_figures(solved: &Solved) -> Figures {
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

/// Fractions of the height by which a body is compressed for its critical step \[–\].
pub(crate) const COMPRESSIONS: [f64; 3] = [0.0, 0.25, 0.5];

/// Per-point bound, Lanczos estimate and largest stable step \[s\] of the case at rest;
/// then of its body with the whole boundary prescribed, compressed along its last axis at
/// constant volume.
fn step_figures(case: &Case, simulation: &Simulation) -> Result<Figures, Error> {
    let mut figures =
        Figures::from([("per_point_bound_s".into(), simulation.model.per_point_bound)]);
    let at_rest = vec![0.0; simulation.model.size()];
    let (lanczos, stable, products) = steps(simulation, &at_rest, 0.0);
    figures.insert("lanczos_s".into(), lanczos);
    figures.insert("largest_stable_step_s".into(), stable);
    figures.insert("lanczos_products".into(), products as f64);
    for compression in COMPRESSIONS {
        let H = compressed(simulation.model.components, compression);
        let confined = Simulation::new(&with_affine_boundary(&case.problem, H))?;
        let model = &confined.model;
        let displacement = |X: &Vector3| (0..model.components).map(|k| H[(k, k)] * X[k]).collect();
        let u: Vec<f64> =
            model.positions.iter().flat_map(|X| -> Vec<f64> { displacement(X) }).collect();
        let (lanczos, stable, _) = steps(&confined, &u, 1.0);
        let name = |what: &str| format!("{what}_held_at_{:.0}_percent_s", 100.0 * compression);
        figures.insert(name("lanczos"), lanczos);
        figures.insert(name("largest_stable_step"), stable);
    }
    Ok(figures)
}

/// Critical step by Lanczos \[s\], largest stable step by trial \[s\] and number of Lanczos
/// products.
fn steps(simulation: &Simulation, u: &[f64], t: f64) -> (f64, f64, usize) {
    let model = &simulation.model;
    let critical = critical_time_step(model, u, t, None, &mut Workspace::new(&model.points));
    let velocity = trial_velocity(model, &simulation.discretisation.cloud.spacing);
    let stable = largest_stable_step(model, u, t, &velocity, critical.time_step);
    (critical.time_step, stable, critical.products)
}

/// Displacement gradient of an isochoric compression: the last axis becomes shorter,
/// the others longer.
fn compressed(components: usize, compression: f64) -> Matrix3 {
    let along = 1.0 - compression;
    let across = along.powf(-1.0 / (components - 1) as f64);
    Matrix3::from_diagonal(&Vector3::from_fn(|axis, _| match axis {
        axis if axis + 1 == components => along - 1.0,
        axis if axis < components => across - 1.0,
        _ => 0.0,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::store::Source;
    use mtled_case::scene::{Knob, Setting};

    #[test]
    fn a_recipe_whose_gradients_cannot_be_made_consistent_is_refused_before_the_first_step() {
        let folder = tempfile::tempdir().unwrap();
        let source = Source::find("falling_beam", folder.path(), &[]).unwrap();
        let settings = vec![
            Setting::word(Knob::Spacing, "x1.6"),
            Setting::number(Knob::Dilation, 1.5),
            Setting::number(Knob::CellsPerSpacing, 1.0),
        ];
        let task = Task { job: Job::Solve, source, settings, times: vec![0.2] };
        let record = perform(&task).unwrap().unwrap().record;
        let reason = record.failure().unwrap();
        assert!(reason.contains("correction of the gradients diverges"), "{reason}");
    }
}
