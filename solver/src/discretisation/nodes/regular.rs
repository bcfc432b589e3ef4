//! Lattices, straight and jittered.
#![allow(non_snake_case)]

use super::random::SplitMix64;
use super::{NodeCloud, refuse_too_many};
use crate::algebra::tensor::Vector3;
use crate::geometry::{
    BoundaryPoints, GeometryError, Shape, Sizes, boundary_points_sized, lattice_cells, project,
};
use crate::problem::Dimension;

/// Lattice nodes this far inside stay clear of the boundary nodes \[spacing\].
const CLEARANCE: f64 = 0.5;
/// A jittered node may come this close to the boundary \[spacing\].
const JITTER_CLEARANCE: f64 = 0.25;

/// Cells per direction and their edges \[m\]; none along z in a plane.
fn lattice(
    lower: &Vector3,
    upper: &Vector3,
    spacing: f64,
    dimension: &Dimension,
) -> Result<([usize; 3], Vector3), GeometryError> {
    let length = upper - lower;
    let axes = dimension.components();
    let estimate = |k: usize| if k < axes { (length[k] / spacing).round().max(1.0) } else { 0.0 };
    refuse_too_many((0..3).map(|k| estimate(k) + 1.0).product())?;
    let cells = [0, 1, 2].map(|k| if k < axes { lattice_cells(length[k], spacing) } else { 0 });
    let step = Vector3::from_fn(|k, _| if k < axes { length[k] / cells[k] as f64 } else { 0.0 });
    Ok((cells, step))
}

/// A lattice that includes the faces of a box. The spacing of a node is the
/// largest edge of a cell. Jittered nodes on a face move within it.
pub(super) fn in_box(
    min: &Vector3,
    max: &Vector3,
    spacing: f64,
    jitter: Option<(f64, u64)>,
    dimension: &Dimension,
) -> Result<NodeCloud, GeometryError> {
    let (mut lower, mut upper) = (*min, *max);
    if let Dimension::PlaneStrain { z, .. } = dimension {
        (lower.z, upper.z) = (*z, *z);
    }
    let (cells, step) = lattice(&lower, &upper, spacing, dimension)?;
    let mut random = jitter.map(|(size, seed)| (size, SplitMix64(seed)));
    let (mut positions, mut on_boundary) = (Vec::new(), Vec::new());
    for k in 0..=cells[2] {
        for j in 0..=cells[1] {
            for i in 0..=cells[0] {
                let at = [i, j, k];
                let face = |axis: usize| at[axis] == 0 || at[axis] == cells[axis];
                let move_by = random.as_mut().map(|(size, random)| *size * random.vector());
                positions.push(Vector3::from_fn(|axis, _| match (at[axis], move_by) {
                    (0, _) => lower[axis],
                    (n, _) if n == cells[axis] => upper[axis],
                    (n, by) => {
                        lower[axis] + (n as f64 + by.map_or(0.0, |by| by[axis])) * step[axis]
                    }
                }));
                on_boundary.push((0..dimension.components()).any(face));
            }
        }
    }
    let spacing = vec![step.max(); positions.len()];
    Ok(NodeCloud { positions, spacing, on_boundary })
}

/// Boundary points, and lattice points that are far enough inside.
pub(super) fn in_solid(
    body: &Shape,
    spacing: f64,
    jitter: Option<(f64, u64)>,
    dimension: &Dimension,
) -> Result<NodeCloud, GeometryError> {
    let (lower, upper) = body.finite_bounds(dimension)?;
    let (cells, step) = lattice(&lower, &upper, spacing, dimension)?;
    let sizes = Sizes { at: &|_| spacing, smallest: spacing, largest: spacing };
    let mut boundary = boundary_points_sized(body, &sizes, dimension)?;
    let mut inner = Vec::new();
    for k in 0..=cells[2] {
        for j in 0..=cells[1] {
            for i in 0..=cells[0] {
                let X = lower + Vector3::new(i as f64, j as f64, k as f64).component_mul(&step);
                if body.signed_distance(&X) < -CLEARANCE * spacing {
                    inner.push(X);
                }
            }
        }
    }
    if let Some((size, seed)) = jitter {
        let mut random = SplitMix64(seed);
        slide(body, &mut boundary, size * spacing, &mut random, dimension);
        for X in &mut inner {
            let moved = *X + size * spacing * in_dimension(random.vector(), dimension);
            if body.signed_distance(&moved) < -JITTER_CLEARANCE * spacing {
                *X = moved;
            }
        }
    }
    let count = boundary.points.len();
    let mut positions = boundary.points;
    positions.append(&mut inner);
    let on_boundary = (0..positions.len()).map(|n| n < count).collect();
    let spacing = vec![spacing; positions.len()];
    Ok(NodeCloud { positions, spacing, on_boundary })
}

pub(super) fn in_dimension(mut v: Vector3, dimension: &Dimension) -> Vector3 {
    if let Dimension::PlaneStrain { .. } = dimension {
        v.z = 0.0;
    }
    v
}

/// Moves boundary nodes along the boundary by up to `reach` \[m\] per
/// direction, unless they sit on a corner or edge or would turn one.
fn slide(
    body: &Shape,
    boundary: &mut BoundaryPoints,
    reach: f64,
    random: &mut SplitMix64,
    dimension: &Dimension,
) {
    let corners: Vec<Vector3> = boundary.points[..boundary.fixed].to_vec();
    for X in &mut boundary.points[boundary.fixed..] {
        let normal = body.gradient(X);
        let wish = reach * in_dimension(random.vector(), dimension);
        let moved = project(body, &(*X + wish - wish.dot(&normal) * normal));
        let turned = body.gradient(&moved).dot(&normal) < 0.8;
        let clear = |corner: &Vector3| (corner - moved).norm() > reach.min((corner - *X).norm());
        if !turned && body.signed_distance(&moved).abs() < 1e-6 * reach && corners.iter().all(clear)
        {
            *X = moved;
        }
    }
}
