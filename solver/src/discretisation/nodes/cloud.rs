//! A node cloud and its largest size.

use crate::algebra::tensor::Vector3;
use crate::geometry::{GeometryError, at_most};

/// Nodes in the reference configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeCloud {
    /// \[node\], \[m\]
    pub positions: Vec<Vector3>,
    /// Local nodal spacing \[node\], \[m\].
    pub spacing: Vec<f64>,
    /// Whether a node lies on the boundary of the body \[node\].
    pub on_boundary: Vec<bool>,
}

impl NodeCloud {
    /// Nodes of which the first `boundary` lie on the boundary.
    pub(super) fn boundary_first(
        positions: Vec<Vector3>,
        boundary: usize,
        spacing: impl Fn(&Vector3) -> f64,
    ) -> NodeCloud {
        let spacing = positions.iter().map(spacing).collect();
        let on_boundary = (0..positions.len()).map(|node| node < boundary).collect();
        NodeCloud { positions, spacing, on_boundary }
    }

    /// \[m\]
    pub fn smallest_spacing(&self) -> f64 {
        self.spacing.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Refuses a cloud of too many nodes, before it is made where possible.
pub(super) fn refuse_too_many(count: f64) -> Result<(), GeometryError> {
    at_most("nodes", count, 2e7)
}
