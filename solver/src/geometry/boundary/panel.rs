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
    /// Length of the mean of the normals that `area` × `normal` stands for: 1 where the panel
    /// is flat or belongs to the rule of a whole solid, less where it is curved \[–\].
    pub flatness: f64,
}

impl Panel {
    /// Of a flat panel.
    pub(crate) fn flat(centre: Vector3, area: f64, normal: Vector3) -> Panel {
        Panel { centre, area, normal, flatness: 1.0 }
    }

    /// ∫ N dA over the area \[–\].
    pub fn mean_normal(&self) -> Vector3 {
        self.flatness * self.normal
    }
}

/// Number of pieces of at most `size` in `length`, but for a millionth: a body may be that much
/// larger by round-off, far from the origin or turned.
pub(super) fn pieces(length: f64, size: f64) -> usize {
    ((length / size) * (1.0 - 1e-6)).ceil().max(1.0) as usize
}

/// About how many pieces of `size` cover the faces of a box, in a plane its outline.
pub(super) fn pieces_of_box(edges: &Vector3, size: f64, dimension: &Dimension) -> f64 {
    let n = edges / size;
    match dimension {
        Dimension::Three => 2.0 * (n.x * n.y + n.y * n.z + n.z * n.x),
        Dimension::PlaneStrain { .. } => 2.0 * (n.x + n.y),
    }
}
