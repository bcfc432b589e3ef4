//! One piece of the boundary.

use crate::algebra::tensor::Vector3;
use crate::geometry::dimension::Dimension;

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

/// About how many pieces of `size` cover the faces of a box, in a plane its outline.
pub(super) fn pieces_of_box(edges: &Vector3, size: f64, dimension: &Dimension) -> f64 {
    let n = edges / size;
    match dimension {
        Dimension::Three => 2.0 * (n.x * n.y + n.y * n.z + n.z * n.x),
        Dimension::PlaneStrain { .. } => 2.0 * (n.x + n.y),
    }
}
