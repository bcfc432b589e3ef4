//! The closed shells that a surface consists of, and how they lie to each other.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Vector3, bounding_box};
use crate::geometry::surface::sides::Sides;
use crate::geometry::triangles::{Triangle, area_vector, enclosed_volume};
use rustc_hash::FxHashMap;

/// Distance up to which shells touch without crossing, in terms of the size of the surface \[–\].
/// Single precision of the coordinates is a tenth of it.
const TOUCH: f64 = 1e-6;
/// Thickness up to which a shell is a sheet folded onto itself, without a volume that could
/// count twice, in terms of the size of the surface \[–\].
const FLAT: f64 = 1e-9;

/// How one shell lies to another.
pub(super) enum Lies {
    Inside,
    Outside,
    /// On both sides, and where one crosses the other \[m\].
    Across(Vector3),
}

/// Triangles that hang together by their edges.
pub(super) struct Shell {
    /// Among all of the surface.
    pub number: usize,
    vertices: Vec<Vector3>,
    triangles: Vec<[u32; 3]>,
    sides: Sides,
    bounds: (Vector3, Vector3),
    /// Negative if the triangles face inwards \[m³\].
    pub volume: f64,
}

impl Shell {
    pub fn new(number: usize, all: &[Vector3], part: &[[u32; 3]]) -> Shell {
        let (mut own, mut vertices) = (FxHashMap::default(), Vec::new());
        let mut own_number = |v: u32| {
            *own.entry(v).or_insert_with(|| {
                vertices.push(all[v as usize]);
                vertices.len() as u32 - 1
            })
        };
        let triangles: Vec<[u32; 3]> = part.iter().map(|t| t.map(&mut own_number)).collect();
        let sides = Sides::new(&vertices, &triangles);
        let bounds = bounding_box(&vertices);
        let mut shell = Shell { number, vertices, triangles, sides, bounds, volume: 0.0 };
        shell.volume = enclosed_volume(shell.corners(), shell.vertices[0]);
        shell
    }

    fn corners(&self) -> impl Iterator<Item = Triangle> + '_ {
        self.triangles.iter().map(|t| t.map(|v| self.vertices[v as usize]))
    }

    /// Whether it is a sheet folded onto itself, in terms of the `size` of the surface \[m\].
    pub fn is_flat(&self, size: f64) -> bool {
        let area: f64 = self.corners().map(|corners| area_vector(&corners).norm()).sum();
        self.volume.abs() <= FLAT * size * area
    }

    /// Whether the boxes around both meet.
    pub fn is_near(&self, other: &Shell) -> bool {
        let ((lower, upper), (least, most)) = (self.bounds, other.bounds);
        (0..3).all(|k| lower[k] <= most[k] && least[k] <= upper[k])
    }

    /// A place on it \[m\].
    pub fn at(&self) -> [f64; 3] {
        self.vertices[0].into()
    }

    /// How this shell lies to another, whichever way that one faces; shells of the same place
    /// lie across each other. Of a surface of `size` \[m\].
    pub fn lies_in(&self, other: &Shell, size: f64) -> Lies {
        let touch = TOUCH * size;
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
                return Lies::Across(X);
            }
        }
        match self.pierces(other, touch) {
            Some(X) => Lies::Across(X),
            None if inside.is_some() => Lies::Inside,
            None if outside.is_some() => Lies::Outside,
            None => Lies::Across(self.vertices[0]),
        }
    }

    /// How far a point lies within what the shell encloses \[m\], negative outside; −∞ outside of
    /// the box around it.
    fn depth(&self, X: &Vector3, touch: f64) -> f64 {
        let (lower, upper) = self.bounds;
        if (0..3).any(|k| X[k] < lower[k] - touch || X[k] > upper[k] + touch) {
            return f64::NEG_INFINITY;
        }
        let behind = -self.sides.signed_distance(X);
        if self.volume > 0.0 { behind } else { -behind }
    }

    /// Where an edge runs through a triangle of another shell.
    fn pierces(&self, other: &Shell, touch: f64) -> Option<Vector3> {
        let edges = self.corners().zip(&self.triangles).flat_map(|(corners, t)| {
            let edge = move |k: usize| (corners[k], corners[(k + 1) % 3]);
            let once = move |k: &usize| t[*k] < t[(*k + 1) % 3];
            (0..3).filter(once).map(edge)
        });
        let (lower, upper) = other.bounds;
        let meets = |a: &Vector3, b: &Vector3| {
            (0..3).all(|k| a[k].min(b[k]) <= upper[k] && a[k].max(b[k]) >= lower[k])
        };
        edges.filter(|(a, b)| meets(a, b)).find_map(|(a, b)| {
            let (middle, half) = (0.5 * (a + b), 0.5 * (b - a).norm() + touch);
            other.sides.nearest().find_near(&middle, half, |triangle| {
                let corners = other.triangles[triangle as usize];
                pierced(&corners.map(|v| other.vertices[v as usize]), a, b, touch)
            })
        })
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
