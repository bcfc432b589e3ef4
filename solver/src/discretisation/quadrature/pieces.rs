//! The pieces into which gaps of the body divide a cell (method book, section 7).
#![allow(non_snake_case)]

use crate::algebra::sets::Sets;
use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::quadrature::borders::owner;
use crate::discretisation::quadrature::cell::Cell;
use crate::geometry::{Place, Shape, indices};
use crate::problem::Region;

/// A sub-cell, or a part of it that is inside.
pub(super) struct Leaf {
    pub cell: Cell,
    pub region: usize,
    /// \[m\]
    pub centroid: Vector3,
    /// \[m³\]
    pub volume: f64,
    /// Second moments about the centroid over the volume \[m²\].
    pub spread: Matrix3,
}

/// Inside part of a cell.
#[derive(Clone, Default)]
pub(super) struct Moments {
    /// \[m³\]
    pub volume: f64,
    /// \[m⁴\]
    pub first: Vector3,
    /// About the centre of the cell, if points are moved afterwards \[m⁵\].
    pub second: Matrix3,
}

impl Moments {
    /// Second moments are added about an origin, if there is one.
    pub fn add(&mut self, leaf: &Leaf, origin: Option<&Vector3>) {
        self.volume += leaf.volume;
        self.first += leaf.centroid * leaf.volume;
        if let Some(origin) = origin {
            let offset = leaf.centroid - origin;
            self.second += (leaf.spread + offset * offset.transpose()) * leaf.volume;
        }
    }
}

/// The piece of each sub-cell of a cell, numbered by their first members: those that touch
/// without a gap between their centroids belong together, and so do pieces whose largest
/// sub-cells see each other.
pub(super) fn pieces(body: &Shape, cell: &Cell, leaves: &[Leaf], components: usize) -> Vec<usize> {
    let places: Vec<Place> = leaves.iter().map(|leaf| body.place(&leaf.centroid)).collect();
    let mut sets = Sets::new(leaves.len());
    let join = |sets: &mut Sets, a: u32, b: u32| {
        let (one, other) = (&places[a as usize], &places[b as usize]);
        if sets.first(a) != sets.first(b) && !body.parts(one, other, cell.edge) {
            sets.join(a, b);
        }
    };
    for (a, b) in touching(cell, leaves, components) {
        join(&mut sets, a, b);
    }
    let all = 0..leaves.len() as u32;
    let mut largest: Vec<u32> = Vec::new();
    for leaf in all.clone() {
        let own = sets.first(leaf);
        let volume = |leaf: u32| leaves[leaf as usize].volume;
        match largest.iter_mut().find(|other| sets.first(**other) == own) {
            Some(other) if volume(leaf) > volume(*other) => *other = leaf,
            Some(_) => {}
            None => largest.push(leaf),
        }
    }
    for (n, &a) in largest.iter().enumerate() {
        largest[..n].iter().for_each(|&b| join(&mut sets, a, b));
    }
    renumbered(all.map(|leaf| sets.first(leaf) as usize).collect(), leaves.len())
}

/// Parts of a way between two sub-cells, between which its region is looked at.
const LOOKS: usize = 8;

/// The piece of each sub-cell where another region lies between parts of one: a sub-cell belongs to the
/// first piece to whose largest one the straight way stays in its region.
pub(super) fn pieces_by_sight(regions: &[Region], leaves: &[Leaf]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..leaves.len()).collect();
    order.sort_by(|&a, &b| leaves[b].volume.total_cmp(&leaves[a].volume));
    let sees = |a: &Leaf, b: &Leaf| {
        let at = |n: usize| a.centroid + (b.centroid - a.centroid) * (n as f64 / LOOKS as f64);
        a.region == b.region && (1..LOOKS).all(|n| owner(regions, &at(n)) == Some(a.region))
    };
    let mut largest: Vec<usize> = Vec::new();
    let mut piece = vec![0; leaves.len()];
    for leaf in order {
        let seen = |&first: &usize| sees(&leaves[first], &leaves[leaf]);
        piece[leaf] = largest.iter().position(seen).unwrap_or_else(|| {
            largest.push(leaf);
            largest.len() - 1
        });
    }
    piece
}

