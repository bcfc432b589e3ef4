//! A node cloud and its finest spacing.

use crate::algebra::tensor::Vector3;
use crate::geometry::{GeometryError, NODES, Shape, lattice_cells};
use crate::problem::Dimension;

/// Nodes in the reference configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeCloud {
    /// \[node\], \[m\]
    pub positions: Vec<Vector3>,
    /// Local nodal spacing \[node\], \[m\].
    pub spacing: Vec<f64>,
    /// Whether a node lies on the boundary of the body \[node\].
    pub on_boundary: Vec<bool>,
    /// Whether a node lies on the border of what is held as a volume \[node\]; empty where
    /// nothing is.
    pub on_border: Vec<bool>,
}

impl NodeCloud {
    /// Mean nodal spacing \[m\].
    pub fn mean_spacing(&self) -> f64 {
        self.spacing.iter().sum::<f64>() / self.spacing.len() as f64
    }

    /// Nodes of which the first `boundary` lie on the boundary.
    pub(super) fn boundary_first(
        positions: Vec<Vector3>,
        boundary: usize,
        spacing: impl Fn(&Vector3) -> f64,
    ) -> NodeCloud {
        let spacing = positions.iter().map(spacing).collect();
        let on_boundary = (0..positions.len()).map(|node| node < boundary).collect();
        NodeCloud { positions, spacing, on_boundary, on_border: Vec::new() }
    }

    /// Keeps the nodes for which `stays` \[node\] is true.
    pub(super) fn retain(&mut self, stays: &[bool]) {
        fn kept<T: Copy>(values: &[T], stays: &[bool]) -> Vec<T> {
            values.iter().zip(stays).filter(|(_, stays)| **stays).map(|(value, _)| *value).collect()
        }
        self.positions = kept(&self.positions, stays);
        self.spacing = kept(&self.spacing, stays);
        self.on_boundary = kept(&self.on_boundary, stays);
    }

    /// \[m\]
    pub fn smallest_spacing(&self) -> f64 {
        self.spacing.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Refuses a spacing \[m\] at which a lattice over the bounding box of a body has too
/// many nodes.
pub fn refuse_fine_spacing(
    body: &Shape,
    spacing: f64,
    dimension: &Dimension,
) -> Result<(), GeometryError> {
    let (lower, upper) = body.finite_bounds(dimension)?;
    let edges = (upper - lower).rows(0, dimension.components()).clone_owned();
    NODES.check(edges.map(|edge| lattice_cells(edge, spacing) as f64 + 1.0).product())
}
