//! The result of a run as JSON and as a screen of text.

mod loads;
mod vectors;

use crate::machine::{peak_memory, provenance};
use crate::run::contact::{contacts_json, contacts_text};
use crate::run::error_bar::{
    Estimated, error_bars_json, error_bars_text, no_bars_text, plus_minus,
};
use crate::run::memory::{estimated_memory, memory_text};
use crate::run::probes::left_out_text;
use crate::run::record::Recording;
use crate::run::solved::{Solved, warnings};
use crate::run::work::Work;
use loads::{cavities_json, loads_text, region_volumes_json, springs_json};
use mtled::Simulation;
use mtled::error::Error;
use mtled::model::contact::ContactResult;
use mtled::motion::summary::Summary;
use mtled::problem::Motion;
use mtled_case::scene::{Case, ProbeKind};
use mtled_checks::escape::printable;
use mtled_checks::report::four_digits;
use serde_json::{Value, json};
use vectors::{array, triple};

/// More points than this are not listed in the summary.
const MOST_POINTS: usize = 20;

/// Version of the layout of `result.json`.
const SCHEMA_VERSION: u32 = 1;

/// `result.json`. Only `timings` may differ between two runs of the same binary on
/// the same case. `bars` are the error bars, unless they were left out.
pub(crate) fn result_json(
    case: &Case,
    solved: &Solved,
    record: &Recording,
    contacts: &[ContactResult],
    bars: Option<&Estimated>,
) -> Value {
    let warnings = [warnings(case, &solved.simulation), solved.doubts()].concat();
    let mut result = recorded_json(case, &solved.simulation, record);
    result["warnings"] = json!(warnings);
    result["motion"] = motion_json(case, solved);
    result["contacts"] = json!(contacts_json(case, contacts));
    result["work_counters"] = json!(Work::of(solved));
    result["timings"]["solve_wall_s"] = json!(solved.solve_seconds);
    result["timings"]["solve_cpu_s"] = json!(solved.cpu_seconds);
    if let Some(bars) = bars {
        result["error_bars"] = error_bars_json(bars);
    }
    if let Some(Ok(bars)) = bars {
        result["timings"]["error_bars_cpu_s"] = json!(bars.cpu_seconds);
    }
    result
}

/// `result.json` of a run that ended with an error: what it had reached, marked as such.
pub(crate) fn failed_json(
    case: &Case,
    simulation: &Simulation,
    record: &Recording,
    error: &Error,
) -> Value {
    let mut result = recorded_json(case, simulation, record);
    result["warnings"] = json!(warnings(case, simulation));
    result["motion"] = json!({
        "method": method(case),
        "outcome": outcome_of(error),
        "complete": false,
        "error": error.to_string(),
        "steps": record.samples.last().map_or(0, |last| last.step),
        "time_s": record.samples.last().map_or(0.0, |last| last.time),
        "smallest_jacobian": record.samples.last().map_or(1.0, |last| last.smallest_jacobian),
    });
    result
}

/// What every run has.
fn recorded_json(case: &Case, simulation: &Simulation, record: &Recording) -> Value {
    let (discretisation, model) = (&simulation.discretisation, &simulation.model);
    let quadrature = &discretisation.quadrature;
    json!({
        "schema_version": SCHEMA_VERSION,
        "case": {
            "name": case.name,
            "title": case.title,
            "hash": case.hash,
            "overrides": case.overrides(),
        },
        "version": env!("CARGO_PKG_VERSION"),
        "discretisation": {
            "nodes": discretisation.cloud.positions.len(),
            "boundary_nodes": discretisation.cloud.on_boundary.iter().filter(|b| **b).count(),
            "quadrature_points": quadrature.positions.len(),
            "cells": quadrature.cells,
            "cut_cells": quadrature.cut_cells,
            "mean_support": discretisation.mean_support(),
            "worst_condition": discretisation.worst_condition,
            "enlarged_supports": discretisation.enlarged,
            "volume_m3": discretisation.volume(),
            "mass_kg": model.lumped_mass.iter().sum::<f64>(),
            "added_mass_kg": model.added_mass,
        },
        "probes": probes_json(case, record),
        "reactions": reactions_json(case, record),
        "springs": springs_json(case, record),
        "cavities": cavities_json(case, record),
        "region_volumes_m3": region_volumes_json(case, record),
        "energies": energies_json(record),
        "timings": {
            "setup_wall_s": simulation.setup_seconds,
            "peak_memory_bytes": peak_memory(),
            "estimated_memory_bytes": estimated_memory(case, discretisation).round(),
            "provenance": provenance(),
        },
    })
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// A motion reached its end.
    Completed,
    /// A static solution met its tolerance.
    Converged,
    /// The user stopped the run.
    Stopped,
    /// A static solution did not meet its tolerance.
    NotConverged,
    /// A point turned inside out, or displacements grew without bound.
    Diverged,
    /// Another error.
    Failed,
}

