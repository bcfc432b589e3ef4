//! Areas, orders and parts of polygons given by their corners.

use std::collections::BTreeMap;

/// Signed area of a polygon \[m²\], positive if it runs anticlockwise.
pub fn polygon_area(points: &[[f64; 2]]) -> f64 {
    let n = points.len();
    (0..n)
        .map(|i| {
            let (a, b) = (points[i], points[(i + 1) % n]);
            0.5 * (a[0] * b[1] - a[1] * b[0])
        })
        .sum()
}

/// The points in anticlockwise order.
pub fn anticlockwise(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut points = points.to_vec();
    if polygon_area(&points) < 0.0 {
        points.reverse();
    }
    points
}

/// Cuts a simple polygon into anticlockwise triangles by clipping ears.
pub fn triangulate(points: &[[f64; 2]]) -> Vec<[[f64; 2]; 3]> {
    let mut left = anticlockwise(points);
    let mut triangles = Vec::new();
    while left.len() > 3 {
        let n = left.len();
        // A simple polygon always has an ear; rounding may hide it, and then
        // the first corner is cut off.
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

/// Twice the area between an edge and a point on it, over that of the ear \[–\].
const ON_EDGE: f64 = 1e-9;

fn is_ear(points: &[[f64; 2]], i: usize) -> bool {
    let n = points.len();
    let (a, b, c) = (points[(i + n - 1) % n], points[i], points[(i + 1) % n]);
    if turn(a, b, c) < 0.0 {
        return false;
    }
    // A corner on the edge that would be cut is inside, whatever its last digit.
    let on_edge = -ON_EDGE * turn(a, b, c);
    let corner = |p: &[f64; 2]| *p == a || *p == b || *p == c;
    !points
        .iter()
        .filter(|p| !corner(p))
        .any(|&p| [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| turn(from, to, p) >= on_edge))
}

/// Splits a map from each item to the next one into closed chains.
pub fn closed_chains<T: Ord + Copy>(mut next: BTreeMap<T, T>) -> Vec<Vec<T>> {
    let mut chains = Vec::new();
    while let Some((&start, _)) = next.first_key_value() {
        let mut chain = Vec::new();
        let mut at = start;
        while let Some(after) = next.remove(&at) {
            chain.push(at);
            at = after;
        }
        chains.push(chain);
    }
    chains
}
