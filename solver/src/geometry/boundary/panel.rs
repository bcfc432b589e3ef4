//! One piece of the boundary.

use crate::algebra::tensor::Vector3;

/// A piece of the boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Panel {
    /// \[m\]
    pub centre: Vector3,
    /// \[m²\]; in plane strain length times thickness.
    pub area: f64,
    /// Unit vector out of the solid.
    pub normal: Vector3,
}

/// Number of pieces of at most `size` in `length`.
pub(super) fn pieces(length: f64, size: f64) -> usize {
    ((length / size) * (1.0 - 1e-9)).ceil().max(1.0) as usize
}
