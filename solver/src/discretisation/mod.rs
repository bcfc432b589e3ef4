//! Nodes, quadrature points, supports, φ and Grad φ: all that does not depend
//! on materials or conditions.

mod bridged_gap;
pub mod consistency;
mod discretised_body;
mod footprint;
mod held_volume;
mod holding;
pub mod mls;
pub mod moments;
pub mod neighbours;
pub mod nodes;
mod patch_pieces;
pub mod patches;
mod placed_nodes;
pub mod quadrature;
pub mod rows;
mod shape_memory;
pub mod surface_rule;
mod warning;
mod weight_function;

pub use bridged_gap::BridgedGap;
pub use discretised_body::Discretisation;
pub(crate) use discretised_body::quadrature_of;
pub use footprint::Footprint;
pub use held_volume::{HeldShape, HeldVolume, selects};
pub use rows::Rows;
pub use warning::Warning;
