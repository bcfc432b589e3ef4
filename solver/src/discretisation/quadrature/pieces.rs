//! The pieces into which gaps of the body divide a cell (method book, section 7).
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::geometry::{Place, Shape};

/// Members of a piece from which others are looked for.
const SCOUTS: usize = 24;

/// A sub-cell, or the part of it that is inside.
pub(super) struct Leaf {
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

/// The piece of each sub-cell of a cell of some edge \[m\], numbered by their first
/// members: those that no gap keeps apart belong together.
pub(super) fn pieces(body: &Shape, leaves: &[Leaf], edge: f64) -> Vec<usize> {
    let places: Vec<Place> = leaves.iter().map(|leaf| body.place(&leaf.centroid)).collect();
    // Scouts are the largest.
    let mut left: Vec<usize> = (0..leaves.len()).collect();
    left.sort_by(|&a, &b| leaves[b].volume.total_cmp(&leaves[a].volume));
    let mut piece = vec![usize::MAX; leaves.len()];
    let mut count = 0;
    while !left.is_empty() {
        let mut members = vec![left.remove(0)];
        let mut scout = 0;
        while scout < members.len().min(SCOUTS) && !left.is_empty() {
            let from = &places[members[scout]];
            let apart = |leaf: &usize| body.parts(from, &places[*leaf], edge);
            let (apart, joined): (Vec<usize>, Vec<usize>) = left.into_iter().partition(apart);
            left = apart;
            members.extend(joined);
            scout += 1;
        }
        members.iter().for_each(|&leaf| piece[leaf] = count);
        count += 1;
    }
    renumbered(piece, count)
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

    #[test]
    fn sub_cells_on_both_sides_of_a_slit_are_two_pieces_however_narrow_it_is() {
        for width in [1e-3, 0.01, 0.1, 0.3] {
            let block = |low: f64, high: f64| Shape::Box {
                min: Vector3::new(-3.0, -3.0, low),
                max: Vector3::new(3.0, 3.0, high),
            };
            let body = Shape::Union(vec![block(-3.0, 0.0), block(width, 3.0)]);
            let leaf = |n: usize| Leaf {
                region: 0,
                centroid: Vector3::new(
                    0.2 * (n % 4) as f64,
                    0.1 * (n % 3) as f64,
                    heights(n, width),
                ),
                volume: 1.0 + (n % 5) as f64,
                spread: Matrix3::zeros(),
            };
            let leaves: Vec<Leaf> = (0..40).map(leaf).collect();
            let expected: Vec<usize> = (0..40).map(|n| n % 2).collect();
            assert_eq!(pieces(&body, &leaves, 1.0), expected, "width {width}");
            // Without the slit there is one.
            let whole = Shape::Union(vec![block(-3.0, 0.0), block(0.0, 3.0)]);
            assert_eq!(pieces(&whole, &leaves, 1.0), vec![0; 40], "width {width}");
        }
    }

    /// Below 0 and above the width by turns.
    fn heights(n: usize, width: f64) -> f64 {
        let depth = 0.004 + 0.07 * (n / 2) as f64;
        if n % 2 == 0 { -depth } else { width + depth }
    }
}
