//! Cells in which flat faces of the body meet: the planes of the faces, from the signed distance and its
//! gradient at a few places, cut them without a chamfer.
#![allow(non_snake_case)]

use super::simplex::{Halves, Tetrahedron, Triangle};
use crate::algebra::tensor::Vector3;
use crate::geometry::Shape;

/// Faces that may meet in a cell.
const MOST: usize = 3;
/// Cosine of the largest angle between normals of one face \[–\]: those of a cylinder of radius R turn by
/// 0.08 in a cell of 0.08 R.
const SAME_FACE: f64 = 0.99;

/// Cosine of the least angle between faces that meet in an edge \[–\]: smooth surfaces are cut by planes that
/// turn by less, and need no nodes where these meet.
pub(super) const EDGE: f64 = 0.9;
/// Deviation from the distance from a face beside it, over that \[–\]: at a right edge it is 0.3.
const FLAT: f64 = 0.1;

/// A plane n·X = d.
#[derive(Debug, Clone, Copy)]
struct Plane {
    /// Out of the body.
    normal: Vector3,
    /// \[m\]
    offset: f64,
}

impl Plane {
    fn at(&self, X: &Vector3) -> f64 {
        self.normal.dot(X) - self.offset
    }
}

/// The body in a cell: what all of some half-spaces have in common, or what any of them has.
#[derive(Debug)]
pub(super) struct Corner {
    planes: Vec<Plane>,
    /// Whether the faces meet in an edge that sticks out.
    sticks_out: bool,
    /// Largest difference between the signed distance and that from the faces, at the places where it was
    /// asked \[m\].
    pub misfit: f64,
}

/// A place with the signed distance there \[m\].
pub(super) type Known = (Vector3, f64);

impl Corner {
    /// The faces that meet in a cell, from places in it, if the signed distance there is theirs within
    /// `tolerance` \[m\].
    pub fn find(body: &Shape, known: &[Known], tolerance: f64) -> Option<Corner> {
        [true, false].into_iter().find_map(|sticks_out| {
            let planes = planes(body, known, sticks_out)?;
            let mut corner = Corner { planes, sticks_out, misfit: 0.0 };
            loop {
                let misfits = known.iter().map(|place| corner.misfit_at(place));
                corner.misfit = misfits.fold(0.0, f64::max);
                if corner.misfit <= tolerance {
                    return Some(corner);
                }
                // A face may be nearest to places on its far side alone.
                let is_new = |place: &&Known| {
                    let is_far = (place.1 >= 0.0) == sticks_out;
                    is_far && corner.misfit_at(place) > tolerance
                };
                let face = known.iter().filter(is_new).find_map(|place| {
                    let face = Face::of(body, place);
                    face.is_flat(body, sticks_out, tolerance).then_some(face)
                })?;
                if corner.planes.len() == MOST {
                    return None;
                }
                corner.planes.push(face.plane());
            }
        })
    }

    /// Largest of the distances from the planes where the edge sticks out, else the smallest \[m\].
    fn level(&self, X: &Vector3) -> f64 {
        let levels = self.planes.iter().map(|plane| plane.at(X));
        if self.sticks_out {
            levels.fold(f64::MIN, f64::max)
        } else {
            levels.fold(f64::MAX, f64::min)
        }
    }

    /// How far a signed distance is from that from the planes \[m\]. On the far side of an edge it is that
    /// from the edge, and only its sign says something.
    fn misfit_at(&self, (X, distance): &Known) -> f64 {
        let level = self.level(X);
        let is_far = (*distance >= 0.0) == self.sticks_out;
        let is_same_side = (level >= 0.0) == (*distance >= 0.0);
        if is_far && is_same_side { 0.0 } else { (level - distance).abs() }
    }

    /// What of some tetrahedra lies in the body, and the boundary between.
    pub fn cut(&self, tetrahedra: &[Tetrahedron]) -> Halves {
        let mut all = Halves::default();
        let mut rest = tetrahedra.to_vec();
        for (index, plane) in self.planes.iter().enumerate() {
            let halves = sides(&rest, plane);
            if self.sticks_out {
                all.outside.extend(halves.outside);
                rest = halves.inside;
            } else {
                all.inside.extend(halves.inside);
                rest = halves.outside;
            }
            all.border.extend(self.face(tetrahedra, index));
        }
        if self.sticks_out {
            all.inside = rest
        } else {
            all.outside = rest
        }
        all
    }