impl Outcome {
    fn of(case: &Case, summary: &Summary) -> Outcome {
        match (summary.stopped, &case.problem.motion) {
            (true, _) => Outcome::Stopped,
            (false, Motion::Dynamic { .. }) => Outcome::Completed,
            (false, _) => Outcome::Converged,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Outcome::Completed => "completed",
            Outcome::Converged => "converged",
            Outcome::Stopped => "stopped",
            Outcome::NotConverged => "not_converged",
            Outcome::Diverged => "diverged",
            Outcome::Failed => "failed",
        }
    }

    fn of_error(error: &Error) -> Outcome {
        match error {
            Error::NotConverged { .. } | Error::NoEquilibrium { .. } => Outcome::NotConverged,
            Error::Diverged { .. } | Error::Inverted { .. } => Outcome::Diverged,
            Error::Unstable { then, .. }
            | Error::NotHeld { then, .. }
            | Error::NeitherSolver { then, .. } => Outcome::of_error(then),
            _ => Outcome::Failed,
        }
    }
}

/// How a run ended with this error.
pub(crate) fn outcome_of(error: &Error) -> &'static str {
    Outcome::of_error(error).name()
}

fn method(case: &Case) -> &'static str {
    match case.problem.motion {
        Motion::Dynamic { .. } => "dynamic",
        Motion::Static(_) | Motion::Relaxed(_) | Motion::Newton(_) => "static",
    }
}

fn motion_json(case: &Case, solved: &Solved) -> Value {
    let summary = &solved.summary;
    let relaxation = summary.relaxation.map(|convergence| {
        json!({
            "estimated_error_m": convergence.estimated_error,
            "relative_residual": convergence.residual,
        })
    });
    let newton = summary.newton.map(|counts| {
        json!({
            "increments": counts.increments,
            "iterations": counts.iterations,
            "tangent_products": counts.products,
            "relative_residual": counts.residual,
            "up_to_round_off": counts.up_to_round_off, "pressures": counts.pressures.name(),
        })
    });
    let newton_failed = summary
        .newton_failed
        .map(|failure| json!({ "reached": failure.reached, "iterations": failure.iterations }));
    let moves = newton.is_none();
    let dynamic = matches!(case.problem.motion, Motion::Dynamic { .. });
    let unstable = summary.instability.as_ref().map(|found| {
        let (step, node, passed) = (found.step, found.node, found.passed);
        json!({ "step": step, "node": node, "position_m": array(&found.position), "passed": passed })
    });
    json!({
        "method": method(case),
        "outcome": Outcome::of(case, summary).name(),
        "complete": !summary.stopped,
        "steps": summary.steps,
        "time_s": summary.time,
        "smallest_time_step_s": moves.then_some(summary.time_steps.0),
        "largest_time_step_s": moves.then_some(summary.time_steps.1),
        "critical_time_step_s": moves.then_some(summary.critical_time_step),
        // Of the lumped masses, which a static run does not have.
        "per_point_bound_s": dynamic.then_some(solved.simulation.model.per_point_bound),
        "smallest_jacobian": summary.smallest_jacobian.jacobian,
        "smallest_patch_jacobian": solved.smallest_patch_jacobian(),
        "instability": unstable,
        "relaxation": relaxation,
        "newton": newton,
        "newton_failed": newton_failed,
    })
}

fn probes_json(case: &Case, record: &Recording) -> Vec<Value> {
    let Some(last) = record.samples.last() else { return Vec::new() };
    let rows = case.probes.iter().zip(&record.references).zip(&last.displacements);
    rows.map(|((probe, references), displacements)| {
        json!({
            "name": probe.name,
            "kind": match probe.kind {
                ProbeKind::Point(_) => "point",
                ProbeKind::Lattice { .. } => "lattice",
                ProbeKind::CentreOfMass { .. } => "centre_of_mass",
            },
            "left_out": probe.kind.left_out(),
            "reference_m": references.iter().map(array).collect::<Vec<_>>(),
            "displacement_m": displacements.iter().map(array).collect::<Vec<_>>(),
        })
    })
    .collect()
}

fn reactions_json(case: &Case, record: &Recording) -> Vec<Value> {
    let Some(last) = record.samples.last() else { return Vec::new() };
    let rows = case.problem.conditions.iter().zip(&last.reactions);
    rows.map(|(condition, reaction)| {
        json!({
            "condition": condition.name,
            "force_n": array(&reaction.force),
            "moment_n_m": array(&reaction.moment),
            "moment_about_m": array(&case.outputs.moment_about),
        })
    })
    .collect()
}

