//! The closed shells that a surface consists of, and how they may lie to each other.
#![allow(non_snake_case)]

use crate::algebra::sets::Sets;
use crate::algebra::tensor::{Vector3, bounding_box};
use crate::geometry::error::GeometryError;
use crate::geometry::triangles::{Triangle, area_vector, enclosed_volume, parry};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::{TriMesh, TriMeshFlags};
use std::collections::{BTreeMap, HashMap};

/// Distance up to which shells touch without crossing, in terms of the size of the surface \[–\].
/// Single precision of the coordinates is a tenth of it.
const TOUCH: f64 = 1e-6;
/// Thickness up to which a shell is a sheet folded onto itself, without a volume that could
/// count twice, in terms of the size of the surface \[–\].
const FLAT: f64 = 1e-9;

/// Triangles that hang together by their edges.
struct Shell {
    vertices: Vec<Vector3>,
    triangles: Vec<[u32; 3]>,
    mesh: TriMesh,
    bounds: (Vector3, Vector3),
    /// Negative if the triangles face inwards \[m³\].
    volume: f64,
}

/// Refuses shells whose volumes would count more often than once: ones that cross, a body in a
/// body, a cavity in none. Around every shell that faces outwards there must be nothing, around
/// one that faces inwards one body.
pub(super) fn check_shells(
    vertices: &[Vector3],
    triangles: &[[u32; 3]],
) -> Result<(), GeometryError> {
    let parts = connected(triangles);
    if parts.len() < 2 {
        return Ok(());
    }
    let (lower, upper) = bounding_box(vertices);
    let size = (upper - lower).norm();
    let shells: Vec<Shell> = parts.iter().filter_map(|part| Shell::new(vertices, part)).collect();
    if shells.iter().all(|shell| shell.volume <= 0.0) {
        return Ok(());
    }
    let flat: Vec<bool> = shells.iter().map(|shell| shell.is_flat(size)).collect();
    let mut around = vec![(0, None); shells.len()];
    for (i, shell) in shells.iter().enumerate() {
        for (j, other) in shells.iter().enumerate() {
            if i == j || flat[i] || flat[j] || !shell.is_near(other) {
                continue;
            }
            if shell.lies_in(other, TOUCH * size).map_err(|at| cross(i, j, shells.len(), at))? {
                around[i].0 += if other.volume > 0.0 { 1 } else { -1 };
                if other.volume * shell.volume > 0.0 {
                    around[i].1 = Some(j);
                }
            }
        }
    }
    check_nesting(&shells, &around)
}

fn cross(i: usize, j: usize, count: usize, at: Vector3) -> GeometryError {
    let (first, second) = (i.min(j) + 1, i.max(j) + 1);
    GeometryError::ShellsCross { first, second, count, at: at.into() }
}

/// `around` each shell: how many bodies, and a shell around it that faces the same way.
fn check_nesting(shells: &[Shell], around: &[(i32, Option<usize>)]) -> Result<(), GeometryError> {
    let count = shells.len();
    let at = |shell: usize| shells[shell].vertices[0].into();
    for (shell, &(bodies, alike)) in around.iter().enumerate() {
        if let (true, true, Some(outer)) = (shells[shell].volume > 0.0, bodies > 0, alike) {
            let (inner, outer) = (shell + 1, outer + 1);
            return Err(GeometryError::ShellInside { inner, outer, count, at: at(shell) });
        }
    }
    let alone = |shell: &usize| shells[*shell].volume < 0.0 && around[*shell].0 <= 0;
    match (0..count).find(alone) {
        Some(shell) => Err(GeometryError::ShellInwards { shell: shell + 1, count, at: at(shell) }),
        None => Ok(()),
    }
}

/// Triangles of a closed surface, those together that share edges.
fn connected(triangles: &[[u32; 3]]) -> Vec<Vec<[u32; 3]>> {
    let (mut first, mut sets) = (HashMap::new(), Sets::new(triangles.len()));
    for (number, t) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            let neighbour = *first.entry((a.min(b), a.max(b))).or_insert(number as u32);
            sets.join(neighbour, number as u32);
        }
    }
    let mut parts: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
    for (number, t) in triangles.iter().enumerate() {
        parts.entry(sets.first(number as u32)).or_default().push(*t);
    }
    parts.into_values().collect()
}

