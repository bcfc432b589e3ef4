//! Patches of quadrature points, over which J is projected where a material is
//! nearly incompressible (method book, section 10).
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::quadrature::Quadrature;
use std::ops::Range;

/// Edge of a patch over the nodal spacing \[–\]. At 2.5 the bonded cube of 12
/// spacings is 1.1 % too stiff instead of 0.7 %, and pressures are 10 % worse, for
/// displacements that are 2 % better.
const EDGE: f64 = 3.0;
/// Lengths and volumes that differ by less than this fraction are equal: on a
/// grid they tie, and round-off must not choose the patches \[–\].
const SAME: f64 = 1e-9;
/// A direction in which a patch is thinner than this fraction of its widest
/// gets no linear function \[–\].
const FLATTEST: f64 = 0.15;

/// Sorts the points of each region into patches by recursive bisection and
/// returns where patches start, the end included. `spacing` is that of the
/// nodes around each point \[m\]; a patch is no larger than
/// (3 spacings)^`components` (method book, eq. 10.1).
pub fn sort_into_patches(
    quadrature: &mut Quadrature,
    spacing: &[f64],
    thickness: f64,
    components: usize,
) -> Vec<usize> {
    let mut order: Vec<u32> = (0..quadrature.positions.len() as u32).collect();
    order.sort_by_key(|&q| quadrature.regions[q as usize]);
    let bisection = Bisection { quadrature, spacing, thickness, components };
    let mut starts = vec![0];
    for same in order.chunk_by_mut(|&a, &b| bisection.region(a) == bisection.region(b)) {
        let ascending = [0, 1, 2].map(|axis| bisection.ascending(same, axis));
        for count in bisection.split(same, ascending) {
            starts.push(starts[starts.len() - 1] + count);
        }
    }
    let all = || order.iter().map(|&q| q as usize);
    let positions = all().map(|q| quadrature.positions[q]).collect();
    let weights = all().map(|q| quadrature.weights[q]).collect();
    let regions = all().map(|q| quadrature.regions[q]).collect();
    (quadrature.positions, quadrature.weights, quadrature.regions) = (positions, weights, regions);
    starts
}

/// Fewer points than this run on one thread.
const FEWEST_PARALLEL: usize = 4096;

struct Bisection<'a> {
    quadrature: &'a Quadrature,
    spacing: &'a [f64],
    thickness: f64,
    components: usize,
}

impl Bisection<'_> {
    fn region(&self, q: u32) -> u16 {
        self.quadrature.regions[q as usize]
    }

    fn at(&self, q: u32, axis: usize) -> f64 {
        self.quadrature.positions[q as usize][axis]
    }

    /// Places in `points`, by ascending coordinate.
    fn ascending(&self, points: &[u32], axis: usize) -> Vec<u32> {
        let mut places: Vec<(f64, u32)> =
            points.iter().zip(0..).map(|(&q, place)| (self.at(q, axis), place)).collect();
        places.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        places.into_iter().map(|(_, place)| place).collect()
    }

    /// Halves a set of points across its longest edge until it fits a patch;
    /// returns the numbers of points of its patches. `ascending` are places in
    /// `points` by coordinate along each axis.
    fn split(&self, points: &mut [u32], ascending: [Vec<u32>; 3]) -> Vec<usize> {
        let count = points.len() as f64;
        let volume: f64 = points.iter().map(|&q| self.quadrature.weights[q as usize]).sum();
        let spacing = points.iter().map(|&q| self.spacing[q as usize]).sum::<f64>() / count;
        let largest = (EDGE * spacing).powi(self.components as i32) * self.thickness;
        if volume <= largest * (1.0 + SAME) || points.len() < 2 {
            return vec![points.len()];
        }
        let edges = [0, 1, 2].map(|k| {
            let end = |place: u32| self.at(points[place as usize], k);
            end(ascending[k][points.len() - 1]) - end(ascending[k][0])
        });
        let longest = edges.iter().copied().fold(0.0, f64::max);
        let across = (0..3).find(|&k| edges[k] >= longest * (1.0 - SAME)).unwrap_or(0);
        let order = self.in_layers(points, &ascending, across, SAME * longest);
        let sorted: Vec<u32> = order.iter().map(|&place| points[place as usize]).collect();
        points.copy_from_slice(&sorted);
        let (mut below, mut middle) = (0.0, 0);
        while middle < points.len() - 1 && below < 0.5 * volume * (1.0 - SAME) {
            below += self.quadrature.weights[points[middle] as usize];
            middle += 1;
        }
        let middle = middle.max(1);
        let (low_places, high_places) = halve(&order, ascending, middle);
        let (low, high) = points.split_at_mut(middle);
        let halves = (|| self.split(low, low_places), || self.split(high, high_places));
        let (mut counts, others) = if sorted.len() < FEWEST_PARALLEL {
            (halves.0(), halves.1())
        } else {
            rayon::join(halves.0, halves.1)
        };
        counts.extend(others);
        counts
    }

    /// Places of the points by their layers along the axis `across`, those of one
    /// layer by their layers along the next axis and so on. A layer holds points
    /// each within `same` \[m\] of the one before; where all layers agree, points
    /// keep their order.
    fn in_layers(
        &self,
        points: &[u32],
        ascending: &[Vec<u32>; 3],
        across: usize,
        same: f64,
    ) -> Vec<u32> {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let mut layers = vec![0; points.len()];
        for turn in (0..3).rev() {
            let axis = (across + turn) % 3;
            let at = |place: u32| self.at(points[place as usize], axis);
            let (mut layer, mut last) = (0, at(ascending[axis][0]));
            for &place in &ascending[axis] {
                let here = at(place);
                layer += (here - last > same) as u32;
                layers[place as usize] = layer;
                last = here;
            }
            order = counting_sort(&order, &layers, layer as usize + 1);
        }
        order
    }
}