    /// The boundary in one of the planes.
    fn face(&self, tetrahedra: &[Tetrahedron], own: usize) -> Vec<Triangle> {
        let mut rest = tetrahedra.to_vec();
        for (index, plane) in self.planes.iter().enumerate() {
            if index != own {
                let halves = sides(&rest, plane);
                rest = if self.sticks_out { halves.inside } else { halves.outside };
            }
        }
        sides(&rest, &self.planes[own]).border
    }

    /// Places along the edges in a box of this centre and half edges, at most `step` apart \[m\].
    pub fn edges(&self, centre: &Vector3, half: &Vector3, step: f64) -> Vec<Vector3> {
        let mut places = Vec::new();
        for (index, one) in self.planes.iter().enumerate() {
            for (more, other) in self.planes[index + 1..].iter().enumerate() {
                let Some((start, along)) = meeting(one, other, centre) else { continue };
                let is_beside = |n: usize| n != index && n != index + 1 + more;
                let beside: Vec<&Plane> = (0..self.planes.len())
                    .filter(|n| is_beside(*n))
                    .map(|n| &self.planes[n])
                    .collect();
                let reach = half.norm();
                let parts = (2.0 * reach / step).ceil().max(1.0);
                let place =
                    |n: usize| start + along * (2.0 * reach * ((n as f64 + 0.5) / parts) - reach);
                let is_edge = |X: &Vector3| {
                    let within = (0..3).all(|k| (X[k] - centre[k]).abs() <= half[k]);
                    let side = |plane: &&Plane| (plane.at(X) <= 0.0) == self.sticks_out;
                    within && beside.iter().all(side)
                };
                places.extend((0..parts as usize).map(place).filter(is_edge));
            }
        }
        places
    }
}

/// A face by what is known of it: normals and places on it \[m\].
struct Face {
    normals: Vec<Vector3>,
    places: Vec<Vector3>,
}

impl Face {
    /// That is nearest to a place.
    fn of(body: &Shape, (X, distance): &Known) -> Face {
        let normal = body.gradient(X);
        Face { normals: vec![normal], places: vec![X - normal * *distance] }
    }

    /// Whether the distance a little on the near side of the face is that from it, not from an edge.
    fn is_flat(&self, body: &Shape, sticks_out: bool, depth: f64) -> bool {
        let depth = if sticks_out { -depth } else { depth };
        let beside = self.places[0] + depth * self.normals[0];
        (body.signed_distance(&beside) - depth).abs() <= FLAT * depth.abs()
    }

    /// In the mean, so that a curved face is on both sides of it.
    fn plane(&self) -> Plane {
        let normal = self.normals.iter().sum::<Vector3>().normalize();
        let offsets = self.places.iter().map(|X| normal.dot(X)).sum::<f64>();
        Plane { normal, offset: offsets / self.places.len() as f64 }
    }
}

/// Planes of the faces that are nearest to known places on the side where the distance is that from a face;
/// none where there are none or too many.
fn planes(body: &Shape, known: &[Known], sticks_out: bool) -> Option<Vec<Plane>> {
    let mut faces: Vec<Face> = Vec::new();
    for place in known.iter().filter(|place| (place.1 <= 0.0) == sticks_out) {
        let found = Face::of(body, place);
        let is_own = |face: &Face| face.normals[0].dot(&found.normals[0]) > SAME_FACE;
        match faces.iter().position(is_own) {
            Some(own) => {
                faces[own].normals.extend(found.normals);
                faces[own].places.extend(found.places);
            }
            None if faces.len() == MOST => return None,
            None => faces.push(found),
        }
    }
    (!faces.is_empty()).then(|| faces.iter().map(Face::plane).collect())
}

fn sides(tetrahedra: &[Tetrahedron], plane: &Plane) -> Halves {
    let mut halves = Halves::default();
    tetrahedra.iter().for_each(|tetrahedron| halves.cut(tetrahedron.map(|X| (X, plane.at(&X)))));
    halves
}

/// The line in which two planes meet in an edge: the place nearest to another, and its direction.
fn meeting(one: &Plane, other: &Plane, near: &Vector3) -> Option<(Vector3, Vector3)> {
    let along = one.normal.cross(&other.normal);
    let square = along.norm_squared();
    if one.normal.dot(&other.normal) > EDGE || square < 1e-6 {
        return None;
    }
    // near + a n + b m on both planes.
    let cosine = one.normal.dot(&other.normal);
    let (p, q) = (-one.at(near), -other.at(near));
    let (a, b) = ((p - cosine * q) / square, (q - cosine * p) / square);
    Some((near + one.normal * a + other.normal * b, along / square.sqrt()))
}
