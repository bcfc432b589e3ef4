//! Triangles of a surface and the file that they came from.

use mtled::algebra::tensor::Vector3;

/// Triangles that share vertices where the file repeats their coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Triangles {
    /// \[m\]
    pub vertices: Vec<Vector3>,
    /// Indices of the corners \[triangle\].
    pub triangles: Vec<[u32; 3]>,
}

/// A surface as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceFile {
    /// Along R, A and S.
    pub surface: Triangles,
    /// What should be known about the file.
    pub notes: Vec<String>,
}