/// `order` sorted by the layers of its members, of which there are `count`; stable.
fn counting_sort(order: &[u32], layers: &[u32], count: usize) -> Vec<u32> {
    let mut next = vec![0u32; count + 1];
    layers.iter().for_each(|&layer| next[layer as usize + 1] += 1);
    for layer in 1..count {
        next[layer] += next[layer - 1];
    }
    let mut sorted = vec![0; order.len()];
    for &place in order {
        let slot = &mut next[layers[place as usize] as usize];
        sorted[*slot as usize] = place;
        *slot += 1;
    }
    sorted
}

/// Ascending places of the two halves of points that were brought into `order`.
fn halve(order: &[u32], ascending: [Vec<u32>; 3], middle: usize) -> ([Vec<u32>; 3], [Vec<u32>; 3]) {
    let mut moved = vec![0; order.len()];
    order.iter().zip(0..).for_each(|(&place, now)| moved[place as usize] = now);
    let half = |range: Range<usize>| {
        [0, 1, 2].map(|axis| {
            let within = |&place: &u32| {
                let now = moved[place as usize] as usize;
                range.contains(&now).then(|| (now - range.start) as u32)
            };
            ascending[axis].iter().filter_map(within).collect()
        })
    };
    (half(0..middle), half(middle..order.len()))
}

/// 1, X, Y, Z made orthonormal over the points of a patch with their weights:
/// Σ_q w_q B_b B_c = δ_bc \[m^−3/2\] (method book, eq. 10.2). Functions for which
/// the patch is too small or too flat are 0.
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
    let variance = |k: usize| -> f64 {
        let squares = positions.iter().zip(weights).map(|(X, w)| w * (X[k] - centre[k]).powi(2));
        squares.sum()
    };
    let widest = (0..components).map(variance).fold(0.0, f64::max);
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
    use crate::discretisation::quadrature::quadrature;
    use crate::geometry::{Selector, Shape};
    use crate::material::{ElasticConstants, Law, Material, NeoHookeanLogJ};
    use crate::problem::{BackgroundGrid, Dimension, Region};

    /// Starts of patches and sorted points \[edge\] of a cube of edge `size`
    /// \[m\] at `at` \[m\], on a grid that fits it.
    fn patches(size: f64, at: Vector3) -> (Vec<usize>, Vec<Vector3>) {
        let body = Shape::Box { min: at, max: at + Vector3::repeat(size) };
        let constants = ElasticConstants::from_young_poisson(3000.0, 0.49).unwrap();
        let law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants));
        let material = Material { density: 1000.0, law };
        let regions = [Region::new("all", Selector::All, material)];
        let grid = BackgroundGrid::with_cell(size / 7.0);
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
