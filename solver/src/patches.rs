//! Patches of quadrature points, over which J is projected where a material
//! hardly changes its volume (method §3).
#![allow(non_snake_case)]

use crate::quadrature::Quadrature;
use crate::tensor::Vector3;
use std::ops::Range;

/// Edge of a patch over the nodal spacing \[–\]. At 2.5 the bonded cube of 12
/// spacings is 1.1 % too stiff instead of 0.7 %, and pressures are 10 % worse, for
/// displacements that are 2 % better.
const EDGE: f64 = 3.0;
/// Lengths and volumes that differ by less than this share are the same: on a
/// grid they tie, and round-off must not choose the patches \[–\].
const SAME: f64 = 1e-9;
/// A direction in which a patch is thinner than this share of its widest
/// carries no slope \[–\].
const FLATTEST: f64 = 0.15;

/// Sorts the points of each region into patches by recursive bisection and
/// returns where patches start, the end included. `spacing` is that of the
/// nodes around each point \[m\]; a patch is no larger than
/// (3 spacings)^`components`.
pub fn sort_into_patches(
    quadrature: &mut Quadrature,
    spacing: &[f64],
    thickness: f64,
    components: usize,
) -> Vec<usize> {
    let mut order: Vec<usize> = (0..quadrature.positions.len()).collect();
    order.sort_by_key(|&q| (quadrature.regions[q], q));
    let mut starts = vec![0];
    let mut from = 0;
    while from < order.len() {
        let region = quadrature.regions[order[from]];
        let same = order[from..].iter().take_while(|&&q| quadrature.regions[q] == region).count();
        let bisection = Bisection { quadrature, spacing, thickness, components };
        bisection.split(&mut order[from..from + same], &mut starts);
        from += same;
    }
    quadrature.positions = order.iter().map(|&q| quadrature.positions[q]).collect();
    quadrature.weights = order.iter().map(|&q| quadrature.weights[q]).collect();
    quadrature.regions = order.iter().map(|&q| quadrature.regions[q]).collect();
    starts
}

struct Bisection<'a> {
    quadrature: &'a Quadrature,
    spacing: &'a [f64],
    thickness: f64,
    components: usize,
}

impl Bisection<'_> {
    /// Halves a set of points across its longest edge until it fits a patch.
    fn split(&self, points: &mut [usize], starts: &mut Vec<usize>) {
        let positions = &self.quadrature.positions;
        let count = points.len() as f64;
        let volume: f64 = points.iter().map(|&q| self.quadrature.weights[q]).sum();
        let spacing = points.iter().map(|&q| self.spacing[q]).sum::<f64>() / count;
        let largest = (EDGE * spacing).powi(self.components as i32) * self.thickness;
        if volume <= largest * (1.0 + SAME) || points.len() < 2 {
            starts.push(starts[starts.len() - 1] + points.len());
            return;
        }
        let first = positions[points[0]];
        let (min, max) = points
            .iter()
            .fold((first, first), |(l, u), &q| (l.inf(&positions[q]), u.sup(&positions[q])));
        let longest = (max - min).max();
        let across = (0..3).find(|&k| max[k] - min[k] >= longest * (1.0 - SAME)).unwrap_or(0);
        for turn in (0..3).rev() {
            self.sort_into_layers(points, (across + turn) % 3, SAME * longest);
        }
        let (mut below, mut middle) = (0.0, 0);
        while middle < points.len() - 1 && below < 0.5 * volume * (1.0 - SAME) {
            below += self.quadrature.weights[points[middle]];
            middle += 1;
        }
        let (low, high) = points.split_at_mut(middle.max(1));
        self.split(low, starts);
        self.split(high, starts);
    }

    /// Sorts points along an axis; points of one layer, each within `same`
    /// \[m\] of the one before, keep their order.
    fn sort_into_layers(&self, points: &mut [usize], axis: usize, same: f64) {
        let at = |q: usize| self.quadrature.positions[q][axis];
        let mut coordinates: Vec<f64> = points.iter().map(|&q| at(q)).collect();
        coordinates.sort_by(f64::total_cmp);
        let edges: Vec<f64> = coordinates
            .windows(2)
            .filter(|pair| pair[1] - pair[0] > same)
            .map(|pair| 0.5 * (pair[0] + pair[1]))
            .collect();
        points.sort_by_key(|&q| edges.partition_point(|&edge| edge < at(q)));
    }
}

