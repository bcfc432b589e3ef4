//! Quadrature over the boundary.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::mls::{Approximation, PoorSupport};
use crate::discretisation::moments::take_moments;
use crate::discretisation::neighbours::Neighbours;
use crate::discretisation::nodes::NodeCloud;
use crate::discretisation::rows::{Rows, Wanted};
use crate::geometry::Panel;
use rayon::prelude::*;

/// Surface integrals ∮ φ_a g dA as Σ_i φ_a(X_i) g_i over points of the boundary.
///
/// A panel is a point of its own where the boundary is free. Where all nodes near
/// it are held, it is shared among them: only at nodes can collocation take up the
/// forces of a uniform stress (method §3). The shares ψ_c of such a panel have the
/// smallest weighted norm among those that reproduce linear functions along its
/// plane; then the strengths at the nodes are changed towards
/// Σ_c φ_a(X_c) g_c = Σ_p φ_a(p) g_p over the panels p, moments kept.
#[derive(Debug, Clone, Default)]
pub struct SurfaceRule {
    pub panels: Vec<Panel>,
    /// φ at the middle of each panel.
    panel_rows: Rows,
    /// Points and shares of panel p: `starts[p]..starts[p + 1]`.
    starts: Vec<usize>,
    points: Vec<u32>,
    /// \[–\]
    shares: Vec<f64>,
    /// The points: `held` nodes first, then free panels \[m\].
    positions: Vec<Vector3>,
    held: Vec<u32>,
    /// φ at the held nodes.
    held_rows: Rows,
    /// The panels that are points.
    free: Vec<u32>,
    /// Node and closed vector area \[m²\] of each point, if all of them are held.
    pub held_areas: Vec<(u32, Vector3)>,
}

/// Nodes farther than this from a panel take no share of it \[spacing\]. Larger
/// values smear the boundary, which makes sheared and twisted bodies stiffer (at
/// 1.6 by 2 %).
const REACH: f64 = 1.2;
/// Nodes farther than this from the plane of a panel, over their distance
/// along it plus a spacing, lie on another face \[–\].
const LIFT: f64 = 0.3;
/// Smallest accepted ratio of the eigenvalues of a moment matrix.
const FLATTEST: f64 = 1e-3;
/// Steps of the strengths at nodes down the gradient of ½ Σ_a (Σ_c φ_a(X_c) g_c −
/// Σ_p φ_a(p) g_p)². More change reactions by 0.1 %; at the minimum the strengths
/// oscillate.
const SWEEPS: usize = 3;

impl SurfaceRule {
    /// Finds the points of a boundary; `held` tells which nodes are prescribed.
    pub fn new(
        panels: Vec<Panel>,
        cloud: &NodeCloud,
        approximation: &Approximation,
        held: &[bool],
        components: usize,
    ) -> Result<SurfaceRule, (Vector3, PoorSupport)> {
        let nodes = |on: &[bool]| -> Vec<u32> {
            (0..on.len() as u32).filter(|&node| on[node as usize]).collect()
        };
        let boundary = nodes(&cloud.on_boundary);
        let mut held: Vec<u32> = nodes(held);
        held.retain(|&node| cloud.on_boundary[node as usize]);
        let at = |node: &u32| cloud.positions[*node as usize];
        let near = Nearby::new(cloud, &boundary);
        let (centres, panel_rows) = panel_rows(&panels, approximation, &near)?;
        let positions: Vec<Vector3> = held.iter().map(at).collect();
        let held_rows = values_at(approximation, &positions)?;
        let shared = |panel: &Panel| -> Option<Vec<(u32, f64)>> {
            let shares = if held.is_empty() { Vec::new() } else { near.shares(panel, components) };
            let point =
                |(node, share): (u32, f64)| Some((held.binary_search(&node).ok()? as u32, share));
            let points: Option<Vec<_>> = shares.into_iter().map(point).collect();
            points.filter(|points| !points.is_empty())
        };
        let shared: Vec<_> = panels.par_iter().map(shared).collect();
        let mut rule = SurfaceRule {
            panels,
            panel_rows,
            starts: vec![0],
            positions,
            held,
            held_rows,
            ..SurfaceRule::default()
        };
        for (panel, points) in shared.into_iter().enumerate() {
            match points {
                Some(points) => {
                    rule.points.extend(points.iter().map(|(point, _)| point));
                    rule.shares.extend(points.iter().map(|(_, share)| share));
                }
                None => {
                    rule.points.push(rule.positions.len() as u32);
                    rule.shares.push(1.0);
                    rule.positions.push(centres[panel]);
                    rule.free.push(panel as u32);
                }
            }
            rule.starts.push(rule.points.len());
        }
        Ok(rule)
    }

    /// φ at a point: rows and the one of them.
    fn row(&self, point: usize) -> (&Rows, usize) {
        match point.checked_sub(self.held.len()) {
            None => (&self.held_rows, point),
            Some(free) => (&self.panel_rows, self.free[free] as usize),
        }
    }

