//! The division of a panel among the boundary nodes near it.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::mls::Approximation;
use crate::discretisation::neighbours::Neighbours;
use crate::discretisation::nodes::NodeCloud;
use crate::geometry::Panel;

/// Nodes farther than this from a panel get no part of it \[spacing\]. Larger
/// values smear the boundary, which makes sheared and twisted bodies stiffer (at
/// 1.6 by 2 %).
const REACH: f64 = 1.2;
/// Nodes farther than this from the plane of a panel, over their distance
/// along it plus a spacing, lie on another face \[–\].
const LIFT: f64 = 0.3;
/// Smallest accepted ratio of the eigenvalues of a moment matrix.
const FLATTEST: f64 = 1e-3;
/// The boundary nodes, sorted for a search by position.
pub(super) struct BoundaryNodes<'a> {
    pub cloud: &'a NodeCloud,
    approximation: &'a Approximation,
    boundary: &'a [u32],
    cells: Neighbours,
    largest: f64,
}

impl BoundaryNodes<'_> {
    pub fn new<'a>(
        cloud: &'a NodeCloud,
        boundary: &'a [u32],
        approximation: &'a Approximation,
    ) -> BoundaryNodes<'a> {
        let positions: Vec<Vector3> =
            boundary.iter().map(|&node| cloud.positions[node as usize]).collect();
        let spacings = boundary.iter().map(|&node| cloud.spacing[node as usize]);
        let largest = spacings.fold(0.0f64, f64::max);
        let cells = Neighbours::new(&positions, largest);
        BoundaryNodes { cloud, approximation, boundary, cells, largest }
    }

    /// Nodes and fractions of one panel; the fractions sum to 1.
    pub fn fractions(&self, panel: &Panel, components: usize) -> Vec<(u32, f64)> {
        let mut reach = REACH;
        for _ in 0..6 {
            let candidates = self.candidates(panel, reach);
            if let Some(fractions) = linear_fractions(&candidates, panel, components) {
                return fractions;
            }
            reach *= 1.25;
        }
        self.nearest(panel).map(|node| vec![(node, 1.0)]).unwrap_or_default()
    }

    /// Nodes on the face of the panel, with weights that fall to 0 at `reach`
    /// spacings and offsets in spacings.
    fn candidates(&self, panel: &Panel, reach: f64) -> Vec<(u32, f64, Vector3)> {
        let mut candidates = Vec::new();
        self.cells.for_each_within(&panel.centre, reach * self.largest, |index, offset| {
            let node = self.boundary[index];
            let spacing = self.cloud.spacing[node as usize];
            let offset = offset / spacing;
            let lift = offset.dot(&panel.normal);
            let along = (offset - lift * panel.normal).norm();
            let q = offset.norm() / reach;
            if q < 1.0 && lift.abs() < LIFT * (0.2 + along) {
                let weight = (1.0 - q * q).powi(2);
                candidates.push((node, weight, offset * spacing));
            }
        });
        candidates.sort_unstable_by_key(|candidate| candidate.0);
        let mut seen: Vec<u32> = candidates.iter().map(|candidate| candidate.0).collect();
        self.approximation.keep_seen(&panel.centre, &mut seen);
        candidates.retain(|candidate| seen.binary_search(&candidate.0).is_ok());
        candidates
    }

    /// The boundary node nearest to a panel.
    pub fn nearest(&self, panel: &Panel) -> Option<u32> {
        let distance = |node: &u32| (self.cloud.positions[*node as usize] - panel.centre).norm();
        self.boundary.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

/// ψ_c = ω_c p_cᵀ M⁻¹ e₁ with p = (1, offset along the panel) and
/// M = Σ ω p pᵀ (method book, eq. 8.2); `None` where the nodes do not span the
/// plane.
fn linear_fractions(
    candidates: &[(u32, f64, Vector3)],
    panel: &Panel,
    components: usize,
) -> Option<Vec<(u32, f64)>> {
    let total: f64 = candidates.iter().map(|c| c.1).sum();
    if candidates.len() < components {
        return None;
    }
    let mean: Vector3 = candidates.iter().map(|c| c.2 * c.1).sum::<Vector3>() / total;
    let along = Matrix3::identity() - panel.normal * panel.normal.transpose();
    let mut scatter = Matrix3::zeros();
    for (_, weight, offset) in candidates {
        let t = along * (offset - mean);
        scatter += *weight * t * t.transpose();
    }
    // In a plane the third direction is empty, the normal always is.
    let scale = scatter.trace() / (components - 1) as f64;
    let empty = match components {
        2 => panel.normal * panel.normal.transpose() + Matrix3::from_diagonal(&Vector3::z()),
        _ => panel.normal * panel.normal.transpose(),
    };
    let filled = scatter + scale * empty;
    let eigenvalues = filled.symmetric_eigenvalues();
    if !(scale > 0.0 && eigenvalues.min() > FLATTEST * scale) {
        return None;
    }
    let slope = filled.try_inverse()? * (along * mean);
    Some(
        candidates
            .iter()
            .map(|(node, weight, offset)| {
                let t = along * (offset - mean);
                (*node, weight * (1.0 / total - slope.dot(&t)))
            })
            .collect(),
    )
}