/// Pairs of parts of sub-cells that share a face or are in the same one, some more than once.
fn touching(cell: &Cell, leaves: &[Leaf], components: usize) -> Vec<(u32, u32)> {
    const NONE: u32 = u32::MAX;
    // The smallest sub-cells are that part of the cell.
    let smallest = leaves.iter().map(|leaf| leaf.cell.edge).fold(cell.edge, f64::min);
    let finest = (cell.edge / smallest).round() as usize;
    let size = [finest, finest, if components == 3 { finest } else { 1 }];
    let step = cell.edge / finest as f64;
    let mut owner = vec![NONE; size.iter().product()];
    let index = |[i, j, k]: [usize; 3]| (k * size[1] + j) * size[0] + i;
    let mut pairs = Vec::new();
    for (leaf, number) in leaves.iter().zip(0..) {
        let count = (leaf.cell.edge / step).round().max(1.0) as usize;
        let corner =
            leaf.cell.centre - cell.centre + Vector3::repeat(0.5 * (cell.edge - leaf.cell.edge));
        let first = [0, 1, 2].map(|axis| match size[axis] {
            1 => 0,
            most => ((corner[axis] / step).round().max(0.0) as usize).min(most - count),
        });
        for at in indices([0, 1, 2].map(|axis| count.min(size[axis]))) {
            let owner = &mut owner[index([0, 1, 2].map(|axis| first[axis] + at[axis]))];
            if *owner != NONE && pairs.last() != Some(&(*owner, number)) {
                pairs.push((*owner, number));
            }
            *owner = number;
        }
    }
    let steps = [1, size[0], size[0] * size[1]];
    for (at, own) in indices(size).zip(0..) {
        let a = owner[own];
        if a == NONE {
            continue;
        }
        for axis in (0..components).filter(|&axis| at[axis] + 1 < size[axis]) {
            let b = owner[own + steps[axis]];
            if b != NONE && a != b && pairs.last() != Some(&(a, b)) {
                pairs.push((a, b));
            }
        }
    }
    pairs
}

/// Numbers in the order of their first appearance.
fn renumbered(mut numbers: Vec<usize>, count: usize) -> Vec<usize> {
    let mut new = vec![usize::MAX; count];
    let mut next = 0;
    for number in &mut numbers {
        if new[*number] == usize::MAX {
            new[*number] = next;
            next += 1;
        }
        *number = new[*number];
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    const FINEST: usize = 16;

    fn block(low: f64, high: f64) -> Shape {
        Shape::Box { min: Vector3::new(-3.0, -3.0, low), max: Vector3::new(3.0, 3.0, high) }
    }

    /// The finest sub-cells of a unit cell around the origin whose centres are inside.
    fn leaves(body: &Shape, cell: Cell) -> Vec<Leaf> {
        let inside = cell.divide(FINEST, 3).filter(|part| body.signed_distance(&part.centre) < 0.0);
        let leaf = |cell: Cell| {
            let (centroid, spread) = (cell.centre, Matrix3::zeros());
            Leaf { cell, region: 0, centroid, volume: cell.edge.powi(3), spread }
        };
        inside.map(leaf).collect()
    }

    #[test]
    fn sub_cells_on_both_sides_of_a_slit_are_two_pieces_however_narrow_it_is() {
        let cell = Cell { centre: Vector3::zeros(), edge: 1.0 };
        for width in [1e-3, 0.01, 0.1, 0.3] {
            let body = Shape::Union(vec![block(-3.0, 0.01), block(0.01 + width, 3.0)]);
            let leaves = leaves(&body, cell);
            let found = pieces(&body, &cell, &leaves, 3);
            for (leaf, piece) in leaves.iter().zip(found) {
                assert_eq!(piece, (leaf.centroid.z > 0.01) as usize, "width {width}");
            }
            // Without the slit there is one.
            let whole = Shape::Union(vec![block(-3.0, 0.01), block(0.01, 3.0)]);
            let found = pieces(&whole, &cell, &leaves, 3);
            assert!(width > 0.05 || found.iter().all(|&piece| piece == 0), "width {width}");
        }
    }
}
