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

impl Quadrature {
    /// All parts in their order.
    pub(super) fn joined(parts: Vec<Quadrature>) -> Quadrature {
        let mut all = Quadrature::default();
        for part in parts {
            all.positions.extend(part.positions);
            all.weights.extend(part.weights);
            all.regions.extend(part.regions);
            all.cells += part.cells;
            all.cut_cells += part.cut_cells;
        }
        all
    }

    /// Takes points from the one numbered `first` back.
    pub(super) fn truncate(&mut self, first: usize) {
        self.positions.truncate(first);
        self.weights.truncate(first);
        self.regions.truncate(first);
    }
}
