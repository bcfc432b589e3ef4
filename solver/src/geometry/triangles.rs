//! Triangles: cutting polygons into them and them into smaller ones.

use super::primitives::anticlockwise;
use crate::algebra::tensor::Vector3;

/// Corners of a triangle \[m\], anticlockwise seen from outside the solid.
pub(super) type Triangle = [Vector3; 3];

/// Area times unit normal \[m²\].
pub(super) fn area_vector(t: &Triangle) -> Vector3 {
    0.5 * (t[1] - t[0]).cross(&(t[2] - t[0]))
}

/// Halves the longest edge until no edge is longer than `size` \[m\].
pub(super) fn subdivide(triangle: Triangle, size: f64, keep: &mut impl FnMut(Triangle)) {
    let mut stack = vec![triangle];
    while let Some(t) = stack.pop() {
        let lengths = [0, 1, 2].map(|k| (t[(k + 1) % 3] - t[k]).norm());
        let longest = (0..3).fold(0, |l, k| if lengths[k] > lengths[l] { k } else { l });
        if lengths[longest] <= size {
            keep(t);
            continue;
        }
        let [a, b, c] = [0, 1, 2].map(|k| t[(longest + k) % 3]);
        let middle = 0.5 * (a + b);
        stack.push([a, middle, c]);
        stack.push([middle, b, c]);
    }
}

/// Cuts a simple polygon into anticlockwise triangles by clipping ears.
pub(super) fn triangulate(points: &[[f64; 2]]) -> Vec<[[f64; 2]; 3]> {
    let mut left = anticlockwise(points);
    let mut triangles = Vec::new();
    while left.len() > 3 {
        let n = left.len();
        // A simple polygon always has an ear; rounding may hide it, and then
        // the flattest corner goes.
        let ear = (0..n).find(|&i| is_ear(&left, i)).unwrap_or(0);
        triangles.push([left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]]);
        left.remove(ear);
    }
    triangles.push([left[0], left[1], left[2]]);
    triangles
}

fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn is_ear(points: &[[f64; 2]], i: usize) -> bool {
    let n = points.len();
    let (a, b, c) = (points[(i + n - 1) % n], points[i], points[(i + 1) % n]);
    if turn(a, b, c) < 0.0 {
        return false;
    }
    let corner = |p: &[f64; 2]| *p == a || *p == b || *p == c;
    !points
        .iter()
        .filter(|p| !corner(p))
        .any(|&p| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0)
}
