//! On which side of a closed surface a point lies.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::surface::nearest::{Feature, Nearest, Place};
use crate::geometry::triangles::{Triangle, area_vector};
use rustc_hash::FxHashMap;

/// Triangles with the normals that tell inside from outside at each vertex, edge and face:
/// those of the faces around it, at vertices weighted by their angles (Bærentzen, Aanæs 2005).
#[derive(Debug, Clone)]
pub(super) struct Sides {
    nearest: Nearest,
    triangles: Vec<[u32; 3]>,
    /// \[triangle\]
    faces: Vec<Vector3>,
    /// \[triangle\]\[edge\]
    edges: Vec<[Vector3; 3]>,
    /// \[vertex\]
    vertices: Vec<Vector3>,
}

impl Sides {
    /// Of at least one triangle.
    pub fn new(vertices: &[Vector3], triangles: &[[u32; 3]]) -> Sides {
        let corners = || triangles.iter().map(|t| t.map(|v| vertices[v as usize]));
        let faces: Vec<Vector3> = corners().map(|t| unit(area_vector(&t))).collect();
        let mut across = FxHashMap::default();
        let mut at_vertices = vec![Vector3::zeros(); vertices.len()];
        for ((t, corners), face) in triangles.iter().zip(corners()).zip(&faces) {
            for k in 0..3 {
                across.insert((t[k], t[(k + 1) % 3]), *face);
                at_vertices[t[k] as usize] += angle(&corners, k) * face;
            }
        }
        let edges = triangles.iter().zip(&faces).map(|(t, face)| {
            let beyond = |k: usize| across.get(&(t[(k + 1) % 3], t[k])).copied();
            [0, 1, 2].map(|k| face + beyond(k).unwrap_or_default())
        });
        let edges = edges.collect();
        let nearest = Nearest::new(corners(), vertices[0]);
        Sides { nearest, triangles: triangles.to_vec(), faces, edges, vertices: at_vertices }
    }

    pub fn nearest(&self) -> &Nearest {
        &self.nearest
    }

    /// Signed distance \[m\]: negative behind the surface.
    pub fn signed_distance(&self, X: &Vector3) -> f64 {
        let place = self.nearest.to(X);
        let way = X - place.X;
        let distance = way.norm();
        if way.dot(&self.normal(&place)) <= 0.0 { -distance } else { distance }
    }

    fn normal(&self, place: &Place) -> Vector3 {
        let triangle = place.triangle as usize;
        match place.feature {
            Feature::Face => self.faces[triangle],
            Feature::Edge(k) => self.edges[triangle][k],
            Feature::Vertex(k) => self.vertices[self.triangles[triangle][k] as usize],
        }
    }
}

/// Of length 1, or 0 as that of a triangle without area.
fn unit(v: Vector3) -> Vector3 {
    v.try_normalize(0.0).unwrap_or_default()
}

/// Angle of a triangle at one of its corners \[rad\].
fn angle(corners: &Triangle, k: usize) -> f64 {
    let (u, v) = (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
    u.cross(&v).norm().atan2(u.dot(&v))
}