impl Shell {
    fn new(all: &[Vector3], part: &[[u32; 3]]) -> Option<Shell> {
        let (mut own, mut vertices) = (HashMap::new(), Vec::new());
        let mut number = |v: u32| {
            *own.entry(v).or_insert_with(|| {
                vertices.push(all[v as usize]);
                vertices.len() as u32 - 1
            })
        };
        let triangles: Vec<[u32; 3]> = part.iter().map(|t| t.map(&mut number)).collect();
        let points = vertices.iter().map(parry).collect();
        let mesh = TriMesh::with_flags(points, triangles.clone(), TriMeshFlags::ORIENTED).ok()?;
        let bounds = bounding_box(&vertices);
        let mut shell = Shell { vertices, triangles, mesh, bounds, volume: 0.0 };
        shell.volume = enclosed_volume(shell.corners(), shell.vertices[0]);
        Some(shell)
    }

    fn corners(&self) -> impl Iterator<Item = Triangle> + '_ {
        self.triangles.iter().map(|t| t.map(|v| self.vertices[v as usize]))
    }

    fn is_flat(&self, size: f64) -> bool {
        let area: f64 = self.corners().map(|corners| area_vector(&corners).norm()).sum();
        self.volume.abs() <= FLAT * size * area
    }

    fn is_near(&self, other: &Shell) -> bool {
        let ((lower, upper), (least, most)) = (self.bounds, other.bounds);
        (0..3).all(|k| lower[k] <= most[k] && least[k] <= upper[k])
    }

    /// Whether this shell lies in another, whichever way that one faces; an error with a place
    /// where they cross, or anywhere on this one if all of it lies on the other.
    fn lies_in(&self, other: &Shell, touch: f64) -> Result<bool, Vector3> {
        let centres = self.corners().map(|[a, b, c]| (a + b + c) / 3.0);
        let (mut inside, mut outside) = (None, None);
        for X in self.vertices.iter().copied().chain(centres) {
            let depth = other.depth(&X, touch);
            if depth > touch {
                inside = Some(X);
            } else if depth < -touch {
                outside = Some(X);
            }
            if let (Some(X), Some(_)) = (inside, outside) {
                return Err(X);
            }
        }
        match self.pierces(other, touch) {
            Some(X) => Err(X),
            None if inside.is_none() && outside.is_none() => Err(self.vertices[0]),
            None => Ok(inside.is_some()),
        }
    }

    /// How far a point lies within what the shell encloses \[m\], negative outside; −∞ outside of
    /// the box around it.
    fn depth(&self, X: &Vector3, touch: f64) -> f64 {
        let (lower, upper) = self.bounds;
        if (0..3).any(|k| X[k] < lower[k] - touch || X[k] > upper[k] + touch) {
            return f64::NEG_INFINITY;
        }
        let (projection, _) = self.mesh.project_local_point_and_get_location(parry(X), false);
        let distance = (projection.point - parry(X)).length();
        if projection.is_inside == (self.volume > 0.0) { distance } else { -distance }
    }

    /// Where an edge runs through a triangle of another shell.
    fn pierces(&self, other: &Shell, touch: f64) -> Option<Vector3> {
        let bounds = Aabb::new(parry(&other.bounds.0), parry(&other.bounds.1));
        let edges = self.corners().zip(&self.triangles).flat_map(|(corners, t)| {
            let edge = move |k: usize| (corners[k], corners[(k + 1) % 3]);
            let once = move |k: &usize| t[*k] < t[(*k + 1) % 3];
            (0..3).filter(once).map(edge)
        });
        for (a, b) in edges {
            let around = Aabb::from_points([parry(&a), parry(&b)]);
            let met = around.intersection(&bounds).is_some();
            let mut near = other.mesh.bvh().intersect_aabb(&around).filter(|_| met);
            let place = near.find_map(|triangle| {
                let corners = other.triangles[triangle as usize];
                pierced(&corners.map(|v| other.vertices[v as usize]), a, b, touch)
            });
            if place.is_some() {
                return place;
            }
        }
        None
    }
}

/// Where the line from `a` to `b` runs through a triangle, further than `touch` \[m\] from its
/// rim and with both ends as far from its plane.
fn pierced(t: &Triangle, a: Vector3, b: Vector3, touch: f64) -> Option<Vector3> {
    let normal = area_vector(t).try_normalize(0.0)?;
    let (from, to) = ((a - t[0]).dot(&normal), (b - t[0]).dot(&normal));
    if from * to >= 0.0 || from.abs().min(to.abs()) <= touch {
        return None;
    }
    let X = a + (b - a) * (from / (from - to));
    let within = (0..3).all(|k| {
        let edge = t[(k + 1) % 3] - t[k];
        edge.cross(&(X - t[k])).dot(&normal) > touch * edge.norm()
    });
    within.then_some(X)
}

