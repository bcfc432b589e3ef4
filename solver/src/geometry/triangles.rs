//! Triangles in space.

use crate::algebra::tensor::Vector3;
use parry3d_f64::math::Vector as ParryVector;
use std::collections::HashMap;

/// Corners of a triangle \[m\], anticlockwise seen from outside the solid.
pub(super) type Triangle = [Vector3; 3];

/// A point as the library of triangle meshes has it.
pub(super) fn parry(v: &Vector3) -> ParryVector {
    ParryVector::new(v.x, v.y, v.z)
}

/// Area times unit normal \[m²\].
pub(super) fn area_vector(t: &Triangle) -> Vector3 {
    0.5 * (t[1] - t[0]).cross(&(t[2] - t[0]))
}

/// Volume \[m³\] enclosed by the triangles of a closed surface, as the sum of their tetrahedra
/// with `apex`.
pub(super) fn enclosed_volume(triangles: impl Iterator<Item = Triangle>, apex: Vector3) -> f64 {
    let o = apex;
    triangles.map(|[a, b, c]| (a - o).dot(&(b - o).cross(&(c - o))) / 6.0).sum()
}

/// Lengths that differ by less are equal, so that round-off does not choose an edge or divide a
/// triangle of just the right size \[–\].
const EQUAL: f64 = 1e-9;

/// Halves the longest edge, the first of several, until no edge is longer than `size` \[m\].
pub(super) fn subdivide(mut t: Triangle, size: f64, keep: &mut impl FnMut(Triangle)) {
    let mut halves = Vec::new();
    loop {
        let lengths = [0, 1, 2].map(|k| (t[(k + 1) % 3] - t[k]).norm());
        let longest =
            (0..3).fold(0, |l, k| if lengths[k] > (1.0 + EQUAL) * lengths[l] { k } else { l });
        if lengths[longest] <= (1.0 + EQUAL) * size {
            keep(t);
            match halves.pop() {
                Some(half) => t = half,
                None => return,
            }
            continue;
        }
        let [a, b, c] = [0, 1, 2].map(|k| t[(longest + k) % 3]);
        let middle = 0.5 * (a + b);
        halves.push([a, middle, c]);
        t = [middle, b, c];
    }
}

/// Points without those of equal coordinates, and the number among them of each.
pub(super) fn merged<'a>(points: impl Iterator<Item = &'a Vector3>) -> (Vec<Vector3>, Vec<u32>) {
    let mut first = HashMap::new();
    let mut merged: Vec<Vector3> = Vec::new();
    let mut numbers = Vec::new();
    for v in points {
        // Adding zero turns −0 into 0.
        let v = v.add_scalar(0.0);
        numbers.push(*first.entry([v.x, v.y, v.z].map(f64::to_bits)).or_insert_with(|| {
            merged.push(v);
            merged.len() as u32 - 1
        }));
    }
    (merged, numbers)
}
