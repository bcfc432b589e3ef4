//! Pieces of the boundary with their geometry, so that they can be cut at a curve.

mod chart;
mod clip;
mod piece;

pub use chart::Chart;
pub use clip::Level;
pub use piece::Patch;
