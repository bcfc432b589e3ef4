//! Nodes given one by one.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Vector3, bounding_box};
use crate::discretisation::nodes::cloud::NodeCloud;
use crate::geometry::{GeometryError, NODES, PointHash, Shape};
use crate::problem::Dimension;
use rayon::prelude::*;

/// A node this close to the boundary is on it \[spacing\].
const ON_BOUNDARY: f64 = 0.25;
/// A node farther outside the body is refused \[spacing\].
const OUTSIDE: f64 = 0.5;

/// The positions as given. The spacing is the mean distance to the nearest
/// four nodes in a plane, six in space (method book, eq. 5.2).
pub(super) fn given(
    body: &Shape,
    nodes: &[Vector3],
    dimension: &Dimension,
) -> Result<NodeCloud, GeometryError> {
    let count = nodes.len();
    let needed = dimension.components() + 1;
    if count == 0 {
        return Err(GeometryError::NoNodes);
    }
    if count < needed {
        return Err(GeometryError::TooFewNodes { count, needed });
    }
    NODES.check(count as f64)?;
    if !nodes.iter().all(|X| X.iter().all(|c| c.is_finite())) {
        return Err(GeometryError::NotFinite { name: "the list of given nodes" });
    }
    refuse_far_nodes(body, nodes, dimension)?;
    let hash = hashed(nodes, dimension);
    let nearest: Vec<Vec<(f64, usize)>> = (0..count)
        .into_par_iter()
        .map(|node| hash.nearest(&nodes[node], node, 2 * dimension.components()))
        .collect();
    let mut cloud = NodeCloud::boundary_first(Vec::new(), 0, |_| 0.0);
    cloud.positions = nodes.to_vec();
    for (node, near) in nearest.iter().enumerate() {
        let spacing = near.iter().map(|(d, _)| d).sum::<f64>() / near.len() as f64;
        let (distance, other) = near[0];
        if distance <= 1e-9 * spacing {
            let (first, second) = (node.min(other), node.max(other));
            return Err(GeometryError::DuplicateNodes { first, second, distance });
        }
        let distance = body.signed_distance(&nodes[node]);
        if distance > OUTSIDE * spacing {
            return Err(GeometryError::NodeOutside { node, distance, spacing });
        }
        cloud.spacing.push(spacing);
        cloud.on_boundary.push(distance.abs() < ON_BOUNDARY * spacing);
    }
    Ok(cloud)
}

/// Refuses a node that is farther from the bounding box of the body than the body is
/// large, as where a coordinate has lost its decimal point or a file is in millimetres.
pub fn refuse_far_nodes(
    body: &Shape,
    nodes: &[Vector3],
    dimension: &Dimension,
) -> Result<(), GeometryError> {
    let (lower, upper) = body.finite_bounds(dimension)?;
    let extent = (upper - lower).norm();
    let is_near = |X: &Vector3| {
        let beyond = dimension.in_plane((lower - X).sup(&(X - upper)));
        beyond.max() <= extent
    };
    match nodes.iter().position(|X| !is_near(X)) {
        Some(node) => {
            Err(GeometryError::NodeFarOutside { node, position: nodes[node].into(), extent })
        }
        None => Ok(()),
    }
}

fn hashed(nodes: &[Vector3], dimension: &Dimension) -> PointHash {
    let (lower, upper) = bounding_box(nodes);
    let largest = (upper - lower).max().max(f64::MIN_POSITIVE);
    // About the spacing, if the nodes filled their bounding box.
    let across = (nodes.len() as f64).powf(1.0 / dimension.components() as f64);
    let mut hash = PointHash::new(0.5 * largest / across, 4.0 * largest / across);
    nodes.iter().for_each(|X| hash.insert(*X));
    hash
}
