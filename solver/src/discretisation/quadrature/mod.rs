//! Quadrature points of the volume (method book, section 7).

mod cell;
mod cut;
mod gauss;
mod grid;

pub use grid::{Quadrature, quadrature};

#[cfg(test)]
mod tests;
