//! Solvers that speak the protocol, measured on the same cases: any program that reads a job and
//! writes an answer, and this one.

mod contest;
mod doubt;
mod entrant;
mod family;
mod outcome;
mod own;
mod process;
mod report;
mod tables;

pub use contest::{Contest, ContestCase, NotASpacing, Spacing, absolute};
pub use entrant::{Entrant, NotAnEntrant};
pub use own::solve_job;

use crate::machine::load_average;
use anyhow::Result;
use mtled_checks::study::Study;

/// Runs a contest; `notify` is called before every run. None where the user has stopped it.
pub fn hold(contest: &Contest, notify: &dyn Fn(&str)) -> Result<Option<Study>> {
    let load_before = load_average();
    let runs = contest.run(notify)?;
    Ok(runs.map(|all| report::study(contest, &all, load_before)))
}
