//! Errors of a run: its values compared with a reference solution that has its own
//! error bar.

mod difference;
mod equal_error;
mod finest;
mod group;
mod own_reference;
mod own_runs;
pub mod patch;
mod reference_solution;
mod values;

pub use difference::{Difference, difference};
pub use equal_error::{Cost, cost_at};
pub use group::Group;
pub use own_reference::{own_reference_text, stored_reference};
pub use own_runs::from_own_runs;
pub use reference_solution::ReferenceSolution;
pub use values::{SAMPLES, values};
