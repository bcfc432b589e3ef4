//! The gate compares a run with a committed baseline. What counts as the same follows
//! from theory, from the error bar of a reference or from the measured scatter over
//! clouds, which are runs of the same code on other random inputs ([`band`]); [`judge`]
//! compares, [`mod@update`] writes a new baseline.

pub mod band;
pub mod baseline;
pub mod clouds;
pub mod judge;
mod student;
pub mod update;

pub use baseline::{Baseline, GateError, read_baseline};
pub use clouds::Clouds;
pub use judge::{compare, compare_runs, settle};
pub use update::{Reason, difference, update};
