//! Quadrature points of the volume (method book, section 7).

mod cell;
mod cut;
mod gauss;
mod grid;
mod subdivision;

pub use grid::{Quadrature, quadrature, quadrature_following};
pub use subdivision::{NodalSpacing, followed_edge};

#[cfg(test)]
mod tests;
