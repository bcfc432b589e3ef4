//! The contest of solvers that speak the protocol: any program that reads a job and writes an
//! answer, and this one. Runs are stored as raw results, and all that is said of them is judged
//! from these.

mod contest;
mod doubt;
mod entrant;
mod identity;
mod judged;
mod outcome;
mod own;
mod pages;
mod problem;
mod process;
mod programs;
mod race;
mod report;
mod results;
mod run_tables;
mod tables;

pub use contest::{Contest, absolute};
pub use entrant::Entrant;
pub use identity::{Identity, benchmark};
pub use judged::{Judged, doubts, judge, problem_of};
pub use outcome::{Outcome, SolverRun};
pub use own::solve_job;
pub use pages::{History, write_pages};
pub use problem::{ContestCase, Spacing};
pub use race::RaceList;
pub use report::study;
pub use results::{LONGEST_RUN_S, Results, ResultsFault, Seen, StoredEnd, result_files};
