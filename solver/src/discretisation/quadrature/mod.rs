//! Quadrature points of the volume (method book, section 7).

mod borders;
mod boundary_cut;
mod cell;
mod cut;
mod gauss;
mod grid;
mod pieces;
mod rule;
mod second_order;
mod simplex;
mod subdivision;
mod voxel_cuts;

pub use grid::{quadrature, quadrature_following};
pub use rule::Quadrature;
pub use second_order::Moves;
pub use subdivision::{NodalSpacing, followed_edge};

#[cfg(test)]
mod tests;
