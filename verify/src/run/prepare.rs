//! From a problem to its discretisation and model.

use mtled::discretisation::Discretisation;
use mtled::error::Error;
use mtled::model::Model;
use mtled::model::zero_energy::refuse_zero_energy_modes;
use mtled::motion::mass_scaling::raise_masses;
use mtled::problem::Problem;
use std::time::Instant;

/// A problem that has been discretised.
#[derive(Debug)]
pub struct Prepared {
    /// Nodes, supports and quadrature points.
    pub discretisation: Discretisation,
    /// Masses, conditions, loads and contact.
    pub model: Model,
    /// Wall time of the set-up \[s\].
    pub setup_seconds: f64,
}

/// Discretises a problem and builds its model.
pub fn prepare(problem: &Problem) -> Result<Prepared, Error> {
    let start = Instant::now();
    let discretisation = Discretisation::new(problem)?;
    let model = raise_masses(Model::new(problem, &discretisation)?, problem, &discretisation)?;
    Ok(Prepared { discretisation, model, setup_seconds: start.elapsed().as_secs_f64() })
}

/// As [`prepare`]; a recipe that leaves zero-energy modes is refused.
pub fn prepare_to_run(problem: &Problem) -> Result<Prepared, Error> {
    let prepared = prepare(problem)?;
    refuse_zero_energy_modes(problem, &prepared.discretisation, &prepared.model)?;
    Ok(prepared)
}
