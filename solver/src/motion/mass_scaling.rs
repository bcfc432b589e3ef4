//! Mass scaling: heavier nodes for a longer time step of quasi-static motion.

use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::force::Workspace;
use crate::model::Model;
use crate::model::essential::Constraints;
use crate::motion::critical_time_step::critical_time_step;
use crate::problem::{Motion, Problem};

/// Largest fraction of the body's mass that may be added \[–\].
const MOST_ADDED: f64 = 0.1;
/// Trials of the largest frequency that a node may keep.
const MOST_TRIALS: usize = 12;

/// Raises the masses of the nodes that dictate the critical step at rest until
/// that step is `mass_scaling` times longer: m_a = max(m_a, K_aa/τ) with the
/// largest τ that achieves it (method book, eq. 17.10). Other nodes keep their masses, and
/// loads do not act on the added mass. Refused where it takes more than a tenth of the
/// body's mass, since inertia would then change everywhere.
pub fn raise_masses(
    model: Model,
    problem: &Problem,
    discretisation: &Discretisation,
) -> Result<Model, Error> {
    let factor = match &problem.motion {
        Motion::Dynamic { step, .. } => step.mass_scaling,
        Motion::Static(_) | Motion::Relaxed(_) | Motion::Newton(_) => 1.0,
    };
    if factor <= 1.0 {
        return Ok(model);
    }
    let target = factor * time_step_at_rest(&model);
    let quotients = model.stiffness.iter().zip(&model.lumped_mass).map(|(k, m)| k / m);
    let mut limit = quotients.fold(0.0, f64::max) / (factor * factor);
    let mut raised = model;
    for _ in 0..MOST_TRIALS {
        raised = with_limit(raised, problem, discretisation, limit)?;
        let fraction = raised.added_mass / raised.lumped_mass.iter().sum::<f64>();
        if fraction > MOST_ADDED {
            return Err(Error::TooMuchAddedMass { factor, fraction, most: MOST_ADDED });
        }
        let reached = time_step_at_rest(&raised) / target;
        if (1.0..1.02).contains(&reached) {
            break;
        }
        // Where the heavier nodes dictate the step, Δt² goes like 1/τ.
        limit *= (reached / 1.01).powi(2);
    }
    Ok(raised)
}

fn with_limit(
    model: Model,
    problem: &Problem,
    discretisation: &Discretisation,
    limit: f64,
) -> Result<Model, Error> {
    let inertia: Vec<f64> =
        model.lumped_mass.iter().zip(&model.stiffness).map(|(m, k)| m.max(k / limit)).collect();
    let constraints = Constraints::new(problem, discretisation, &inertia)?;
    let added_mass = inertia.iter().zip(&model.lumped_mass).map(|(i, m)| i - m).sum();
    Ok(Model { inertia, constraints, added_mass, ..model })
}

fn time_step_at_rest(model: &Model) -> f64 {
    let rest = vec![0.0; model.size()];
    critical_time_step(model, &rest, 0.0, None, &mut Workspace::new(&model.points)).time_step
}