#[cfg(test)]
mod tests {
    use crate::algebra::tensor::Vector3;
    use crate::geometry::{GeometryError, Surface};

    /// A box from `from` to `to`, with all its triangles turned inwards or not.
    type Part = ([f64; 3], [f64; 3], bool);

    fn surface(parts: &[Part]) -> Result<Surface, GeometryError> {
        const FACES: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for (from, to, inwards) in parts {
            let base = vertices.len() as u32;
            let corner =
                |n: usize| Vector3::from_fn(|k, _| if n >> k & 1 == 1 { to[k] } else { from[k] });
            vertices.extend((0..8).map(corner));
            for [a, b, c, d] in FACES.map(|face| face.map(|v| base + v)) {
                let halves = [[a, b, c], [a, c, d]];
                triangles
                    .extend(halves.map(|[a, b, c]| if *inwards { [a, c, b] } else { [a, b, c] }));
            }
        }
        Surface::new(vertices, triangles)
    }

    fn cube(low: f64, high: f64, inwards: bool) -> Part {
        ([low; 3], [high; 3], inwards)
    }

    #[test]
    fn a_cavity_and_a_body_in_it_count_once() {
        let nested = [cube(0.0, 1.0, false), cube(0.1, 0.9, true), cube(0.2, 0.8, false)];
        let volume = surface(&nested).unwrap().volume();
        assert!((volume - (1.0 - 0.512 + 0.216)).abs() < 1e-12, "{volume}");
    }

    #[test]
    fn a_shell_in_a_shell_that_faces_the_same_way_is_refused() {
        let nested = [cube(3.0, 4.0, false), cube(0.2, 0.8, false), cube(0.0, 1.0, false)];
        let error = surface(&nested).unwrap_err();
        let expected = GeometryError::ShellInside { inner: 2, outer: 3, count: 3, at: [0.2; 3] };
        assert_eq!(error, expected);
        let doubled = [cube(0.0, 1.0, false), cube(0.1, 0.9, true), cube(0.2, 0.8, true)];
        let error = surface(&doubled).unwrap_err();
        assert_eq!(error, GeometryError::ShellInwards { shell: 3, count: 3, at: [0.2; 3] });
    }

    #[test]
    fn a_shell_that_faces_inwards_needs_a_body_around_it() {
        let error = surface(&[cube(0.0, 1.0, false), cube(2.0, 2.5, true)]).unwrap_err();
        assert_eq!(error, GeometryError::ShellInwards { shell: 2, count: 2, at: [2.0; 3] });
    }

    #[test]
    fn shells_that_cross_are_refused() {
        let corners = [cube(0.0, 1.0, false), cube(0.5, 1.5, false)];
        let shifted = [cube(0.0, 1.0, false), ([0.5, 0.0, 0.0], [1.5, 1.0, 1.0], false)];
        let bars =
            [([0.0, 0.4, 0.4], [1.0, 0.6, 0.6], false), ([0.3, 0.0, 0.45], [0.6, 1.0, 0.5], false)];
        let sticks =
            [([0.0, 0.4, 0.4], [1.0, 0.6, 0.6], false), ([0.3, 0.0, 0.3], [0.6, 0.5, 0.5], false)];
        for parts in [corners, shifted, bars, sticks] {
            let error = surface(&parts).unwrap_err();
            assert!(
                matches!(error, GeometryError::ShellsCross { first: 1, second: 2, count: 2, .. }),
                "{error}"
            );
        }
    }

    #[test]
    fn shells_that_touch_are_no_overlap() {
        let on_top = ([0.3, 0.2, 1.0], [0.6, 0.7, 1.5], false);
        let flush = ([1.0, 0.0, 0.0], [1.5, 0.5, 0.5], false);
        let at_a_corner = ([1.0; 3], [1.5; 3], false);
        for second in [on_top, flush, at_a_corner] {
            let expected = 1.0 + (0..3).map(|k| second.1[k] - second.0[k]).product::<f64>();
            let volume = surface(&[cube(0.0, 1.0, false), second]).unwrap().volume();
            assert!((volume - expected).abs() < 1e-12, "{volume} {expected}");
        }
    }
}
