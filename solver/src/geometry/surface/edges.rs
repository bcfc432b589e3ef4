//! Which triangle lies beyond each edge of another, and what is wrong where none or several do.
#![allow(non_snake_case)]

use crate::algebra::sets::Sets;
use crate::algebra::tensor::Vector3;
use crate::geometry::error::{EdgeFault, EdgeFaults, GeometryError};
use crate::geometry::primitives::perpendicular;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Faces around an edge whose angles differ by less lie on each other \[rad\].
const SAME_ANGLE: f64 = 1e-7;

/// Triangles of which each has one neighbour beyond each of its edges.
pub(super) struct Closed {
    /// Places where sheets only touch have a vertex for each of them \[m\].
    pub vertices: Vec<Vector3>,
    pub triangles: Vec<[u32; 3]>,
    /// The shell of each triangle; shells count in the order of their first triangles.
    pub shells: Vec<usize>,
}

/// Edge `k` of triangle `t` runs from its corner `k` to the next; its number is 3 t + k.
type Edge = u32;

/// Refuses triangles that are not closed. Where an edge has 2 n triangles, n along it and n
/// against it, those between which the solid lies are neighbours.
pub(super) fn closed(
    vertices: Vec<Vector3>,
    triangles: Vec<[u32; 3]>,
) -> Result<Closed, GeometryError> {
    let beyond = neighbours(&vertices, &triangles)?;
    let mut sets = Sets::new(triangles.len());
    for (edge, &other) in beyond.iter().enumerate() {
        sets.join(edge as u32 / 3, other / 3);
    }
    let mut numbers = BTreeMap::new();
    let shells = (0..triangles.len() as u32).map(|t| {
        let count = numbers.len();
        *numbers.entry(sets.first(t)).or_insert(count)
    });
    let shells = shells.collect();
    let (vertices, triangles) = split(vertices, triangles, &beyond);
    Ok(Closed { vertices, triangles, shells })
}

/// For each edge of each triangle the same edge of its neighbour.
fn neighbours(vertices: &[Vector3], triangles: &[[u32; 3]]) -> Result<Vec<Edge>, GeometryError> {
    let mut edges: Vec<(u32, u32, Edge, bool)> = Vec::with_capacity(3 * triangles.len());
    for (t, number) in triangles.iter().zip(0..) {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            edges.push((a.min(b), a.max(b), 3 * number + k as u32, a < b));
        }
    }
    edges.sort_unstable();
    let mut beyond = vec![Edge::MAX; edges.len()];
    let mut faults = EdgeFaults::default();
    for group in edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        let ends = [group[0].0, group[0].1].map(|v| vertices[v as usize]);
        let forward = group.iter().filter(|edge| edge.3).count();
        let mut join = |e: Edge, f: Edge| {
            beyond[e as usize] = f;
            beyond[f as usize] = e;
        };
        match (forward, group.len() - forward) {
            (1, 1) => join(group[0].2, group[1].2),
            (n, m) if n == m => {
                let third = |edge: Edge| {
                    vertices[triangles[edge as usize / 3][(edge as usize + 2) % 3] as usize]
                };
                paired(&ends, group.iter().map(|e| (e.2, e.3, third(e.2))), &mut join);
            }
            (n, m) => fault(&mut faults, n + m).add(ends),
        }
    }
    if faults == EdgeFaults::default() { Ok(beyond) } else { Err(Box::new(faults).into()) }
}

/// The kind of fault of an edge with so many triangles, more of them along it than against it
/// or the other way round.
fn fault(faults: &mut EdgeFaults, count: usize) -> &mut EdgeFault {
    match count {
        1 => &mut faults.open,
        2 => &mut faults.turned,
        _ => &mut faults.crowded,
    }
}

/// Joins the triangles around an edge between which the solid lies: one against its direction
/// and the next along it, going round anticlockwise, of several the inner ones first.
fn paired(
    [a, b]: &[Vector3; 2],
    around: impl Iterator<Item = (Edge, bool, Vector3)>,
    join: &mut impl FnMut(Edge, Edge),
) {
    let Some(along) = (b - a).try_normalize(0.0) else { return };
    let (u, v) = perpendicular(&along);
    let angle = |X: Vector3| {
        let angle = (X - a).dot(&v).atan2((X - a).dot(&u));
        let angle = if angle < SAME_ANGLE - PI { angle + TAU } else { angle };
        (angle / SAME_ANGLE).round() as i64
    };
    // Of faces on each other the one that ends the solid first.
    let mut faces: Vec<(i64, bool, Edge)> =
        around.map(|(edge, forward, X)| (angle(X), !forward, edge)).collect();
    faces.sort_unstable();
    let mut depth = 0;
    let depths = faces.iter().enumerate().map(|(n, face)| {
        depth += if face.1 { 1 } else { -1 };
        (depth, n)
    });
    let start = depths.min().map_or(0, |(_, n)| (n + 1) % faces.len());
    faces.rotate_left(start);
    let mut waiting = Vec::new();
    for (_, opens, edge) in faces {
        if opens {
            waiting.push(edge)
        } else if let Some(other) = waiting.pop() {
            join(edge, other);
        }
    }
}

/// A vertex for each fan of triangles around one, so that sheets that touch do not share any.
fn split(
    mut vertices: Vec<Vector3>,
    mut triangles: Vec<[u32; 3]>,
    beyond: &[Edge],
) -> (Vec<Vector3>, Vec<[u32; 3]>) {
    let next = |edge: u32| edge / 3 * 3 + (edge + 1) % 3;
    let mut fans = Sets::new(beyond.len());
    for (edge, &other) in (0..).zip(beyond) {
        fans.join(edge, next(other));
    }
    let mut first = vec![u32::MAX; vertices.len()];
    let mut own = BTreeMap::new();
    for corner in 0..beyond.len() as u32 {
        let fan = fans.first(corner);
        let vertex = &mut triangles[corner as usize / 3][corner as usize % 3];
        let kept = &mut first[*vertex as usize];
        if *kept == u32::MAX {
            *kept = fan;
        }
        if *kept != fan {
            let at = vertices[*vertex as usize];
            *vertex = *own.entry(fan).or_insert_with(|| {
                vertices.push(at);
                vertices.len() as u32 - 1
            });
        }
    }
    (vertices, triangles)
}
