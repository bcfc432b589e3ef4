//! Solids enclosed by triangles.
#![allow(non_snake_case)]

mod shells;
#[cfg(test)]
mod tests;

use crate::algebra::sets::Sets;
use crate::algebra::tensor::{Vector3, bounding_box};
use crate::geometry::error::GeometryError;
use crate::geometry::polygon::{closed_chains, polygon_area};
use crate::geometry::triangles::{Triangle, area_vector, enclosed_volume, merged, parry};
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::{TriMesh, TriMeshFlags};
use shells::check_shells;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// A closed surface of triangles that run anticlockwise seen from outside.
#[derive(Debug, Clone)]
pub struct Surface {
    vertices: Vec<Vector3>,
    triangles: Vec<[u32; 3]>,
    mesh: TriMesh,
    bounds: (Vector3, Vector3),
}

impl Surface {
    /// From vertices \[m\] and their indices. Vertices no further apart than
    /// 1e-9 of the size of the surface are merged and triangles that thereby
    /// vanish are dropped; what is left must be closed, each edge run through
    /// once in either direction, with the normals outwards. Of several shells
    /// none may cross another, and none may lie in another except as a cavity
    /// or in one, since volumes would count twice. The order of vertices and
    /// triangles, and which corner of a triangle comes first, change no bit.
    pub fn new(vertices: Vec<Vector3>, triangles: Vec<[u32; 3]>) -> Result<Self, GeometryError> {
        if !vertices.iter().all(|v| v.iter().all(|c| c.is_finite())) {
            return Err(GeometryError::NotFinite { name: "the surface" });
        }
        let (vertices, triangles) = merge(vertices, triangles)?;
        let empty =
            GeometryError::SurfaceEmpty { vertices: vertices.len(), triangles: triangles.len() };
        if triangles.is_empty() {
            return Err(empty);
        }
        check_closed(&vertices, &triangles)?;
        check_shells(&vertices, &triangles)?;
        let (vertices, triangles) = sorted(&vertices, &triangles);
        let points = vertices.iter().map(parry).collect();
        let mesh = TriMesh::with_flags(points, triangles.clone(), TriMeshFlags::ORIENTED)
            .map_err(|_| empty)?;
        let bounds = bounding_box(&vertices);
        let surface = Surface { vertices, triangles, mesh, bounds };
        let volume = surface.volume();
        if volume > 0.0 { Ok(surface) } else { Err(GeometryError::SurfaceInsideOut { volume }) }
    }

    /// Enclosed volume \[m³\].
    pub fn volume(&self) -> f64 {
        // From a vertex, not the origin, which may be far away.
        enclosed_volume(self.corners(), self.vertices[0])
    }

    /// Number of triangles.
    pub(crate) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    pub(super) fn corners(&self) -> impl Iterator<Item = Triangle> + '_ {
        self.triangles.iter().map(|t| t.map(|v| self.vertices[v as usize]))
    }

    /// Signed distance \[m\], the sign from angle-weighted normals
    /// (Bærentzen, Aanæs 2005).
    pub fn signed_distance(&self, X: &Vector3) -> f64 {
        let (projection, _) = self.mesh.project_local_point_and_get_location(parry(X), false);
        let distance = (projection.point - parry(X)).length();
        if projection.is_inside { -distance } else { distance }
    }

    pub(super) fn bounding_box(&self) -> (Vector3, Vector3) {
        self.bounds
    }

    /// Ends of the edges whose triangles enclose more than 30°.
    pub(super) fn sharp_edges(&self) -> Vec<(u32, u32)> {
        let mut normals = BTreeMap::new();
        for (t, corners) in self.triangles.iter().zip(self.corners()) {
            let normal = area_vector(&corners).try_normalize(0.0);
            (0..3).for_each(|k| {
                normals.insert((t[k], t[(k + 1) % 3]), normal);
            });
        }
        let sharp = |(a, b): &(u32, u32)| match (normals[&(*a, *b)], normals.get(&(*b, *a))) {
            (Some(n), Some(Some(m))) => n.dot(m) < 0.866,
            _ => false,
        };
        normals.keys().filter(|(a, b)| a < b).filter(|edge| sharp(edge)).copied().collect()
    }

    /// Whether it is one shell that bends outwards at no edge.
    pub(crate) fn is_convex(&self) -> bool {
        let mut across = BTreeMap::new();
        let mut shells = Sets::new(self.vertices.len());
        for t in &self.triangles {
            for k in 0..3 {
                across.insert((t[k], t[(k + 1) % 3]), t[(k + 2) % 3]);
                shells.join(t[k], t[(k + 1) % 3]);
            }
        }
        let first = shells.first(self.triangles[0][0]);
        let flat = WELD * (self.bounds.1 - self.bounds.0).norm();
        let behind = |(t, corners): (&[u32; 3], Triangle)| {
            let Some(normal) = area_vector(&corners).try_normalize(0.0) else { return true };
            let others = (0..3).filter_map(|k| across.get(&(t[(k + 1) % 3], t[k])));
            others.into_iter().all(|&v| (self.vertex(v) - corners[0]).dot(&normal) <= flat)
        };
        self.triangles.iter().zip(self.corners()).all(behind)
            && self.triangles.iter().all(|t| shells.first(t[0]) == first)
    }

    pub(super) fn vertex(&self, index: u32) -> Vector3 {
        self.vertices[index as usize]
    }

    /// Polygons \[m\] in which the plane at height z cuts the surface, the
    /// solid to their left.
    pub(super) fn loops(&self, z: f64) -> Vec<Vec<[f64; 2]>> {
        let cut = |a: u32, b: u32| {
            let (p, q) = (self.vertex(a.min(b)), self.vertex(a.max(b)));
            let point = p + (z - p.z) / (q.z - p.z) * (q - p);
            [point.x, point.y]
        };
        let above = |v: u32| self.vertex(v).z >= z;
        // From the edge that runs down through the plane to the one that runs up.
        let mut next = BTreeMap::new();
        for t in &self.triangles {
            let edges = [0, 1, 2].map(|k| (t[k], t[(k + 1) % 3]));
            let down = edges.iter().find(|(a, b)| above(*a) && !above(*b));
            let up = edges.iter().find(|(a, b)| !above(*a) && above(*b));
            if let (Some(&(a, b)), Some(&(c, d))) = (down, up) {
                next.insert((a, b), (d, c));
            }
        }
        let mut loops = Vec::new();
        for chain in closed_chains(next) {
            let mut points: Vec<[f64; 2]> = Vec::new();
            for (a, b) in chain {
                let point = cut(a, b);
                if points.last() != Some(&point) && points.first() != Some(&point) {
                    points.push(point);
                }
            }
            if points.len() >= 3 && polygon_area(&points) != 0.0 {
                loops.push(points);
            }
        }
        loops
    }
}

