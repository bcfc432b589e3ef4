//! Finite-element references: stored values of two codes on three meshes each,
//! with an error bar from the meshes ([`richardson`]) and a second opinion from
//! the other code ([`agreement`]).

pub mod agreement;
pub mod compare;
mod format;
mod quantity;
mod read;
pub mod richardson;

pub use agreement::{Agreement, ReferenceValues, agreements};
pub use format::{Mesh, ReferenceFile, Solution, Values};
pub use quantity::{Family, Quantity, is_dynamic, quantities};
pub use read::{CODES, ReferenceError, read_reference, title_of};
pub use richardson::Basis;
