//! Points and weights.

use crate::algebra::tensor::Vector3;

/// Quadrature points of the whole body.
#[derive(Debug, Clone, Default)]
pub struct Quadrature {
    /// \[point\] \[m\]
    pub positions: Vec<Vector3>,
    /// `quadrature_weight`, a reference volume \[point\] \[m³\].
    pub weights: Vec<f64>,
    /// Index of the region that each point belongs to \[point\].
    pub regions: Vec<u16>,
    /// Cells that gave points.
    pub cells: usize,
    /// Cells cut by the boundary or by a border between regions.
    pub cut_cells: usize,
}
