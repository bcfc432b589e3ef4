//! Solids enclosed by triangles.
#![allow(non_snake_case)]

mod edges;
mod nearest;
mod note;
#[cfg(test)]
mod shell_tests;
mod shells;
mod sides;
#[cfg(test)]
mod tests;
mod union;

use crate::algebra::sets::Sets;
use crate::algebra::tensor::{Vector3, bounding_box};
use crate::geometry::error::GeometryError;
use crate::geometry::polygon::{closed_chains, polygon_area};
use crate::geometry::triangles::{Triangle, area_vector, enclosed_volume, merged};
use edges::{Closed, closed};
pub use note::SurfaceNote;
use rustc_hash::FxHashMap;
use sides::Sides;
use std::cmp::Ordering;
use std::collections::BTreeMap;
use union::united;

/// A closed surface of triangles that run anticlockwise seen from outside.
#[derive(Debug, Clone)]
pub struct Surface {
    vertices: Vec<Vector3>,
    triangles: Vec<[u32; 3]>,
    sides: Sides,
    bounds: (Vector3, Vector3),
}

/// Solids of which triangles are the boundary.
#[derive(Debug, Clone)]
pub struct Mended {
    /// The solid is the union of these, several only where shells cross.
    pub surfaces: Vec<Surface>,
    /// What was changed in the triangles.
    pub notes: Vec<SurfaceNote>,
}

impl Surface {
    /// As [`Self::mended`], of triangles whose shells do not cross.
    pub fn new(vertices: Vec<Vector3>, triangles: Vec<[u32; 3]>) -> Result<Self, GeometryError> {
        let Mended { mut surfaces, notes } = Surface::mended(vertices, triangles)?;
        match (surfaces.pop(), surfaces.is_empty()) {
            (Some(surface), true) => Ok(surface),
            _ => {
                let crossing = notes.into_iter().find_map(|note| match note {
                    SurfaceNote::United { first, second, count, at } => {
                        Some(GeometryError::ShellsCross { first, second, count, at })
                    }
                    _ => None,
                });
                Err(crossing.unwrap_or(GeometryError::SurfaceFlat))
            }
        }
    }

