//! Quadrature over the boundary whose points are the boundary nodes.
#![allow(non_snake_case)]

use crate::geometry::Panel;
use crate::neighbours::Neighbours;
use crate::nodes::NodeCloud;
use crate::tensor::{Matrix3, Vector3};
use nalgebra::{Matrix4, Vector4};

/// Shares of every panel of the boundary in the boundary nodes near it.
///
/// A surface integral ∮ g dA becomes Σ_c g(X_c) A_c with A_c = Σ_p A_p ψ_c(p).
/// The shares ψ_c of a panel have the smallest weighted norm among those that
/// reproduce linear functions along its plane. With the nodes as points, the
/// forces of a uniform stress on the boundary are forces at the nodes, where
/// collocation can take them up (method §3).
#[derive(Debug, Clone)]
pub struct SurfaceRule {
    pub panels: Vec<Panel>,
    /// Entries of panel p: `starts[p]..starts[p + 1]`.
    starts: Vec<usize>,
    /// Node of each entry.
    nodes: Vec<u32>,
    /// Share ψ of each entry \[–\].
    shares: Vec<f64>,
}

/// Nodes farther than this from a panel take no share of it \[spacing\]. Larger
/// values smear the boundary, which makes sheared and twisted bodies stiffer (at
/// 1.6 by 2 %), smaller ones make smooth solutions converge more slowly.
const REACH: f64 = 1.2;
/// Nodes farther than this from the plane of a panel, over their distance
/// along it plus a spacing, lie on another face \[–\].
const LIFT: f64 = 0.3;
/// Smallest accepted ratio of the eigenvalues of a moment matrix.
const FLATTEST: f64 = 1e-3;

impl SurfaceRule {
    /// Shares the panels among the boundary nodes of a cloud.
    pub fn new(panels: Vec<Panel>, cloud: &NodeCloud, components: usize) -> SurfaceRule {
        let boundary: Vec<u32> = (0..cloud.positions.len() as u32)
            .filter(|&node| cloud.on_boundary[node as usize])
            .collect();
        let mut rule = SurfaceRule { panels, starts: vec![0], nodes: vec![], shares: vec![] };
        if boundary.is_empty() {
            rule.panels.clear();
            return rule;
        }
        let near = Nearby::new(cloud, &boundary);
        for panel in &rule.panels {
            for (node, share) in near.shares(panel, components) {
                rule.nodes.push(node);
                rule.shares.push(share);
            }
            rule.starts.push(rule.nodes.len());
        }
        rule
    }

    /// Area \[m²\] at each node of the cloud that the chosen panels leave there.
    pub fn areas(&self, nodes: usize, chosen: impl Fn(&Panel) -> bool) -> Vec<f64> {
        let mut areas = vec![0.0; nodes];
        self.scatter(chosen, |node, area, _| areas[node] += area);
        areas
    }

    /// Vector area ∮ N dA \[m²\] at each node of the cloud.
    pub fn vector_areas(&self, nodes: usize) -> Vec<Vector3> {
        let mut areas = vec![Vector3::zeros(); nodes];
        self.scatter(|_| true, |node, area, normal| areas[node] += area * normal);
        areas
    }

    fn scatter(&self, chosen: impl Fn(&Panel) -> bool, mut add: impl FnMut(usize, f64, &Vector3)) {
        for (p, panel) in self.panels.iter().enumerate().filter(|(_, panel)| chosen(panel)) {
            for entry in self.starts[p]..self.starts[p + 1] {
                add(self.nodes[entry] as usize, panel.area * self.shares[entry], &panel.normal);
            }
        }
    }
}

/// The boundary nodes, ready to be found.
struct Nearby<'a> {
    cloud: &'a NodeCloud,
    boundary: &'a [u32],
    cells: Neighbours,
    largest: f64,
}

