//! Vertices moved onto a level that passes close to them, so that cuts leave no slivers.
#![allow(non_snake_case)]

use super::cut::{crossed_edges, crossing};
use super::mesh::{CellsAround, Mesh};
use mtled::algebra::tensor::Vector3;
use rayon::prelude::*;

/// Fraction of an edge within which its end is moved to where the edge is cut \[–\].
const NEAR: f64 = 0.25;
/// What is left of a cell around a vertex that is moved, at least, as a fraction of it \[–\].
const LEFT: f64 = 0.25;

/// A vertex that may be moved to a point of the level.
struct Candidate {
    fraction: f64,
    vertex: u32,
    /// The other end of the edge.
    other: u32,
    point: Vector3,
}

/// How vertices may move.
pub(crate) struct Freedom {
    /// Those that stay where they are.
    pub fixed: Vec<bool>,
    /// A bit for each side of the lattice that a vertex is on, and stays on.
    pub sides: Vec<u8>,
}

impl Freedom {
    /// All vertices may move but those that are fixed.
    pub(crate) fn but(fixed: Vec<bool>) -> Freedom {
        Freedom { sides: vec![0; fixed.len()], fixed }
    }
}

/// Moves vertices that are near to the zero of `level`, of which they have `values`, onto it
/// where no cell around becomes too small, and sets their values to 0; those of fixed vertices
/// too, which stay where they are.
pub(crate) fn snap(
    mesh: &mut Mesh,
    values: &mut [f64],
    level: &(dyn Fn(&Vector3) -> f64 + Sync),
    freedom: &Freedom,
) {
    let edges = crossed_edges(mesh, values);
    let near = |&[a, b]: &[u32; 2]| -> Option<Candidate> {
        let [A, B] = [a, b].map(|n| &mesh.vertices[n as usize]);
        let t = crossing(level, [A, B], [values[a as usize], values[b as usize]]);
        let (vertex, other, fraction) = if t < 0.5 { (a, b, t) } else { (b, a, 1.0 - t) };
        let point = A + (B - A) * t;
        let leaves = freedom.sides[vertex as usize] & !freedom.sides[other as usize] != 0;
        (fraction < NEAR && !leaves).then_some(Candidate { fraction, vertex, other, point })
    };
    let mut candidates: Vec<Candidate> = edges.par_iter().filter_map(near).collect();
    candidates.sort_by(|a, b| {
        a.fraction.total_cmp(&b.fraction).then(a.vertex.cmp(&b.vertex)).then(a.other.cmp(&b.other))
    });
    let around = mesh.cells_around();
    for Candidate { vertex, other, point, .. } in candidates {
        let [vertex, other] = [vertex, other].map(|n| n as usize);
        if values[vertex] == 0.0 || values[other] == 0.0 {
            continue;
        }
        if freedom.fixed[vertex] || moved(mesh, &around, vertex, &point, LEFT) {
            values[vertex] = 0.0;
        }
    }
}

/// Moves a vertex unless a cell around it would keep less than a fraction of its measure.
pub(crate) fn moved(
    mesh: &mut Mesh,
    around: &CellsAround,
    vertex: usize,
    point: &Vector3,
    left: f64,
) -> bool {
    let cells = around.of(vertex);
    let measures = |mesh: &Mesh| -> Vec<f64> {
        cells.iter().map(|&cell| mesh.measure(mesh.cell(cell as usize))).collect()
    };
    let before = measures(mesh);
    let place = std::mem::replace(&mut mesh.vertices[vertex], *point);
    let sound = measures(mesh).iter().zip(&before).all(|(after, before)| *after > left * before);
    if !sound {
        mesh.vertices[vertex] = place;
    }
    sound
}
