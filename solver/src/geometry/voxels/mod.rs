//! Segmented images as solids.

mod grid;
mod hand_on;
mod label_blocks;
mod label_field;
mod label_map;
mod surface_piece;
mod zero_level;

pub(crate) use grid::{ScalarGrid, indices};
pub(crate) use hand_on::KnownDistance;
pub use label_field::LabelField;
pub use label_map::LabelMap;
pub(crate) use surface_piece::SurfacePiece;

#[cfg(test)]
mod tests;
