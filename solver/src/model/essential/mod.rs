//! Essential conditions: prescribed displacements and how they are enforced
//! (method book, section 15).

mod collocation;
mod constraints;
mod mean_gradient;
mod reactions;
mod rows;
mod shared;

pub use constraints::{ConstraintForces, ConstraintSet, Constraints};
pub use reactions::Reaction;
pub use rows::ConstraintRow;
pub(crate) use shared::check_shared_nodes;