    /// Strengths g_i of a density g on the panels, with its resultant and first
    /// moments, linear in g.
    pub fn strengths(&self, nodes: usize, g: impl Fn(&Panel) -> Vector3) -> Vec<Vector3> {
        let mut strengths = vec![Vector3::zeros(); self.positions.len()];
        let held = self.held.len();
        let mut sizes = vec![0.0; held];
        let mut wanted = vec![Vector3::zeros(); nodes];
        for (p, panel) in self.panels.iter().enumerate() {
            let strength = panel.area * g(panel);
            let entries = self.starts[p]..self.starts[p + 1];
            let shared = (self.points[entries.start] as usize) < held;
            for entry in entries {
                let point = self.points[entry] as usize;
                strengths[point] += self.shares[entry] * strength;
                if shared {
                    sizes[point] += (self.shares[entry] * panel.area).abs();
                }
            }
            if shared {
                add((&self.panel_rows, p), &strength, &mut wanted);
            }
        }
        let own: Vec<usize> = (0..held).collect();
        for _ in 0..SWEEPS {
            let mut rest = wanted.clone();
            for (c, strength) in strengths[..held].iter().enumerate() {
                add((&self.held_rows, c), &-strength, &mut rest);
            }
            let rows = &self.held_rows;
            let value = |entry: usize| rows.phi[entry] * rest[rows.nodes[entry] as usize];
            let mut change: Vec<Vector3> =
                (0..held).map(|c| rows.row(c).map(value).sum()).collect();
            take_moments(&mut change, &sizes, &self.positions, &own, |moments, _| moments);
            strengths.iter_mut().zip(&change).for_each(|(strength, change)| *strength += change);
        }
        strengths
    }

    /// Keeps the closed areas where no point of the boundary is free.
    pub fn keep(&mut self, areas: Vec<Vector3>) {
        if self.held.len() == areas.len() {
            self.held_areas = self.held.iter().copied().zip(areas).collect();
        }
    }

    /// Σ_i φ_a(X_i) g_i at each of `nodes` nodes.
    pub fn spread(&self, nodes: usize, strengths: &[Vector3]) -> Vec<Vector3> {
        let mut sums = vec![Vector3::zeros(); nodes];
        for (point, strength) in strengths.iter().enumerate() {
            add(self.row(point), strength, &mut sums);
        }
        sums
    }

    /// Changes vector areas as little as possible, in proportion to their sizes,
    /// until Σ a_i = 0 and Σ X_i ⊗ a_i = V I over the points of one body, whose
    /// nodes `owns` tells; returns V \[m³\]. Only so can consistent gradients exist.
    pub fn close(
        &self,
        areas: &mut [Vector3],
        components: usize,
        owns: impl Fn(u32) -> bool,
    ) -> f64 {
        let first = |point: usize| {
            let (rows, row) = self.row(point);
            rows.nodes[rows.starts[row]]
        };
        let own: Vec<usize> = (0..areas.len()).filter(|&point| owns(first(point))).collect();
        let sizes: Vec<f64> = areas.iter().map(|area| area.norm()).collect();
        let mut volume = 0.0;
        take_moments(areas, &sizes, &self.positions, &own, |mut moments, length| {
            let trace: f64 = (0..components).map(|k| moments[(k + 1, k)]).sum();
            volume = trace * length / components as f64;
            for k in 0..components {
                moments[(k + 1, k)] -= trace / components as f64;
            }
            moments
        });
        volume
    }
}

fn add((rows, row): (&Rows, usize), strength: &Vector3, sums: &mut [Vector3]) {
    for entry in rows.row(row) {
        sums[rows.nodes[entry] as usize] += rows.phi[entry] * strength;
    }
}

/// Middles of the panels and φ there. A panel that the nodes do not reach stands
/// where the nearest one does.
fn panel_rows(
    panels: &[Panel],
    approximation: &Approximation,
    near: &Nearby,
) -> Result<(Vec<Vector3>, Rows), (Vector3, PoorSupport)> {
    let mut centres: Vec<Vector3> = panels.iter().map(|panel| panel.centre).collect();
    if let Ok(rows) = values_at(approximation, &centres) {
        return Ok((centres, rows));
    }
    centres.par_iter_mut().zip(panels).for_each(|(centre, panel)| {
        if approximation.evaluate(centre).is_err() {
            let nearest = near.nearest(panel);
            *centre = nearest.map_or(*centre, |node| near.cloud.positions[node as usize]);
        }
    });
    let rows = values_at(approximation, &centres)?;
    Ok((centres, rows))
}

/// φ without its gradients.
fn values_at(
    approximation: &Approximation,
    positions: &[Vector3],
) -> Result<Rows, (Vector3, PoorSupport)> {
    Rows::at(approximation, positions, Wanted::Values)
        .map(|evaluated| evaluated.rows)
        .map_err(|(point, poor)| (positions[point], poor))
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
        candidates
    }

    fn nearest(&self, panel: &Panel) -> Option<u32> {
        let distance = |node: &u32| (self.cloud.positions[*node as usize] - panel.centre).norm();
        self.boundary.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)))
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