fn energies_json(record: &Recording) -> Value {
    record.samples.last().map_or(Value::Null, |last| {
        let e = &last.energies;
        json!({
            "kinetic_j": e.kinetic,
            "strain_j": e.strain,
            "external_work_j": e.external_work,
            "constraint_work_j": e.constraint_work,
            "damping_loss_j": e.damping_loss,
            "extra_work_j": e.extra_work,
            "contact_energy_j": e.contact_energy,
            "contact_loss_j": e.contact_loss,
        })
    })
}

/// The main results, a line each, with their error bars.
pub(crate) fn summary_text(
    case: &Case,
    solved: &Solved,
    record: &Recording,
    contacts: &[ContactResult],
    bars: Option<&Estimated>,
) -> String {
    let mut lines = vec![format!("{}: {}", printable(&case.name), printable(&case.title))];
    lines.extend(case.overrides().iter().map(|set| printable(&format!("  with {set}"))));
    lines.extend(bars.and_then(no_bars_text));
    lines.extend(run_text(solved));
    lines.extend(answers_text(case, record, bars));
    lines.extend(contacts_text(case, contacts).into_iter().chain(left_out_text(case)));
    lines.extend(bars.into_iter().flat_map(|bars| error_bars_text(case, bars)));
    lines.push(Work::of(solved).text());
    lines.extend(memory_text(case, solved));
    lines.push(format!(
        "  set-up {:.2} s, run {:.2} s wall ({:.2} s CPU)",
        solved.simulation.setup_seconds, solved.solve_seconds, solved.cpu_seconds
    ));
    lines.join("\n")
}

/// The cloud and how the run ended.
fn run_text(solved: &Solved) -> Vec<String> {
    let (d, s) = (&solved.simulation.discretisation, &solved.summary);
    let model = &solved.simulation.model;
    let mut lines = vec![
        format!(
            "  {} nodes, {} quadrature points, {:.1} nodes per support",
            d.cloud.positions.len(),
            d.supports.len(),
            d.mean_support()
        ),
        match s.newton {
            Some(newton) => format!(
                "  {}: {} in {}, {} products with the tangent, {}, \
                 residual {} of the largest nodal force",
                s.ending(),
                newton.corrections(),
                match newton.increments {
                    1 => "one part of the load".into(),
                    parts => format!("{parts} parts of the load"),
                },
                newton.products,
                solved.smallest_jacobian_text(),
                four_digits(newton.residual)
            ),
            None => format!(
                "  {} steps of {} to {} s (critical at rest {} s), {}",
                s.steps,
                four_digits(s.time_steps.0),
                four_digits(s.time_steps.1),
                four_digits(s.critical_time_step),
                solved.smallest_jacobian_text()
            ),
        },
    ];
    if model.added_mass > 0.0 {
        let fraction = model.added_mass / model.lumped_mass.iter().sum::<f64>();
        lines.push(format!("  mass scaling adds {} % of the mass", four_digits(100.0 * fraction)));
    }
    if let Some(failure) = s.newton_failed {
        lines.push(format!(
            "  Newton's method reached {:.0} % of the load in {} corrections; by relaxation from the start:",
            100.0 * failure.reached, failure.iterations
        ));
    }
    if let Some(convergence) = s.relaxation {
        lines.push(format!(
            "  {}: estimated error {} m, residual {} of the largest nodal force",
            s.ending(),
            four_digits(convergence.estimated_error),
            four_digits(convergence.residual)
        ));
    }
    lines
}

/// Points and supports at the end.
fn answers_text(case: &Case, record: &Recording, bars: Option<&Estimated>) -> Vec<String> {
    let Some(last) = record.samples.last() else { return Vec::new() };
    let probes = case.probes.iter().zip(&record.references).zip(&last.displacements);
    let mut lines = Vec::new();
    let single: Vec<_> = probes.filter(|(_, u)| u.len() == 1).collect();
    for ((probe, references), displacements) in single.iter().take(MOST_POINTS) {
        let place = if matches!(probe.kind, ProbeKind::CentreOfMass { .. }) {
            "centre of mass"
        } else {
            "point"
        };
        lines.push(format!(
            "  {place} \"{}\" at ({}) m moved by ({}) m{}",
            printable(&probe.name),
            triple(&references[0]),
            triple(&displacements[0]),
            plus_minus(bars, &format!("displacement/{}", probe.name))
        ));
    }
    if let Some(more) = single.len().checked_sub(MOST_POINTS).filter(|more| *more > 0) {
        lines.push(format!("  {more} more points are in result.json and history.csv"));
    }
    for (condition, reaction) in case.problem.conditions.iter().zip(&last.reactions) {
        lines.push(format!(
            "  force of \"{}\": ({}) N{}",
            printable(&condition.name),
            triple(&reaction.force),
            plus_minus(bars, &format!("force/{}", condition.name))
        ));
    }
    lines.extend(loads_text(case, last));
    lines
}
