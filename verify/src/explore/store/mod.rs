//! The run store: what has been run is on record, one file per run, and is not run
//! again.
//!
//! A run is keyed by what decides its result: the case file with the recipe and the
//! cloud seed written into it, every file that it refers to, the kind of run, the
//! instants that are looked at and the sources of the solver. A record is written
//! to the side and renamed, so that a program that is killed leaves whole records
//! or none.

mod affine;
mod disk;
mod held;
mod jobs;
mod record;
mod runs;
mod task;

pub use disk::{Store, StoreError};
pub use jobs::COMPRESSIONS;
pub use record::{Outcome, Record, Stage, Timings};
pub use runs::{Progress, Stopped, perform_all};
pub use task::{Job, Source, Task, solver_identity};
