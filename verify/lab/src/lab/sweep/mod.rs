//! Studies of a user's own cases: the recipe is changed over ranges, every combination is
//! run once and stored, and the records become tables and figures.

mod axis;
mod convergence;
mod curves;
mod definition;
mod plan;
mod reference;
mod study;
mod subject;
mod tables;

pub use axis::Axis;
pub(crate) use axis::{AxisError, combinations, equal, refuse_too_many_runs};
pub use definition::Sweep;
pub use plan::Plan;
pub(crate) use reference::find_reference;
pub use reference::{REFINEMENT, ReferenceSource};
pub use subject::Subject;
