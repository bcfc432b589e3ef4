//! The gate: a run beside a committed baseline. What counts as the same comes
//! from theory, from the reference's error bar or from measured scatter over
//! clouds ([`band`]); [`judge`] compares, [`mod@update`] writes the baseline anew.

pub mod band;
pub mod baseline;
pub mod clouds;
pub mod judge;
mod student;
pub mod update;

pub use baseline::{Baseline, GateError, read_baseline};
pub use clouds::Clouds;
pub use judge::{compare, compare_runs};
pub use update::{Reason, difference, update};
