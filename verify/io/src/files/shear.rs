//! Images whose steps from voxel to voxel are not perpendicular.

use mtled::algebra::tensor::{Matrix3, Vector3};

/// Cosines of steps that count as perpendicular are less.
pub(crate) const PERPENDICULAR: f64 = 1e-4;
/// Images with larger ones are refused.
pub(crate) const LARGEST_SHEAR: f64 = 0.5;

/// The largest cosine between two steps \[–\].
pub(crate) fn largest_cosine(directions: &Matrix3) -> f64 {
    let pairs = [(0, 1), (0, 2), (1, 2)].map(|(first, second)| {
        let (a, b) = (directions.column(first), directions.column(second));
        (a.dot(&b) / (a.norm() * b.norm())).abs()
    });
    pairs.into_iter().fold(0.0, f64::max)
}

/// Size, centre of the first voxel and steps of the grid around all voxels of a sheared one. Its
/// steps are as long and turned as little as possible: by the rotation of the polar decomposition.
pub(crate) fn upright(
    size: [usize; 3],
    origin: &Vector3,
    directions: &Matrix3,
) -> ([usize; 3], Vector3, Matrix3) {
    let step = Vector3::from_fn(|axis, _| directions.column(axis).norm());
    let unit = Matrix3::from_fn(|row, axis| directions[(row, axis)] / step[axis]);
    let parts = unit.svd(true, true);
    let rotation = parts.u.zip(parts.v_t).map_or(unit, |(u, v)| u * v);
    let end = |axis: usize, high: usize| high as f64 * size[axis] as f64 - 0.5;
    let infinite = Vector3::repeat(f64::INFINITY);
    let (mut lower, mut upper) = (infinite, -infinite);
    for corner in 0..8usize {
        let index = Vector3::from_fn(|axis, _| end(axis, corner >> axis & 1));
        let place = (rotation.transpose() * directions * index).component_div(&step);
        (lower, upper) = (lower.inf(&place), upper.sup(&place));
    }
    // Its voxels are in line with the first one.
    let first = lower.map(|c| (c + 0.5).floor());
    let last = upper.map(|c| (c - 0.5).ceil());
    let size = [0, 1, 2].map(|axis| (last[axis] - first[axis]) as usize + 1);
    let steps = rotation * Matrix3::from_diagonal(&step);
    (size, origin + steps * first, steps)
}
