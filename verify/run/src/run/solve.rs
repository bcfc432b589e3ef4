//! From a prepared problem to its final state.

use super::prepare::{Prepared, prepare};
use super::record::{Recorder, Recording};
use crate::machine::cpu_seconds;
use mtled::discretisation::Warning;
use mtled::error::Error;
use mtled::motion::observe::Observer;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::motion::strain::{smallest_patch_jacobian, strain_warnings};
use mtled::motion::summary::Summary;
use mtled::problem::Problem;
use mtled_case::scene::Case;
use mtled_checks::report::four_digits;
use std::time::Instant;

/// The end of a run.
#[derive(Debug)]
pub struct Integrated {
    /// Displacements and velocities at the end.
    pub state: State,
    /// Steps, smallest J and convergence.
    pub summary: Summary,
    /// Wall time of the integration \[s\].
    pub solve_seconds: f64,
    /// CPU time of the integration, all threads of the process \[s\].
    pub cpu_seconds: f64,
}

/// A solved problem.
#[derive(Debug)]
pub struct Solved {
    /// Discretisation and model.
    pub prepared: Prepared,
    /// Displacements and velocities at the end.
    pub state: State,
    /// Steps, smallest J and convergence.
    pub summary: Summary,
    /// Wall time of the integration \[s\].
    pub solve_seconds: f64,
    /// CPU time of the integration, all threads of the process \[s\].
    pub cpu_seconds: f64,
}

impl Solved {
    /// Joins the end of a run to its model.
    pub fn new(prepared: Prepared, end: Integrated) -> Solved {
        let Integrated { state, summary, solve_seconds, cpu_seconds } = end;
        Solved { prepared, state, summary, solve_seconds, cpu_seconds }
    }

    /// Reasons to doubt a finished run, beside those of [`Prepared::doubts`].
    pub fn doubts(&self) -> Vec<String> {
        let model = &self.prepared.model;
        let inside =
            model.contact.penetrations(&model.positions, self.state.time, &self.state.displacement);
        let mut doubts = self.summary.doubts(model);
        doubts.extend(inside.iter().map(Warning::to_string));
        let discretisation = &self.prepared.discretisation;
        let unresolved =
            model.contact.unresolved(discretisation, self.state.time, &self.state.displacement);
        doubts.extend(unresolved.iter().map(Warning::to_string));
        let strained = strain_warnings(model, discretisation, &self.state.displacement);
        doubts.extend(strained.iter().map(Warning::to_string));
        doubts
    }

    /// The smallest J of the patches on which changes of volume are projected, if any are, at the
    /// end \[–\].
    pub fn smallest_patch_jacobian(&self) -> Option<f64> {
        let Prepared { model, discretisation, .. } = &self.prepared;
        smallest_patch_jacobian(model, discretisation, &self.state.displacement)
    }

    /// J at points over the whole run. Where changes of volume are projected on patches, the volume is
    /// that of the patches, at the end, and both are named.
    pub fn smallest_jacobian_text(&self) -> String {
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

/// Runs a prepared problem, which stays with the caller if the run fails.
pub fn integrate_prepared(
    problem: &Problem,
    prepared: &Prepared,
    observer: &mut dyn Observer,
) -> Result<Integrated, Error> {
    let (start, cpu) = (Instant::now(), cpu_seconds());
    let mut state = prepared.start.clone().unwrap_or_else(|| State::new(&prepared.model));
    let summary = simulate(&prepared.model, &problem.motion, &mut state, observer)?;
    Ok(Integrated {
        state,
        summary,
        solve_seconds: start.elapsed().as_secs_f64(),
        cpu_seconds: cpu_seconds() - cpu,
    })
}

/// Runs a prepared problem.
pub fn integrate(
    problem: &Problem,
    prepared: Prepared,
    observer: &mut dyn Observer,
) -> Result<Solved, Error> {
    let end = integrate_prepared(problem, &prepared, observer)?;
    Ok(Solved::new(prepared, end))
}

/// Solves a case and records its probes.
pub fn solve_case(case: &Case) -> Result<(Solved, Recording), Error> {
    let prepared = prepare(&case.problem)?;
    let mut recorder = Recorder::new(case, &prepared, 0)?;
    let solved = integrate(&case.problem, prepared, &mut recorder)?;
    Ok((solved, recorder.finish()))
}
