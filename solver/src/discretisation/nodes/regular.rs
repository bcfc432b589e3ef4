//! Lattices, straight and jittered.
#![allow(non_snake_case)]

use crate::algebra::random::Random;
use crate::algebra::tensor::Vector3;
use crate::discretisation::nodes::cloud::NodeCloud;
use crate::geometry::{
    BoundaryPoints, CLEARANCE, GeometryError, Shape, TargetSpacing, boundary_points, indices,
    lattice_cells, project,
};
use crate::problem::Dimension;

/// Smallest distance of jittered nodes from the boundary \[spacing\].
const JITTER_CLEARANCE: f64 = 0.25;

/// Cells per direction and their edges \[m\]; none along z in a plane.
fn lattice(
    lower: &Vector3,
    upper: &Vector3,
    spacing: f64,
    dimension: &Dimension,
) -> ([usize; 3], Vector3) {
    let length = upper - lower;
    let axes = dimension.components();
    let cells = [0, 1, 2].map(|k| if k < axes { lattice_cells(length[k], spacing) } else { 0 });
    let step = Vector3::from_fn(|k, _| if k < axes { length[k] / cells[k] as f64 } else { 0.0 });
    (cells, step)
}

/// A lattice that includes the faces of a box. The spacing of a node is the
/// largest edge of a cell. Jittered nodes on a face move within it.
pub(super) fn in_box(
    min: &Vector3,
    max: &Vector3,
    spacing: f64,
    jitter: Option<(f64, u64)>,
    dimension: &Dimension,
) -> NodeCloud {
    let (mut lower, mut upper) = (*min, *max);
    if let Dimension::PlaneStrain { z, .. } = dimension {
        (lower.z, upper.z) = (*z, *z);
    }
    let (cells, step) = lattice(&lower, &upper, spacing, dimension);
    let mut random = jitter.map(|(size, seed)| (size, Random(seed)));
    let (mut positions, mut on_boundary) = (Vec::new(), Vec::new());
    for at in indices(cells.map(|n| n + 1)) {
        let face = |axis: usize| at[axis] == 0 || at[axis] == cells[axis];
        let shift = random.as_mut().map(|(size, random)| *size * random.vector(3));
        positions.push(Vector3::from_fn(|axis, _| match (at[axis], shift) {
            (0, _) => lower[axis],
            (n, _) if n == cells[axis] => upper[axis],
            (n, by) => lower[axis] + (n as f64 + by.map_or(0.0, |by| by[axis])) * step[axis],
        }));
        on_boundary.push((0..dimension.components()).any(face));
    }
    let spacing = vec![step.max(); positions.len()];
    NodeCloud { positions, spacing, on_boundary, on_border: Vec::new() }
}

/// Boundary points, and lattice points that are far enough inside.
pub(super) fn in_solid(
    body: &Shape,
    spacing: f64,
    jitter: Option<(f64, u64)>,
    dimension: &Dimension,
) -> Result<NodeCloud, GeometryError> {
    let (lower, upper) = body.finite_bounds(dimension)?;
    let (cells, step) = lattice(&lower, &upper, spacing, dimension);
    let target = TargetSpacing { at: &|_| spacing, smallest: spacing, largest: spacing };
    let mut boundary = boundary_points(body, &target, dimension)?;
    let at = |ijk: [usize; 3]| lower + Vector3::from(ijk.map(|n| n as f64)).component_mul(&step);
    let mut inner: Vec<Vector3> = indices(cells.map(|n| n + 1))
        .map(at)
        .filter(|X| body.signed_distance(X) < -CLEARANCE * spacing)
        .collect();
    if let Some((size, seed)) = jitter {
        let mut random = Random(seed);
        slide(body, &mut boundary, size * spacing, &mut random, dimension);
        for X in &mut inner {
            let moved = *X + size * spacing * dimension.in_plane(random.vector(3));
            if body.signed_distance(&moved) < -JITTER_CLEARANCE * spacing {
                *X = moved;
            }
        }
    }
    let count = boundary.points.len();
    let mut positions = boundary.points;
    positions.append(&mut inner);
    Ok(NodeCloud::boundary_first(positions, count, |_| spacing))
}

/// Moves boundary nodes along the boundary by up to `reach` \[m\] per
/// direction, unless they sit on a corner or edge or would turn one.
fn slide(
    body: &Shape,
    boundary: &mut BoundaryPoints,
    reach: f64,
    random: &mut Random,
    dimension: &Dimension,
) {
    let corners: Vec<Vector3> = boundary.points[..boundary.fixed].to_vec();
    for X in &mut boundary.points[boundary.fixed..] {
        let normal = body.gradient(X);
        let shift = reach * dimension.in_plane(random.vector(3));
        let moved = project(body, &(*X + shift - shift.dot(&normal) * normal));
        let turned = body.gradient(&moved).dot(&normal) < 0.8;
        let clear = |corner: &Vector3| (corner - moved).norm() > reach.min((corner - *X).norm());
        if !turned && body.signed_distance(&moved).abs() < 1e-6 * reach && corners.iter().all(clear)
        {
            *X = moved;
        }
    }
}
