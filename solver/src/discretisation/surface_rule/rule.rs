//! Quadrature points of the boundary and the strengths there.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::{Approximation, PoorSupport};
use crate::discretisation::moments::reduce_moments;
use crate::discretisation::nodes::NodeCloud;
use crate::discretisation::rows::{Requested, Rows};
use crate::discretisation::surface_rule::panel_fractions::BoundaryNodes;
use crate::geometry::Panel;
use rayon::prelude::*;

/// Surface integrals ∮ φ_a g dA as Σ_i φ_a(X_i) g_i over points of the boundary.
///
/// A panel is a point of its own where the boundary is free. Where all nodes near
/// it are prescribed, it is divided among them: only at nodes can collocation take
/// up the forces of a uniform stress. The fractions ψ_c of such a panel have the
/// smallest weighted norm among those that reproduce linear functions along its
/// plane; then the strengths at the nodes are moved towards
/// Σ_c φ_a(X_c) g_c = Σ_p φ_a(p) g_p over the panels p, moments kept (method
/// book, section 8).
#[derive(Debug, Clone, Default)]
pub struct SurfaceRule {
    /// The pieces of the boundary.
    pub panels: Vec<Panel>,
    /// Their longest edge \[m\].
    pub panel_size: f64,
    /// φ at the centre of each panel.
    panel_rows: Rows,
    /// Points and fractions of panel p: `starts[p]..starts[p + 1]`.
    starts: Vec<usize>,
    points: Vec<u32>,
    /// \[–\]
    fractions: Vec<f64>,
    /// The points: `prescribed` nodes first, then free panels \[m\].
    positions: Vec<Vector3>,
    prescribed: Vec<u32>,
    /// Which components of the displacement are prescribed there.
    held: Vec<[bool; 3]>,
    /// φ at the prescribed nodes.
    prescribed_rows: Rows,
    /// The panels that are points.
    free: Vec<u32>,
    /// Node and closed vector area \[m²\] of each point, if all points are
    /// prescribed nodes; otherwise empty.
    pub prescribed_areas: Vec<(u32, Vector3)>,
}

/// Steps of the strengths at nodes down the gradient of ½ Σ_a (Σ_c φ_a(X_c) g_c −
/// Σ_p φ_a(p) g_p)². More change reactions by 0.1 %; at the minimum the strengths
/// oscillate.
const SWEEPS: usize = 3;

/// Component of a strength over the largest one up to which it does not act \[–\]: round-off.
const ALONG: f64 = 1e-6;

impl SurfaceRule {
    /// The points of a boundary; of the nodes some components of the displacement are `held`.
    pub fn new(
        (panels, panel_size): (Vec<Panel>, f64),
        cloud: &NodeCloud,
        approximation: &Approximation,
        held: &[[bool; 3]],
        components: usize,
    ) -> Result<SurfaceRule, (Vector3, PoorSupport)> {
        let nodes = || 0..cloud.positions.len() as u32;
        let on_boundary = |node: &u32| cloud.on_boundary[*node as usize];
        let boundary: Vec<u32> = nodes().filter(on_boundary).collect();
        let prescribed: Vec<u32> =
            nodes().filter(|node| on_boundary(node) && is_held(&held[*node as usize])).collect();
        let near = BoundaryNodes::new(cloud, &boundary, approximation);
        let (centres, panel_rows) = panel_rows(&panels, approximation, &near)?;
        let positions: Vec<Vector3> =
            prescribed.iter().map(|&node| cloud.positions[node as usize]).collect();
        let prescribed_rows = values_at(approximation, &positions)?;
        let divide = |panel: &Panel| -> Option<Vec<(u32, f64)>> {
            if prescribed.is_empty() {
                return None;
            }
            let point = |(node, fraction): (u32, f64)| {
                Some((prescribed.binary_search(&node).ok()? as u32, fraction))
            };
            let points: Option<Vec<_>> =
                near.fractions(panel, components).into_iter().map(point).collect();
            points.filter(|points| !points.is_empty())
        };
        let divided: Vec<_> = panels.par_iter().map(divide).collect();
        let mut rule = SurfaceRule {
            panels,
            panel_size,
            panel_rows,
            starts: vec![0],
            positions,
            held: prescribed.iter().map(|&node| held[node as usize]).collect(),
            prescribed,
            prescribed_rows,
            ..SurfaceRule::default()
        };
        for (panel, points) in divided.into_iter().enumerate() {
            rule.add_panel(panel, points, centres[panel]);
        }
        Ok(rule)
    }

    /// Adds the points and fractions of the next panel; without any it is free.
    fn add_panel(&mut self, panel: usize, points: Option<Vec<(u32, f64)>>, centre: Vector3) {
        match points {
            Some(points) => {
                self.points.extend(points.iter().map(|(point, _)| point));
                self.fractions.extend(points.iter().map(|(_, fraction)| fraction));
            }
            None => {
                self.points.push(self.positions.len() as u32);
                self.fractions.push(1.0);
                self.positions.push(centre);
                self.free.push(panel as u32);
            }
        }
        self.starts.push(self.points.len());
    }

    /// The points: prescribed nodes first, then free panels \[m\].
    pub fn positions(&self) -> &[Vector3] {
        &self.positions
    }

    /// How many of them are prescribed nodes.
    pub fn prescribed_count(&self) -> usize {
        self.prescribed.len()
    }

    /// The panels that are points, after the prescribed nodes.
    pub fn free_panels(&self) -> &[u32] {
        &self.free
    }

