//! A simulation that has come to its end, with what that took.

use super::record::{Recorder, Recording};
use crate::machine::cpu_seconds;
use mtled::Simulation;
use mtled::error::Error;
use mtled::motion::observe::Observer;
use mtled::motion::strain::smallest_patch_jacobian;
use mtled::motion::summary::Summary;
use mtled_case::scene::Case;
use mtled_checks::report::four_digits;
use std::time::Instant;

/// A solved problem.
#[derive(Debug)]
pub struct Solved {
    /// The model, and its state at the end.
    pub simulation: Simulation,
    /// Steps, smallest J and convergence.
    pub summary: Summary,
    /// Wall time of the solution \[s\].
    pub solve_seconds: f64,
    /// CPU time of the solution, all threads of the process \[s\].
    pub cpu_seconds: f64,
}

impl Solved {
    /// Runs a simulation.
    ///
    /// # Errors
    /// Those of [`Simulation::run`], with the simulation at the last state that it reached.
    pub(crate) fn of(
        mut simulation: Simulation,
        observer: &mut dyn Observer,
    ) -> Result<Solved, Box<(Error, Simulation)>> {
        let (start, cpu) = (Instant::now(), cpu_seconds());
        match simulation.run(observer) {
            Ok(summary) => Ok(Solved {
                simulation,
                summary,
                solve_seconds: start.elapsed().as_secs_f64(),
                cpu_seconds: cpu_seconds() - cpu,
            }),
            Err(error) => Err(Box::new((error, simulation))),
        }
    }

    /// Reasons to doubt the run, beside those of [`Simulation::warnings`].
    pub fn doubts(&self) -> Vec<String> {
        self.simulation.doubts(&self.summary)
    }

    /// The smallest J of the patches on which changes of volume are projected, if any are, at the
    /// end \[–\].
    pub(crate) fn smallest_patch_jacobian(&self) -> Option<f64> {
        let Simulation { model, discretisation, state, .. } = &self.simulation;
        smallest_patch_jacobian(model, discretisation, &state.displacement)
    }

    /// J at points over the whole run. Where changes of volume are projected on patches, the volume is
    /// that of the patches, at the end, and both are named.
    pub(crate) fn smallest_jacobian_text(&self) -> String {
        let at_points = four_digits(self.summary.smallest_jacobian.jacobian);
        match self.smallest_patch_jacobian() {
            Some(of_patches) => format!(
                "smallest J {at_points} at points and {} of the patches on which it is projected",
                four_digits(of_patches)
            ),
            None => format!("smallest J {at_points}"),
        }
    }
}

/// What to know of a case before it is solved: remarks of its files, and warnings of its set-up.
pub fn warnings(case: &Case, simulation: &Simulation) -> Vec<String> {
    let of_set_up = simulation.warnings();
    case.notes.iter().cloned().chain(of_set_up.iter().map(ToString::to_string)).collect()
}

/// Runs a simulation of which nothing is needed if it fails.
pub fn integrate(simulation: Simulation, observer: &mut dyn Observer) -> Result<Solved, Error> {
    Solved::of(simulation, observer).map_err(|failed| failed.0)
}

/// Solves a case and records its probes.
pub fn solve_case(case: &Case) -> Result<(Solved, Recording), Error> {
    let simulation = Simulation::with_any_recipe(&case.problem)?;
    let mut recorder = Recorder::new(case, &simulation, 0)?;
    let solved = integrate(simulation, &mut recorder)?;
    Ok((solved, recorder.finish()))
}
