//! The run store: a file with a record for each run, so that no run is repeated.
//!
//! The key of a record hashes what decides the result: the case file with the recipe
//! and the cloud seed written into it, every file that it refers to, the kind of run, the
//! instants of its values and the sources of the solver. A record is written to a
//! temporary file and renamed, so that a program that is killed leaves complete records
//! only.

mod boundary_misfit;
mod disk;
mod jobs;
mod patch_test;
mod perform;
pub(super) mod record;
mod runs;
mod seal;
mod task;

pub use disk::{Contents, Corrupt, Store};
pub use jobs::{JobPlan, Planned, read_part};
pub(crate) use perform::COMPRESSIONS;
pub(crate) use record::Stage;
pub use record::{RunOutcome, RunRecord};
pub use runs::{Progress, Stopped, TaskRunner};
pub use seal::sealed;
pub(crate) use task::Task;
pub use task::{Job, Source, solver_identity};
