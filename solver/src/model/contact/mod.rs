//! Nodes against rigid obstacles given as signed distance (method book, section 16).

mod between;
mod check;
mod crossing;
mod impact;
mod placed;
mod plan;
mod report;
mod state;
mod touch;
mod unresolved;
mod values;

pub(crate) use check::check_obstacles;
pub use impact::Impacts;
pub(crate) use impact::Moved;
pub use placed::Placed;
pub(crate) use plan::Components;
pub use plan::{ContactForce, ContactPlan};
pub use report::{ContactResult, ContactSurface};
pub use state::{ContactState, ContactStep};