    /// From vertices \[m\] and their indices. Vertices no further apart than 1e-9 of the size of
    /// the surface are merged and triangles that thereby vanish, and repeated ones, are dropped;
    /// what is left must be closed, each edge run through as often in one direction as in the
    /// other. The solid is where the winding number is at least 1: shells in others that face
    /// the same way are left out, shells that cross are united. Outermost shells that face
    /// inwards are turned, with what is in them. The order of vertices and triangles, and which
    /// corner of a triangle comes first, change no bit.
    pub fn mended(
        vertices: Vec<Vector3>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Mended, GeometryError> {
        if !vertices.iter().all(|v| v.iter().all(|c| c.is_finite())) {
            return Err(GeometryError::NotFinite { name: "the surface" });
        }
        let (vertices, triangles) = merge(vertices, triangles)?;
        if triangles.is_empty() {
            let (vertices, triangles) = (vertices.len(), 0);
            return Err(GeometryError::SurfaceEmpty { vertices, triangles });
        }
        let (vertices, triangles) = sorted(&vertices, &triangles);
        let mut notes = Vec::new();
        let triangles = without_doubles(&vertices, triangles, &mut notes);
        let Closed { vertices, triangles, shells } = closed(vertices, triangles)?;
        let count = shells.iter().max().map_or(0, |most| most + 1);
        let mut parts = vec![Vec::new(); count];
        shells.iter().zip(triangles).for_each(|(shell, t)| parts[*shell].push(t));
        let (lower, upper) = bounding_box(&vertices);
        let (solids, changes) = united(&vertices, parts, (upper - lower).norm())?;
        notes.extend(changes);
        if solids.is_empty() {
            return Err(GeometryError::SurfaceFlat);
        }
        let surfaces = solids.iter().map(|solid| Surface::of(&vertices, solid)).collect();
        Ok(Mended { surfaces, notes })
    }

    /// Of closed triangles and the vertices that these use.
    fn of(vertices: &[Vector3], triangles: &[[u32; 3]]) -> Surface {
        let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let mut numbers = vec![0; vertices.len()];
        for (&v, number) in used.iter().zip(0..) {
            numbers[v as usize] = number;
        }
        let vertices: Vec<Vector3> = used.iter().map(|&v| vertices[v as usize]).collect();
        let triangles: Vec<[u32; 3]> =
            triangles.iter().map(|t| t.map(|v| numbers[v as usize])).collect();
        let sides = Sides::new(&vertices, &triangles);
        let bounds = bounding_box(&vertices);
        Surface { vertices, triangles, sides, bounds }
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

    /// Whether panels of edge `size` \[m\] are made of several triangles.
    pub(crate) fn merges_triangles(&self, size: f64) -> bool {
        let area: f64 = self.corners().map(|t| area_vector(&t).norm()).sum();
        area < SMALL * size * size * self.triangles.len() as f64
    }

    pub(super) fn corners(&self) -> impl Iterator<Item = Triangle> + '_ {
        self.triangles.iter().map(|t| t.map(|v| self.vertices[v as usize]))
    }

    /// Signed distance \[m\], the sign from angle-weighted normals
    /// (Bærentzen, Aanæs 2005).
    pub fn signed_distance(&self, X: &Vector3) -> f64 {
        self.sides.signed_distance(X)
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
        let mut triangle_at = FxHashMap::default();
        let mut shells = Sets::new(self.vertices.len());
        for (t, number) in self.triangles.iter().zip(0..) {
            for k in 0..3 {
                triangle_at.insert((t[k], t[(k + 1) % 3]), number);
                shells.join(t[k], t[(k + 1) % 3]);
            }
        }
        let first = shells.first(self.triangles[0][0]);
        let normals: Vec<Option<Vector3>> =
            self.corners().map(|t| area_vector(&t).try_normalize(0.0)).collect();
        let size = (self.bounds.1 - self.bounds.0).norm();
        let behind = |(t, normal): (&[u32; 3], &Option<Vector3>)| {
            let Some(normal) = normal else { return true };
            (0..3).all(|k| {
                let Some(&other) = triangle_at.get(&(t[(k + 1) % 3], t[k])) else { return true };
                let Some(beyond) = normals[other as usize] else { return true };
                // Of the vertices of the other one two are on the edge.
                let rise = |v: u32| (self.vertex(v) - self.vertex(t[0])).dot(normal);
                let rise = self.triangles[other as usize].map(rise).into_iter().fold(0.0, f64::max);
                rise <= WELD * size || (rise <= ROUGH * size && normal.dot(&beyond) > LEVEL)
            })
        };
        self.triangles.iter().zip(&normals).all(behind)
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

/// Dents of single precision in a convex surface, in terms of its size \[–\].
const ROUGH: f64 = 1e-6;
/// Triangles that a dent divides enclose less than some 30°, those of a crack do not: the cosine.
const LEVEL: f64 = 0.866;
/// Triangles whose mean area is below this are merged in panels \[size²\]; halves of large ones
/// have about three times as much.
const SMALL: f64 = 0.1;

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

/// Each triangle once; none where as many face one way as the other.
fn without_doubles(
    vertices: &[Vector3],
    triangles: Vec<[u32; 3]>,
    notes: &mut Vec<SurfaceNote>,
) -> Vec<[u32; 3]> {
    // Each starts with its smallest vertex, so that its other way round swaps the last two.
    let place = |t: &[u32; 3]| [t[0], t[1].min(t[2]), t[1].max(t[2])];
    let mut order = triangles;
    order.sort_unstable_by_key(|t| (place(t), *t));
    let (mut repeated, mut opposite) = ((0, None), (0, None));
    let mut kept = Vec::with_capacity(order.len());
    for same in order.chunk_by(|t, s| place(t) == place(s)) {
        let along = same.iter().filter(|t| t[1] < t[2]).count();
        let against = same.len() - along;
        if along > against {
            kept.push(same[0]);
        } else if against > along {
            kept.push(same[same.len() - 1]);
        }
        let at = vertices[same[0][0] as usize];
        let (pairs, alike) = (along.min(against), along.abs_diff(against));
        for (found, sum) in [(alike.saturating_sub(1), &mut repeated), (pairs, &mut opposite)] {
            if found > 0 {
                *sum = (sum.0 + found, sum.1.or(Some(at.into())));
            }
        }
    }
    if let (triangles, Some(at)) = repeated {
        notes.push(SurfaceNote::Repeated { triangles, at });
    }
    if let (pairs, Some(at)) = opposite {
        notes.push(SurfaceNote::Opposite { pairs, at });
    }
    kept.sort_unstable();
    kept
}
