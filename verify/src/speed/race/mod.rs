//! Speed against error, side by side: the meshless solver and two
//! finite-element codes on the same problems in the same minutes.
//!
//! Every run has a process of its own, with one thread, so that processor time
//! and peak memory are its own. CPU seconds are all in, set-up and solution:
//! of `mtled` from the start of the process, of the finite-element codes without
//! the start of the interpreter and the compilation of kernels, which are listed
//! beside them. What reads displacements off the solution is not counted.

mod equal_error;
mod finite_elements;
mod notes;
mod problems;
mod recipes;
mod report;
mod runs;

pub use finite_elements::{Code, Interpreter, Timings};
pub use problems::Challenge;
pub use runs::{Run, run_here};

use anyhow::Result;
use finite_elements::Rivals;
use mtled_checks::study::Study;
use std::time::Instant;

/// What is raced, and with whom.
#[derive(Debug)]
pub struct Race {
    pub challenges: Vec<Challenge>,
    /// Every run is repeated this often; medians are shown.
    pub repetitions: usize,
    /// The finite-element codes that are installed.
    pub interpreters: Vec<Interpreter>,
}

/// All runs of a challenge, of all codes.
#[derive(Debug)]
pub struct Field {
    pub challenge: Challenge,
    pub runs: Vec<Run>,
    /// Error bar of the field that errors are measured against, in the unit of
    /// the errors.
    pub uncertainty: f64,
}

/// What came of a race.
#[derive(Debug)]
pub struct Outcome {
    pub study: Study,
    /// Of the finite-element codes that ran, to be stored.
    pub timings: Timings,
}

/// Runs the race; `say` hears of every run.
pub fn race(race: &Race, say: &dyn Fn(&str)) -> Result<Outcome> {
    let start = Instant::now();
    let rivals = Rivals::new(&race.interpreters)?;
    let mut fields = Vec::new();
    for &challenge in &race.challenges {
        let mut turns: Vec<Vec<Run>> = Vec::new();
        for turn in 1..=race.repetitions {
            say(&format!("{}: round {turn} of {}", challenge.title(), race.repetitions));
            let mut runs = runs::own(challenge)?;
            runs.extend(rivals.runs(challenge)?);
            turns.push(runs);
        }
        let mut runs = runs::medians(&turns);
        runs.extend(rivals.stored(challenge));
        let uncertainty = challenge.truth()?.uncertainty;
        fields.push(Field { challenge, runs, uncertainty });
    }
    let mut study = report::study(race, &rivals, &fields);
    study.wall_seconds = start.elapsed().as_secs_f64();
    let timings = rivals.timings(fields.iter().flat_map(|field| &field.runs));
    Ok(Outcome { study, timings })
}
