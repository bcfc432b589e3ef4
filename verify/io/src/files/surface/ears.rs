//! Polygons in space cut into triangles, ear by ear (Meisters 1975).
#![allow(non_snake_case)]

use mtled::algebra::tensor::Vector3;

/// Why a polygon cannot be cut.
#[derive(Debug, PartialEq)]
pub(crate) enum CutError {
    /// Its edges cross, near this place \[m\].
    Crossed { at: Vector3 },
    /// It has more corners than the search for ears, whose time grows with their square, takes.
    TooMany { corners: usize, most: usize },
}

/// The most corners of a polygon.
const MOST: usize = 4000;

/// Areas below this are none, in terms of the square of the size of the polygon \[–\].
const FLAT: f64 = 1e-14;

/// Appends the triangles of a polygon of these vertices, which may be concave and need not lie
/// in a plane. Of the ears that can be cut off, that of the shortest diagonal is: a rule that
/// does not depend on the corner with which the polygon starts. What has no area, as a polygon
/// of two different corners, has no triangles.
pub(crate) fn cut(
    vertices: &[Vector3],
    corners: &[u32],
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), CutError> {
    if let [a, b, c] = *corners {
        triangles.push([a, b, c]);
        return Ok(());
    }
    let mut left = corners.to_vec();
    left.dedup();
    while left.len() > 1 && left.first() == left.last() {
        left.pop();
    }
    if left.len() > MOST {
        return Err(CutError::TooMany { corners: left.len(), most: MOST });
    }
    let polygon = Polygon { vertices, normal: normal(vertices, &left) };
    while left.len() > 3 {
        let ear = polygon.ear(&left);
        let at = vertices[left[0] as usize];
        let n = ear.ok_or(CutError::Crossed { at })?;
        triangles.push(around(&left, n));
        left.remove(n);
    }
    triangles.extend(<[u32; 3]>::try_from(left).ok());
    Ok(())
}

/// Twice the area of a polygon times its normal \[m²\] (Newell).
fn normal(vertices: &[Vector3], corners: &[u32]) -> Vector3 {
    let Some(&first) = corners.first() else { return Vector3::zeros() };
    let from_first = |n: u32| vertices[n as usize] - vertices[first as usize];
    corners.windows(2).map(|edge| from_first(edge[0]).cross(&from_first(edge[1]))).sum()
}

/// A corner with those before and behind it.
fn around(corners: &[u32], n: usize) -> [u32; 3] {
    let count = corners.len();
    [corners[(n + count - 1) % count], corners[n], corners[(n + 1) % count]]
}

struct Polygon<'a> {
    vertices: &'a [Vector3],
    normal: Vector3,
}

impl Polygon<'_> {
    fn at(&self, corner: u32) -> Vector3 {
        self.vertices[corner as usize]
    }

    /// The corner that is best cut off.
    fn ear(&self, left: &[u32]) -> Option<usize> {
        let diagonal = |n: &usize| {
            let [a, _, c] = around(left, *n).map(|corner| self.at(corner));
            // Of equal lengths the one whose ends come first.
            let middle = a + c;
            ((c - a).norm_squared(), middle.x, middle.y, middle.z)
        };
        let mut order: Vec<(usize, (f64, f64, f64, f64))> =
            (0..left.len()).map(|n| (n, diagonal(&n))).collect();
        order.sort_by(|(_, a), (_, b)| {
            let by = a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1));
            by.then(a.2.total_cmp(&b.2)).then(a.3.total_cmp(&b.3))
        });
        let flat = self.normal.norm() <= FLAT * order.iter().map(|(_, d)| d.0).fold(0.0, f64::max);
        order.into_iter().map(|(n, _)| n).find(|n| flat || self.is_ear(left, *n))
    }

    /// Whether a corner is convex and its triangle has no other corner in it.
    fn is_ear(&self, left: &[u32], n: usize) -> bool {
        let corners = around(left, n).map(|corner| self.at(corner));
        let longest = (0..3).map(|k| (corners[(k + 1) % 3] - corners[k]).norm_squared());
        let least = FLAT * longest.fold(0.0, f64::max) * self.normal.norm();
        let turns = |k: usize, X: &Vector3| {
            let edge = corners[(k + 1) % 3] - corners[k];
            edge.cross(&(X - corners[k])).dot(&self.normal)
        };
        let inside = |X: &Vector3| (0..3).all(|k| turns(k, X) >= -least);
        let other = |X: &Vector3| corners.iter().all(|corner| corner != X);
        turns(0, &corners[2]) > least
            && !left.iter().map(|corner| self.at(*corner)).any(|X| other(&X) && inside(&X))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn areas(points: &[[f64; 3]]) -> (Vec<f64>, Vec<[u32; 3]>) {
        let vertices: Vec<Vector3> = points.iter().map(|p| Vector3::from(*p)).collect();
        let corners: Vec<u32> = (0..points.len() as u32).collect();
        let mut triangles = Vec::new();
        cut(&vertices, &corners, &mut triangles).unwrap();
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|n| vertices[n as usize]);
            0.5 * (b - a).cross(&(c - a)).z
        };
        (triangles.iter().map(area).collect(), triangles)
    }

    #[test]
    fn a_concave_polygon_is_covered_once() {
        // An L of area 3, a comb of three teeth of area 9.
        let l = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]];
        let comb = [
            [0, 0],
            [5, 0],
            [5, 3],
            [4, 3],
            [4, 1],
            [3, 1],
            [3, 3],
            [2, 3],
            [2, 1],
            [1, 1],
            [1, 3],
            [0, 3],
        ];
        for (polygon, area) in [(&l[..], 3.0), (&comb[..], 11.0)] {
            let points: Vec<[f64; 3]> =
                polygon.iter().map(|[x, y]| [f64::from(*x), f64::from(*y), 0.0]).collect();
            let (parts, triangles) = areas(&points);
            assert!(parts.iter().all(|part| *part > 0.0), "{parts:?}");
            assert_eq!((parts.iter().sum::<f64>(), triangles.len()), (area, points.len() - 2));
        }
    }

    #[test]
    fn a_corner_on_a_straight_edge_stays_a_corner() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let (parts, triangles) = areas(&points);
        assert_eq!(parts, [1.0, 1.0]);
        assert!(triangles.iter().all(|t| t.contains(&1)), "{triangles:?}");
    }

    #[test]
    fn the_first_corner_does_not_choose_the_diagonal() {
        let bent =
            [[0.0, 0.0, 0.3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.1], [0.0, 1.0, 0.0], [-0.5, 0.5, 0.0]];
        let sorted = |first: usize| {
            let mut points = bent;
            points.rotate_left(first);
            let mut triangles: Vec<[u32; 3]> = areas(&points).1;
            for t in &mut triangles {
                *t = t.map(|n| (n + first as u32) % 5);
                t.sort_unstable();
            }
            triangles.sort_unstable();
            triangles
        };
        assert!((1..5).all(|first| sorted(first) == sorted(0)));
    }

    #[test]
    fn a_polygon_that_crosses_itself_and_has_no_ear_is_refused() {
        let points = [[1.0, 1.0], [3.0, 4.0], [4.0, 3.0], [3.0, 2.0], [0.0, 4.0]];
        let vertices: Vec<Vector3> =
            points.iter().map(|[x, y]| Vector3::new(*x, *y, 0.0)).collect();
        let error = cut(&vertices, &[0, 1, 2, 3, 4], &mut Vec::new());
        assert!(matches!(error, Err(CutError::Crossed { .. })), "{error:?}");
    }
}