/// 1, X, Y, Z made orthonormal over the points of a patch with their weights:
/// Σ_q w_q B_b B_c = δ_bc \[m^−3/2\]. Functions that the patch is too small or
/// too flat for are 0.
pub fn orthonormal_basis(
    positions: &[Vector3],
    weights: &[f64],
    points: Range<usize>,
    components: usize,
) -> Vec<[f64; 4]> {
    let (positions, weights) = (&positions[points.clone()], &weights[points]);
    let volume: f64 = weights.iter().sum();
    let centre: Vector3 =
        positions.iter().zip(weights).map(|(X, w)| X * *w).sum::<Vector3>() / volume;
    let mut basis = vec![[1.0 / volume.sqrt(), 0.0, 0.0, 0.0]; positions.len()];
    if positions.len() < 2 * (components + 1) {
        return basis;
    }
    let spread = |k: usize| -> f64 {
        let squares = positions.iter().zip(weights).map(|(X, w)| w * (X[k] - centre[k]).powi(2));
        squares.sum()
    };
    let widest = (0..components).map(spread).fold(0.0, f64::max);
    for k in 0..components {
        let mut column: Vec<f64> = positions.iter().map(|X| X[k] - centre[k]).collect();
        for _ in 0..2 {
            for b in 0..=k {
                let overlap: f64 =
                    (0..column.len()).map(|q| weights[q] * column[q] * basis[q][b]).sum();
                column.iter_mut().zip(&basis).for_each(|(c, row)| *c -= overlap * row[b]);
            }
        }
        let size: f64 = column.iter().zip(weights).map(|(c, w)| w * c * c).sum();
        if size > FLATTEST * FLATTEST * widest {
            column.iter().zip(&mut basis).for_each(|(c, row)| row[k + 1] = c / size.sqrt());
        }
    }
    basis
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Shape;
    use crate::material::{ElasticConstants, Law, Material, NeoHookeanLogJ};
    use crate::problem::{BackgroundGrid, Dimension, InsideRule, Region};
    use crate::quadrature::quadrature;
    use crate::selection::Selector;

    /// Starts of patches and sorted points \[edge\] of a cube of edge `size`
    /// \[m\] at `at` \[m\], on a grid that fits it.
    fn patches(size: f64, at: Vector3) -> (Vec<usize>, Vec<Vector3>) {
        let body = Shape::Box { min: at, max: at + Vector3::repeat(size) };
        let constants = ElasticConstants::from_young_poisson(3000.0, 0.49).unwrap();
        let law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants));
        let material = Material { density: 1000.0, law };
        let regions = [Region { name: "all".into(), part: Selector::All, material }];
        let grid = BackgroundGrid {
            cell: size / 7.0,
            boundary_cell: None,
            refinements: Vec::new(),
            gauss_points: 1,
            inside: InsideRule::VolumeFraction,
        };
        let mut points = quadrature(&body, &regions, &grid, &Dimension::Three).unwrap();
        let spacing = vec![size / 6.0; points.positions.len()];
        let starts = sort_into_patches(&mut points, &spacing, 1.0, 3);
        (starts, points.positions.iter().map(|X| (X - at) / size).collect())
    }

    #[test]
    fn patches_do_not_depend_on_the_unit_or_the_place() {
        let (starts, positions) = patches(1.0, Vector3::zeros());
        let places = [Vector3::zeros(), Vector3::new(6.0, -7.0, 4.0)];
        for (size, place) in [1e-6, 0.1, 3e4].into_iter().zip(places.into_iter().cycle()) {
            let (others, moved) = patches(size, place * size);
            assert_eq!(starts, others, "edge {size} m");
            for (a, b) in positions.iter().zip(&moved) {
                assert!((a - b).norm() < 1e-9, "edge {size} m: {a:?} against {b:?}");
            }
        }
    }
}