    /// φ at a point: the rows and which of them.
    fn row(&self, point: usize) -> (&Rows, usize) {
        match point.checked_sub(self.prescribed.len()) {
            None => (&self.prescribed_rows, point),
            Some(free) => (&self.panel_rows, self.free[free] as usize),
        }
    }

    /// Strengths g_i of a density g on the panels, each with its number, with its resultant and first
    /// moments, linear in g (method book, eq. 8.3).
    pub fn strengths(&self, nodes: usize, g: impl Fn(usize, &Panel) -> Vector3) -> Vec<Vector3> {
        let mut strengths = vec![Vector3::zeros(); self.positions.len()];
        let count = self.prescribed.len();
        let mut sizes = vec![0.0; count];
        let mut acting = vec![Vector3::zeros(); count];
        let mut target = vec![Vector3::zeros(); nodes];
        for (p, panel) in self.panels.iter().enumerate() {
            let strength = panel.area * g(p, panel);
            let entries = self.starts[p]..self.starts[p + 1];
            let divided = (self.points[entries.start] as usize) < count;
            for entry in entries {
                let point = self.points[entry] as usize;
                strengths[point] += self.fractions[entry] * strength;
                if divided {
                    sizes[point] += (self.fractions[entry] * panel.area).abs();
                    acting[point] += (self.fractions[entry] * strength).abs();
                }
            }
            if divided {
                add((&self.panel_rows, p), &strength, &mut target);
            }
        }
        let changing = self.changing(&acting);
        for _ in 0..SWEEPS {
            let mut rest = target.clone();
            for (c, strength) in strengths[..count].iter().enumerate() {
                add((&self.prescribed_rows, c), &-strength, &mut rest);
            }
            let rows = &self.prescribed_rows;
            let value = |entry: usize| rows.phi[entry] * rest[rows.nodes[entry] as usize];
            let change: Vec<Vector3> = (0..count).map(|c| rows.row(c).map(value).sum()).collect();
            self.add_change(&change, &changing, &sizes, &mut strengths);
        }
        strengths
    }

    /// Which components of the strengths at prescribed nodes may change, by what acts there: those
    /// that are prescribed, or act already. What flowed along a face of which only the normal
    /// component is held, nothing would take up.
    fn changing(&self, acting: &[Vector3]) -> Vec<[bool; 3]> {
        let of = |(held, acting): (&[bool; 3], &Vector3)| {
            [0, 1, 2].map(|k| held[k] || acting[k] > ALONG * acting.max())
        };
        self.held.iter().zip(acting).map(of).collect()
    }

    /// Adds the part of changes at the prescribed nodes without affine moments.
    fn add_change(
        &self,
        change: &[Vector3],
        changing: &[[bool; 3]],
        sizes: &[f64],
        strengths: &mut [Vector3],
    ) {
        let own: Vec<usize> = (0..self.prescribed.len()).collect();
        let mut add = |of: &dyn Fn(usize) -> Vector3| {
            let held = |c: usize| of(c).component_mul(&change[c]);
            let mut change: Vec<Vector3> = own.iter().map(|&c| held(c)).collect();
            let sizes: Vec<f64> = own.iter().map(|&c| sizes[c] * of(c).max()).collect();
            reduce_moments(&mut change, &sizes, &self.positions, &own, |moments, _| moments);
            strengths.iter_mut().zip(&change).for_each(|(strength, change)| *strength += change);
        };
        if changing.iter().flatten().all(|changes| *changes) {
            return add(&|_| Vector3::repeat(1.0));
        }
        let along = |k: usize, c: usize| Vector3::ith(k, f64::from(u8::from(changing[c][k])));
        (0..3).for_each(|k| add(&|c| along(k, c)));
    }

    /// Stores the closed areas of the points where none of them is free.
    pub fn store_areas(&mut self, areas: Vec<Vector3>) {
        if self.prescribed.len() == areas.len() {
            self.prescribed_areas = self.prescribed.iter().copied().zip(areas).collect();
        }
    }

    /// Σ_i φ_a(X_i) g_i at each of `nodes` nodes (method book, eq. 8.1).
    pub fn scatter(&self, nodes: usize, strengths: &[Vector3]) -> Vec<Vector3> {
        let mut sums = vec![Vector3::zeros(); nodes];
        for (point, strength) in strengths.iter().enumerate() {
            add(self.row(point), strength, &mut sums);
        }
        sums
    }

    /// Changes vector areas as little as possible, in proportion to their sizes,
    /// until Σ a_i = 0 and Σ X_i ⊗ a_i = V I over the points of the body whose nodes
    /// satisfy `owns` (method book, eq. 8.4); returns V \[m³\]. Consistent gradients
    /// exist only then.
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
        reduce_moments(areas, &sizes, &self.positions, &own, |mut moments, length| {
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

/// Whether some component is.
pub(crate) fn is_held(components: &[bool; 3]) -> bool {
    components.iter().any(|held| *held)
}

fn add((rows, row): (&Rows, usize), strength: &Vector3, sums: &mut [Vector3]) {
    for entry in rows.row(row) {
        sums[rows.nodes[entry] as usize] += rows.phi[entry] * strength;
    }
}

/// Centres of the panels and φ there; a panel beyond the reach of the nodes is
/// moved to the nearest one.
fn panel_rows(
    panels: &[Panel],
    approximation: &Approximation,
    near: &BoundaryNodes,
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
    Rows::at(approximation, positions, Requested::Values)
        .map(|evaluated| evaluated.rows)
        .map_err(|(point, poor)| (positions[point], poor))
}
