//! Vertices of the boundary moved onto the edges and corners of the solid, which a lattice that
//! does not know of them cuts off.
#![allow(non_snake_case)]

use super::fill::fill_notches;
use super::mesh::Mesh;
use super::snap::moved;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::Shape;
use rayon::prelude::*;

/// Cosine of the angle between normals from which an edge is sharp \[–\].
const SHARP: f64 = 0.87;
/// The farthest that a vertex is moved, over the edge of the lattice \[–\].
const FARTHEST: f64 = 0.9;
/// What is left of a cell around a vertex that is moved, at least, as a fraction of it \[–\].
const LEFT: f64 = 0.12;
/// Weight of staying, over that of the faces \[–\].
const STAYING: f64 = 0.01;
/// Depth of a face below the surface from which it cuts something off, over the edge of the
/// lattice \[–\].
const DEEP: f64 = 0.08;
/// The smallest cell that is added, over the cube of that edge \[–\].
const SMALLEST: f64 = 1e-3;
/// How often notches are filled in a round, as each may leave others.
const MOST_FILLS: usize = 4;
/// Rounds, each from what the one before has left.
const ROUNDS: usize = 3;

/// The tangent plane of the solid at a face of the mesh.
struct Face {
    corners: Vec<u32>,
    normal: Vector3,
    /// A point of it \[m\].
    point: Vector3,
}

/// Moves vertices of the boundary of a mesh with cells of about `edge` \[m\] to where the planes
/// of the faces around them meet.
pub(crate) fn sharpen(mesh: &mut Mesh, shape: &Shape, edge: f64) {
    if !has_edges(shape) {
        return;
    }
    let plane = mesh.corners == 3;
    for _ in 0..ROUNDS {
        let faces: Vec<Face> = mesh
            .boundary()
            .into_par_iter()
            .map(|(corners, _)| face(mesh, shape, corners, plane))
            .collect();
        let mut at_vertex: Vec<Vec<u32>> = vec![Vec::new(); mesh.vertices.len()];
        for (number, face) in faces.iter().enumerate() {
            face.corners.iter().for_each(|&n| at_vertex[n as usize].push(number as u32));
        }
        let target = |(vertex, around): (usize, &Vec<u32>)| -> Option<(f64, usize, Vector3)> {
            let X = mesh.vertices[vertex];
            let planes: Vec<&Face> = around.iter().map(|&n| &faces[n as usize]).collect();
            let point = meeting(&X, &planes)?;
            let way = (point - X).norm();
            // Where the distance is not that of a sharp edge, nothing is gained.
            let nearer = shape.signed_distance(&point).abs() < 0.02 * edge;
            (way > 1e-6 * edge && way < FARTHEST * edge && nearer).then_some((way, vertex, point))
        };
        let mut targets: Vec<_> = at_vertex.par_iter().enumerate().filter_map(target).collect();
        targets.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let caps = if plane { Vec::new() } else { caps(mesh, shape, (&faces, &at_vertex), edge) };
        let cells = mesh.cells_around();
        for (_, vertex, point) in targets {
            moved(mesh, &cells, vertex, &point, LEFT);
        }
        add_caps(mesh, caps, edge);
        let mut left = if plane { 0 } else { MOST_FILLS };
        while left > 0 && fill_notches(mesh, shape, edge) {
            left -= 1;
        }
    }
}

/// A face that cuts a corner of the solid off, and the corner.
type Cap = (f64, Vec<u32>, Vector3);

/// The faces that lie deep in the solid, the deepest first, with the points where the planes
/// around them meet.
fn caps(
    mesh: &Mesh,
    shape: &Shape,
    (faces, at_vertex): (&[Face], &[Vec<u32>]),
    edge: f64,
) -> Vec<Cap> {
    let cap = |face: &Face| -> Option<Cap> {
        let centre = mesh.centre(&face.corners);
        let depth = (face.point - centre).dot(&face.normal);
        if depth < DEEP * edge {
            return None;
        }
        let around = face.corners.iter().flat_map(|&n| &at_vertex[n as usize]);
        let planes: Vec<&Face> = around.map(|&n| &faces[n as usize]).collect();
        let point = meeting(&centre, &planes)?;
        let on_it = shape.signed_distance(&point).abs() < 0.02 * edge;
        let near = (point - centre).norm() < FARTHEST * edge;
        (on_it && near).then(|| (depth, face.corners.clone(), point))
    };
    let mut caps: Vec<Cap> = faces.par_iter().filter_map(cap).collect();
    caps.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    caps
}

/// Adds a cell between each of these faces and its point, unless a neighbour has one already.
fn add_caps(mesh: &mut Mesh, caps: Vec<Cap>, edge: f64) {
    let mut used = vec![false; mesh.vertices.len()];
    for (_, corners, point) in caps {
        if corners.iter().any(|&n| used[n as usize]) {
            continue;
        }
        mesh.vertices.push(point);
        let cell = [&corners[..], &[mesh.vertices.len() as u32 - 1]].concat();
        if mesh.measure(&cell) < SMALLEST * edge.powi(3) {
            mesh.vertices.pop();
            continue;
        }
        corners.iter().for_each(|&n| used[n as usize] = true);
        mesh.cells.extend(cell);
        mesh.regions.push(0);
    }
}

/// Whether a solid may have sharp edges.
fn has_edges(shape: &Shape) -> bool {
    !matches!(shape, Shape::Sphere { .. } | Shape::Ellipsoid { .. } | Shape::Labels(_))
}

fn face(mesh: &Mesh, shape: &Shape, corners: Vec<u32>, plane: bool) -> Face {
    let centre = mesh.centre(&corners);
    let mut normal = shape.gradient(&centre);
    if plane {
        normal.z = 0.0;
    }
    let point = centre - normal * shape.signed_distance(&centre);
    Face { corners, normal, point }
}

/// Where planes meet, as near to a point as they leave it free; `None` where they are all alike.
fn meeting(X: &Vector3, planes: &[&Face]) -> Option<Vector3> {
    let sharp = |a: &&Face| planes.iter().any(|b| a.normal.dot(&b.normal) < SHARP);
    if !planes.iter().any(sharp) {
        return None;
    }
    let mut matrix = Matrix3::identity() * (STAYING * planes.len() as f64);
    let mut right = Vector3::zeros();
    for plane in planes {
        matrix += plane.normal * plane.normal.transpose();
        right += plane.normal * plane.normal.dot(&(plane.point - X));
    }
    Some(X + matrix.try_inverse()? * right)
}
