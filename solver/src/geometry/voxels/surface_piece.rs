//! Parts of the surface of a label map within a cube.

use crate::algebra::tensor::Vector3;

/// The part of a surface in one cube that faces one way along one axis, by sums over its
/// triangles.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SurfacePiece {
    /// Indices of the cube.
    pub cube: [u32; 3],
    /// Twice the axis, one more where the normal points up it.
    pub facing: u8,
    /// Sum of the areas times normals \[m²\].
    pub vector_area: Vector3,
    /// Sum of the areas \[m²\].
    pub area: f64,
    /// Sum of the areas times centres \[m³\].
    pub first_moment: Vector3,
    /// Sum of centre · vector area \[m³\].
    pub threefold_volume: f64,
}

impl SurfacePiece {
    /// Both together, in the cube of this one.
    pub fn joined(self, other: SurfacePiece) -> SurfacePiece {
        SurfacePiece {
            vector_area: self.vector_area + other.vector_area,
            area: self.area + other.area,
            first_moment: self.first_moment + other.first_moment,
            threefold_volume: self.threefold_volume + other.threefold_volume,
            ..self
        }
    }
}
