//! Zero-energy modes of a few nodes, found at a cost that grows with their number only.
#![allow(non_snake_case)]

use super::least_captured::CapturedMotion;
use super::pencil::Pencil;
use crate::discretisation::Discretisation;
use crate::discretisation::rows::Rows;
use nalgebra::DMatrix;

/// Most neighbourhoods that are tested, those with the fewest points first.
const MOST_TESTED: usize = 100;
/// Radius of a neighbourhood over the spacing of its node \[–\]: about 20 nodes in space,
/// more where the points are so few that the nodes are much closer than they.
const RADIUS: f64 = 1.75;
/// Nodes of a neighbourhood, the nearest.
const MOST_NODES: usize = 32;

/// Quadrature points per nodal spacing squared, cubed in space, about a node \[–\]: the
/// number of points that it supports over their volume, both weighted by φ (method book,
/// eq. 22.3); infinite within what is held as a volume.
pub(super) fn points_per_spacing(discretisation: &Discretisation) -> Vec<f64> {
    let (rows, cloud) = (&discretisation.supports, &discretisation.cloud);
    let mut counted = vec![(0.0, 0.0); cloud.positions.len()];
    for (q, weight) in discretisation.quadrature.weights.iter().enumerate() {
        for entry in rows.row(q) {
            let (count, volume) = &mut counted[rows.nodes[entry] as usize];
            *count += rows.phi[entry].abs();
            *volume += weight * rows.phi[entry].abs();
        }
    }
    let (d, thickness) =
        (discretisation.dimension.components(), discretisation.dimension.thickness());
    let density = |(node, (count, volume)): (usize, (f64, f64))| match volume {
        0.0 => f64::INFINITY,
        volume => count * thickness * cloud.spacing[node].powi(d as i32) / volume,
    };
    counted.into_iter().enumerate().map(density).collect()
}

/// The least captured motion in which only a node of `sparse` and its neighbours move,
/// of the neighbourhoods with the fewest points. Motions of the whole body are captured
/// no better than the worst of a few nodes (Cauchy's interlacing theorem), so that none is
/// found in vain.
pub(super) fn least_captured_nearby(
    pencil: &Pencil,
    density: &[f64],
    mut sparse: Vec<u32>,
) -> Option<CapturedMotion> {
    sparse.sort_by(|&a, &b| density[a as usize].total_cmp(&density[b as usize]).then(a.cmp(&b)));
    let nodes = pencil.model.positions.len();
    let (model, finer) = (
        points_of_nodes(&pencil.discretisation.supports, nodes),
        points_of_nodes(&pencil.finer, nodes),
    );
    let held = held_components(pencil);
    let mut done = vec![false; nodes];
    let mut least: Option<CapturedMotion> = None;
    let mut tested = 0;
    for node in sparse {
        if done[node as usize] || tested == MOST_TESTED {
            continue;
        }
        tested += 1;
        let own = neighbourhood(pencil, node as usize);
        own.iter().take(own.len() / 2).for_each(|&other| done[other as usize] = true);
        let freedoms = freedoms(&own, &held, pencil.model.components);
        if freedoms.is_empty() {
            continue;
        }
        let by_model = local_form(
            &pencil.discretisation.supports,
            &pencil.discretisation.quadrature.weights,
            &own,
            &model,
            &freedoms,
        );
        let by_finer = local_form(&pencil.finer, &pencil.finer_weights, &own, &finer, &freedoms);
        let Some(fraction) = smallest_quotient(by_model, by_finer) else { continue };
        if least.is_none_or(|found| fraction < found.fraction) {
            let position = pencil.model.positions[node as usize];
            least = Some(CapturedMotion { fraction, node: node as usize, position });
        }
    }
    least
}

/// The nearest nodes, the node itself first.
fn neighbourhood(pencil: &Pencil, node: usize) -> Vec<u32> {
    let cloud = &pencil.discretisation.cloud;
    let X = cloud.positions[node];
    let reach = RADIUS * cloud.spacing[node];
    let mut near: Vec<(f64, u32)> = Vec::new();
    pencil.discretisation.approximation.for_each_node_within(&X, reach, |other, distance| {
        near.push((distance, other));
    });
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    near.into_iter().take(MOST_NODES).map(|(_, other)| other).collect()
}

/// Components of nodes that some condition at t = 0 acts upon \[component of node\].
fn held_components(pencil: &Pencil) -> Vec<bool> {
    let mut held = vec![false; pencil.model.size()];
    for (component, rows) in &pencil.constraints {
        for &node in &rows.nodes {
            held[pencil.model.components * node as usize + component] = true;
        }
    }
    held
}

/// The unknowns of the neighbourhood that no condition acts upon: (place in it, component).
fn freedoms(own: &[u32], held: &[bool], d: usize) -> Vec<(usize, usize)> {
    let all = (0..own.len()).flat_map(|place| (0..d).map(move |k| (place, k)));
    all.filter(|&(place, k)| !held[d * own[place] as usize + k]).collect()
}

/// The points that each node supports.
fn points_of_nodes(rows: &Rows, nodes: usize) -> Vec<Vec<u32>> {
    let mut points = vec![Vec::new(); nodes];
    for q in 0..rows.len() {
        for entry in rows.row(q) {
            points[rows.nodes[entry] as usize].push(q as u32);
        }
    }
    points
}

/// vᵀKv = Σ_q w_q ε_q : ε_q of the motions of the freedoms.
fn local_form(
    rows: &Rows,
    weights: &[f64],
    own: &[u32],
    points_of: &[Vec<u32>],
    freedoms: &[(usize, usize)],
) -> DMatrix<f64> {
    let mut points: Vec<u32> =
        own.iter().flat_map(|&node| &points_of[node as usize]).copied().collect();
    points.sort_unstable();
    points.dedup();
    let mut form = DMatrix::zeros(freedoms.len(), freedoms.len());
    for q in points.into_iter().map(|q| q as usize) {
        let gradient = |place: usize| {
            rows.row(q)
                .find(|&entry| rows.nodes[entry] == own[place])
                .map(|entry| rows.grad_phi[entry])
        };
        let gradients: Vec<_> = (0..own.len()).map(gradient).collect();
        for (i, &(a, k)) in freedoms.iter().enumerate() {
            let Some(g) = gradients[a] else { continue };
            for (j, &(b, l)) in freedoms[..=i].iter().enumerate() {
                let Some(h) = gradients[b] else { continue };
                // ε : ε of the unit motions k of a and l of b.
                let same = if k == l { g.dot(&h) } else { 0.0 };
                form[(i, j)] += 0.5 * weights[q] * (same + g[l] * h[k]);
            }
        }
    }
    form.fill_upper_triangle_with_lower_triangle();
    form
}

/// The smallest λ of K v = λ K̂ v.
fn smallest_quotient(model: DMatrix<f64>, finer: DMatrix<f64>) -> Option<f64> {
    let lower = finer.cholesky()?.l();
    let half = lower.solve_lower_triangular(&model)?;
    let reduced = lower.solve_lower_triangular(&half.transpose())?;
    Some(reduced.symmetric_eigenvalues().min())
}
