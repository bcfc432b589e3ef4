//! One case from its problem to its result.

mod memory;
mod output;
mod probes;
mod record;
mod result;
pub mod vtu;
mod work;

pub use memory::{Footprint, MemoryShortage, refuse_beyond_memory};
pub use output::{write_outputs, write_recorded};
pub use probes::{MassCentre, centres_of_mass};
pub use record::{Record, Recorder, Sample};
pub use result::{result_json, summary_text};
pub use work::Work;

use crate::machine::cpu_seconds;
use crate::scene::Case;
use mtled::discretisation::Discretisation;
use mtled::error::Error;
use mtled::model::Model;
use mtled::model::zero_energy::refuse_zero_energy_modes;
use mtled::motion::mass_scaling::raise_masses;
use mtled::motion::observe::Observer;
use mtled::motion::simulate::{Summary, simulate};
use mtled::motion::state::State;
use mtled::problem::Problem;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// A problem that has been discretised.
#[derive(Debug)]
pub struct Prepared {
    pub discretisation: Discretisation,
    pub model: Model,
    /// Wall seconds of the set-up.
    pub setup_seconds: f64,
}

/// What a march to the end gives.
#[derive(Debug)]
pub struct March {
    pub state: State,
    pub summary: Summary,
    /// Wall seconds of the march.
    pub solve_seconds: f64,
    /// CPU seconds of the march, all threads of the process.
    pub cpu_seconds: f64,
}

/// A problem that has been marched to its end.
#[derive(Debug)]
pub struct Solved {
    pub prepared: Prepared,
    pub state: State,
    pub summary: Summary,
    /// Wall seconds of the march.
    pub solve_seconds: f64,
    /// CPU seconds of the march, all threads of the process.
    pub cpu_seconds: f64,
}

impl Solved {
    /// Joins a march to what it marched.
    pub fn new(prepared: Prepared, march: March) -> Solved {
        let March { state, summary, solve_seconds, cpu_seconds } = march;
        Solved { prepared, state, summary, solve_seconds, cpu_seconds }
    }
}

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Asks every run to end after the step it is in.
pub fn interrupt() {
    INTERRUPTED.store(true, Ordering::Relaxed);
}

/// Whether the user has asked to stop.
pub fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// Discretises a problem and binds its model.
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

/// Marches a prepared problem, which stays with the caller if the run fails.
pub fn march_on(
    problem: &Problem,
    prepared: &Prepared,
    observer: &mut dyn Observer,
) -> Result<March, Error> {
    let (start, cpu) = (Instant::now(), cpu_seconds());
    let mut state = State::new(&prepared.model);
    let summary = simulate(&prepared.model, &problem.motion, &mut state, observer)?;
    Ok(March {
        state,
        summary,
        solve_seconds: start.elapsed().as_secs_f64(),
        cpu_seconds: cpu_seconds() - cpu,
    })
}

/// Marches a prepared problem.
pub fn march(
    problem: &Problem,
    prepared: Prepared,
    observer: &mut dyn Observer,
) -> Result<Solved, Error> {
    let march = march_on(problem, &prepared, observer)?;
    Ok(Solved::new(prepared, march))
}

/// Solves a case and records what its probes see.
pub fn solve_case(case: &Case) -> Result<(Solved, Record), Error> {
    let prepared = prepare(&case.problem)?;
    let mut recorder = Recorder::new(case, &prepared, 0)?;
    let solved = march(&case.problem, prepared, &mut recorder)?;
    Ok((solved, recorder.finish()))
}
