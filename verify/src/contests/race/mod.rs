//! Speed against error: the meshless solver and two finite-element codes on the same
//! problems in the same minutes.
//!
//! Every run has its own process with one thread, so that CPU time and peak memory are its
//! own. CPU times include set-up and solution: of `mtled` from the start of the process, of
//! the finite-element codes without the start of the interpreter and the compilation of
//! kernels, which are listed separately. Sampling the displacements is not counted.

mod challenge;
mod field;
mod finite_elements;
mod notes;
mod own_runs;
mod race_run;
mod recipes;
mod report;
mod tables;

pub use challenge::Challenge;
pub use field::RaceSettings;
pub use finite_elements::{Interpreter, Timings};
pub use own_runs::run_here;
pub use race_run::{Code, FINITE_ELEMENT_CODES, RaceRun};

use anyhow::Result;
use field::Field;
use finite_elements::FiniteElementCodes;
use mtled_checks::study::Study;
use own_runs::own_runs;
use race_run::medians;

/// Result of a race.
#[derive(Debug)]
pub struct RaceOutcome {
    /// Tables, figures and checks.
    pub study: Study,
    /// Timings of the finite-element codes that ran, to be stored.
    pub timings: Timings,
}

/// Runs the race; `notify` is called before every round.
pub fn race(settings: &RaceSettings, notify: &dyn Fn(&str)) -> Result<RaceOutcome> {
    let codes = FiniteElementCodes::new(&settings.interpreters)?;
    let mut fields = Vec::new();
    for &challenge in &settings.challenges {
        let mut rounds: Vec<Vec<RaceRun>> = Vec::new();
        for round in 1..=settings.repetitions {
            notify(&format!("{}: round {round} of {}", challenge.title(), settings.repetitions));
            let mut runs = own_runs(challenge)?;
            runs.extend(codes.runs(challenge)?);
            rounds.push(runs);
        }
        let mut runs = medians(&rounds);
        runs.extend(codes.stored(challenge));
        let uncertainty = challenge.solution()?.uncertainty;
        fields.push(Field { challenge, runs, uncertainty });
    }
    let study = report::study(settings, &codes, &fields);
    let timings = codes.timings(fields.iter().flat_map(|field| &field.runs));
    Ok(RaceOutcome { study, timings })
}