impl Nearby<'_> {
    fn new<'a>(cloud: &'a NodeCloud, boundary: &'a [u32]) -> Nearby<'a> {
        let positions: Vec<Vector3> =
            boundary.iter().map(|&node| cloud.positions[node as usize]).collect();
        let spacings = boundary.iter().map(|&node| cloud.spacing[node as usize]);
        let largest = spacings.fold(0.0f64, f64::max);
        Nearby { cloud, boundary, cells: Neighbours::new(&positions, largest), largest }
    }

    /// Nodes and shares of one panel; the shares sum to 1.
    fn shares(&self, panel: &Panel, components: usize) -> Vec<(u32, f64)> {
        let mut reach = REACH;
        for _ in 0..6 {
            let candidates = self.candidates(panel, reach);
            if let Some(shares) = linear_shares(&candidates, panel, components) {
                return shares;
            }
            reach *= 1.25;
        }
        self.nearest(panel)
    }

    /// Nodes on the face of the panel, with weights that fall to 0 at `reach`
    /// spacings and offsets in spacings.
    fn candidates(&self, panel: &Panel, reach: f64) -> Vec<(u32, f64, Vector3)> {
        let mut candidates = Vec::new();
        self.cells.for_each_near(&panel.centre, reach * self.largest, |index| {
            let node = self.boundary[index];
            let spacing = self.cloud.spacing[node as usize];
            let offset = (self.cloud.positions[node as usize] - panel.centre) / spacing;
            let lift = offset.dot(&panel.normal);
            let along = (offset - lift * panel.normal).norm();
            let q = offset.norm() / reach;
            if q < 1.0 && lift.abs() < LIFT * (0.2 + along) {
                let weight = (1.0 - q * q).powi(2);
                candidates.push((node, weight, offset * spacing));
            }
        });
        candidates.sort_unstable_by_key(|candidate| candidate.0);
        candidates
    }

    fn nearest(&self, panel: &Panel) -> Vec<(u32, f64)> {
        let distance = |node: &&u32| (self.cloud.positions[**node as usize] - panel.centre).norm();
        let nearest = self.boundary.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.map(|&node| vec![(node, 1.0)]).unwrap_or_default()
    }
}

/// ψ_c = ω_c p_cᵀ M⁻¹ e₁ with p = (1, offset along the panel) and
/// M = Σ ω p pᵀ; `None` where the nodes do not span the plane.
fn linear_shares(
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

/// Changes vector areas as little as possible, in proportion to their sizes,
/// until Σ a_c = 0 and Σ X_c ⊗ a_c = V I over the nodes of one body; returns
/// V \[m³\]. Only so can consistent gradients exist.
pub fn close(
    areas: &mut [Vector3],
    positions: &[Vector3],
    nodes: &[u32],
    components: usize,
) -> f64 {
    let size = |areas: &[Vector3], node: u32| areas[node as usize].norm();
    let total: f64 = nodes.iter().map(|&node| size(areas, node)).sum();
    if total == 0.0 {
        return 0.0;
    }
    let centre =
        nodes.iter().map(|&node| positions[node as usize] * size(areas, node)).sum::<Vector3>()
            / total;
    let length = (nodes.iter())
        .map(|&node| (positions[node as usize] - centre).norm())
        .fold(f64::MIN_POSITIVE, f64::max);
    let p = |node: u32| {
        let x = (positions[node as usize] - centre) / length;
        Vector4::new(1.0, x.x, x.y, x.z)
    };
    let mut gram = Matrix4::zeros();
    let mut moments = nalgebra::Matrix4x3::<f64>::zeros();
    for &node in nodes {
        gram += size(areas, node) * p(node) * p(node).transpose();
        moments += p(node) * areas[node as usize].transpose();
    }
    let volume =
        (0..components).map(|k| moments[(k + 1, k)]).sum::<f64>() * length / components as f64;
    for k in 0..components {
        moments[(k + 1, k)] -= volume / length;
    }
    if components == 2 {
        gram[(3, 3)] = 1.0;
        moments.row_mut(3).fill(0.0);
    }
    if let Some(factor) = gram.cholesky() {
        let change = factor.solve(&moments);
        let sizes: Vec<f64> = nodes.iter().map(|&node| size(areas, node)).collect();
        for (&node, size) in nodes.iter().zip(sizes) {
            areas[node as usize] -= size * change.transpose() * p(node);
        }
    }
    volume
}
