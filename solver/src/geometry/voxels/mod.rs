//! Segmented images as solids.

mod grid;
mod label_field;
mod label_map;

pub(crate) use grid::{KnownDistance, ScalarGrid, indices};
pub use label_field::LabelField;
pub use label_map::LabelMap;

#[cfg(test)]
mod tests;
