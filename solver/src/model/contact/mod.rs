//! Nodes against rigid obstacles given as signed distance (method book, section 16).

mod check;
mod plan;
mod report;

pub(crate) use check::check_obstacles;
pub use plan::{ContactForce, ContactPlan, ContactState, gap};
pub(crate) use plan::{normal, onto_surface};
pub use report::{ContactResult, ContactSurface};
