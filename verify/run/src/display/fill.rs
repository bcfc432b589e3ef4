//! Notches along sharp edges of the solid filled with cells.

use super::mesh::Mesh;
use mtled::geometry::Shape;
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};

/// The smallest cell that is added, over a cell of the lattice \[–\].
const SMALLEST: f64 = 2e-3;
/// How far outside of the solid the new edge may pass, over the edge of the lattice \[–\].
const OUTSIDE: f64 = 0.02;

/// Two sides of the boundary that meet at an edge, and the corners of the cell between them.
struct Notch {
    sides: [u32; 2],
    cell: [u32; 4],
    volume: f64,
}

/// Adds a cell wherever two sides of the boundary make a notch in which the solid has none: a
/// lattice cuts a sharp edge into steps, of which only the tips are on the edge. Returns whether
/// there were any.
pub(crate) fn fill_notches(mesh: &mut Mesh, shape: &Shape, edge: f64) -> bool {
    let sides = mesh.boundary();
    let mut meeting: HashMap<[u32; 2], Vec<(u32, u32)>> = HashMap::new();
    let mut order: Vec<[u32; 2]> = Vec::new();
    for (number, (side, _)) in sides.iter().enumerate() {
        for n in 0..3 {
            let (a, b, tip) = (side[n], side[(n + 1) % 3], side[(n + 2) % 3]);
            let ends = [a.min(b), a.max(b)];
            let known = meeting.entry(ends).or_default();
            if known.is_empty() {
                order.push(ends);
            }
            known.push((number as u32, tip));
        }
    }
    let around = mesh.cells_around();
    let smallest = SMALLEST * edge.powi(3) / 6.0;
    let notch = |&[a, b]: &[u32; 2]| -> Option<Notch> {
        let &[(first, p), (second, q)] = meeting[&[a, b]].as_slice() else { return None };
        // Of positive volume where the other tip lies in front of the first side.
        let side = &sides[first as usize].0;
        let cell = [side[0], side[1], side[2], q];
        let volume = mesh.measure(&cell);
        let tips = [p, q].map(|n| mesh.vertices[n as usize]);
        let inside = |x, most: f64| shape.signed_distance(&x) <= most;
        let fits = p != q
            && volume > smallest
            && !around.of(p as usize).iter().any(|&n| mesh.cell(n as usize).contains(&q))
            && inside(0.5 * (tips[0] + tips[1]), OUTSIDE * edge)
            && inside(mesh.centre(&cell), 0.0);
        fits.then_some(Notch { sides: [first, second], cell, volume })
    };
    let mut notches: Vec<Notch> = order.par_iter().filter_map(notch).collect();
    notches.sort_by(|a, b| b.volume.total_cmp(&a.volume).then(a.cell.cmp(&b.cell)));
    let (mut used, mut joined) = (vec![false; sides.len()], HashSet::new());
    let before = mesh.cells.len();
    for Notch { sides: [first, second], cell, .. } in notches {
        let tip = cell[..3].iter().find(|n| !sides[second as usize].0.contains(n));
        let Some(&tip) = tip else { continue };
        let ends = [tip.min(cell[3]), tip.max(cell[3])];
        let free = !used[first as usize] && !used[second as usize];
        if free && joined.insert(ends) {
            used[first as usize] = true;
            used[second as usize] = true;
            mesh.cells.extend(cell);
            mesh.regions.push(0);
        }
    }
    mesh.cells.len() > before
}