type Mesh = (Vec<Vector3>, Vec<[u32; 3]>);

fn merge(vertices: Vec<Vector3>, triangles: Vec<[u32; 3]>) -> Result<Mesh, GeometryError> {
    let (merged, number) = welded(&vertices);
    let mut kept = Vec::with_capacity(triangles.len());
    for (triangle, t) in triangles.iter().enumerate() {
        if let Some(&vertex) = t.iter().find(|&&v| v as usize >= vertices.len()) {
            return Err(GeometryError::SurfaceVertex { triangle, vertex, count: vertices.len() });
        }
        let [a, b, c] = t.map(|v| number[v as usize]);
        if a != b && b != c && c != a {
            kept.push([a, b, c]);
        }
    }
    Ok((merged, kept))
}

/// Distance up to which vertices are one, in terms of the size of the surface \[–\]: a hundredth
/// of the single precision of coordinates as large as it, so that only round-off near 0 is mended.
const WELD: f64 = 1e-9;

/// Vertices without those that are one with an earlier one, and the number among them of each.
fn welded(vertices: &[Vector3]) -> (Vec<Vector3>, Vec<u32>) {
    let (distinct, numbers) = merged(vertices.iter());
    if distinct.is_empty() {
        return (distinct, numbers);
    }
    let (lower, upper) = bounding_box(&distinct);
    let tolerance = WELD * (upper - lower).norm();
    // Along a direction that hardly any face is across, so that few vertices are abreast.
    let direction = Vector3::new(0.538, 0.787, 0.301).normalize();
    let mut along: Vec<(f64, u32)> = (distinct.iter().zip(0..))
        .map(|(v, number)| ((v - lower).dot(&direction), number))
        .collect();
    along.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sets = Sets::new(distinct.len());
    for (n, &(place, a)) in along.iter().enumerate() {
        let abreast = along[n + 1..].iter().take_while(|(next, _)| next - place <= tolerance);
        for &(_, b) in abreast {
            if (distinct[a as usize] - distinct[b as usize]).norm() <= tolerance {
                sets.join(a, b);
            }
        }
    }
    // The least of those that are one, whichever was first in the file.
    let mut least = distinct.clone();
    for (v, number) in distinct.iter().zip(0..) {
        let one = &mut least[sets.first(number) as usize];
        if in_order(v, one).is_lt() {
            *one = *v;
        }
    }
    let ones: Vec<Vector3> =
        (0..distinct.len() as u32).map(|v| least[sets.first(v) as usize]).collect();
    let (kept, among) = merged(ones.iter());
    (kept, numbers.iter().map(|&v| among[v as usize]).collect())
}

/// Which of two points comes first: that of the smaller x, of those the one of the smaller y, z.
fn in_order(a: &Vector3, b: &Vector3) -> Ordering {
    let by = |k: usize| a[k].total_cmp(&b[k]);
    by(0).then(by(1)).then(by(2))
}

/// The vertices that triangles use, in the order of their coordinates, and the triangles in the
/// order of their vertices, each from its first vertex on.
fn sorted(vertices: &[Vector3], triangles: &[[u32; 3]]) -> Mesh {
    let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    used.sort_unstable_by(|&a, &b| in_order(&vertices[a as usize], &vertices[b as usize]));
    let mut numbers = vec![0; vertices.len()];
    for (&v, number) in used.iter().zip(0..) {
        numbers[v as usize] = number;
    }
    let mut sorted: Vec<[u32; 3]> = (triangles.iter())
        .map(|t| {
            let mut t = t.map(|v| numbers[v as usize]);
            let first = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
            t.rotate_left(first);
            t
        })
        .collect();
    sorted.sort_unstable();
    (used.iter().map(|&v| vertices[v as usize]).collect(), sorted)
}

fn check_closed(vertices: &[Vector3], triangles: &[[u32; 3]]) -> Result<(), GeometryError> {
    let mut edges: BTreeMap<(u32, u32), (usize, usize)> = BTreeMap::new();
    for t in triangles {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            let count = edges.entry((a.min(b), a.max(b))).or_default();
            if a < b { count.0 += 1 } else { count.1 += 1 }
        }
    }
    let mut open = edges.into_iter().filter(|(_, count)| *count != (1, 1));
    match open.next() {
        None => Ok(()),
        Some(((a, b), (forward, backward))) => Err(GeometryError::SurfaceOpen {
            from: vertices[a as usize].into(),
            to: vertices[b as usize].into(),
            forward,
            backward,
            more: open.count(),
        }),
    }
}
