//! An additive multilevel preconditioner (Bramble, Pasciak, Xu 1990) on
//! nested lattices of quadratic B-splines.
//!
//! B r = Σ_l P_l D_l⁻¹ P_lᵀ r, to which the blocks of the nodes are added: P_l evaluates
//! coefficients of lattice l at the nodes, D_l estimates the diagonal of P_lᵀ K P_l
//! (method book, eqs. 9.8 and 9.9). The number of iterations does not grow with the
//! number of nodes.
#![allow(non_snake_case)]

use crate::algebra::random::xorshift;
use crate::algebra::spline_lattice::{Lattice, Reach};
use crate::algebra::tensor::Vector3;
use crate::discretisation::consistency::operator::{Layout, Operator};
use nalgebra::{SMatrix, Vector4};
use rayon::prelude::*;

/// Spacing of the finest lattice over that of the nodes \[–\].
const FINEST: f64 = 1.5;
/// Points from which the size of a level's diagonal is estimated.
const SAMPLES: usize = 250;
/// More functions than this make the finest lattice coarser.
const MOST_FUNCTIONS: usize = 4_000_000;
/// Chunks of nodes whose moments are computed in parallel, and the fewest nodes of one.
const CHUNKS: (usize, usize) = (16, 2048);
/// Samples of one parallel task.
const SAMPLES_PER_TASK: usize = 16;

/// The preconditioner B.
pub(super) struct Multilevel {
    /// Functions of the finest lattice at each node.
    reaches: Vec<Reach>,
    /// From fine to coarse.
    levels: Vec<Level>,
}

struct Level {
    lattice: Lattice,
    inverse_diagonal: Vec<f64>,
}

impl Multilevel {
    pub fn new(
        operator: &Operator,
        layout: &Layout,
        diagonal: &[SMatrix<f64, 1, 1>],
    ) -> Multilevel {
        let mean = layout.spacing.iter().sum::<f64>() / layout.spacing.len() as f64;
        let smallest = layout.spacing.iter().copied().fold(f64::INFINITY, f64::min);
        let mut edge = FINEST * smallest;
        let mut lattice = Lattice::new(layout.nodes, edge, layout.components);
        let most = MOST_FUNCTIONS.min(8 * layout.nodes.len() + 64);
        while lattice.len() > most {
            edge *= 1.2;
            lattice = Lattice::new(layout.nodes, edge, layout.components);
        }
        // Bending of a smooth function between neighbours grows as h⁴.
        let bending: Vec<f64> = layout.spacing.iter().map(|h| (h / mean).powi(4)).collect();
        let sample = sample(layout.points.len());
        let reaches = layout.nodes.par_iter().map(|X| lattice.at(X)).collect();
        let mut lattices = vec![lattice];
        while !lattice.coarser().is_affine() {
            lattice = lattice.coarser();
            lattices.push(lattice);
        }
        let level = |lattice| level(operator, layout, lattice, diagonal, &bending, &sample);
        let levels = lattices.into_par_iter().map(level).collect();
        Multilevel { reaches, levels }
    }

    /// B r.
    pub fn apply(&self, r: &[Vector3]) -> Vec<Vector3> {
        let mut moments = vec![self.to_finest(r)];
        for pair in self.levels.windows(2) {
            let fine = &moments[moments.len() - 1];
            let mut coarse = vec![Vector3::zeros(); pair[1].lattice.len()];
            pair[0].lattice.for_each_transfer(|I, i, w| {
                coarse[I] += w * fine[i];
            });
            moments.push(coarse);
        }
        for (level, values) in self.levels.iter().zip(&mut moments) {
            values.iter_mut().zip(&level.inverse_diagonal).for_each(|(v, d)| *v *= *d);
        }
        for l in (1..self.levels.len()).rev() {
            let (fine, coarse) = moments.split_at_mut(l);
            let (fine, coarse) = (&mut fine[l - 1], &coarse[0]);
            self.levels[l - 1].lattice.for_each_transfer(|I, i, w| {
                fine[i] += w * coarse[I];
            });
        }
        let finest = &moments[0];
        let at_node = |reach: &Reach| {
            let mut sum = Vector3::zeros();
            reach.for_each(|i, b| sum += b * finest[i]);
            sum
        };
        self.reaches.par_iter().map(at_node).collect()
    }

    /// Moments of a nodal field with the functions of the finest lattice.
    fn to_finest(&self, r: &[Vector3]) -> Vec<Vector3> {
        let lattice = &self.levels[0].lattice;
        let chunk = r.len().div_ceil(CHUNKS.0).max(CHUNKS.1);
        let moments = |(reaches, values): (&[Reach], &[Vector3])| {
            let mut moments = vec![Vector3::zeros(); lattice.len()];
            for (reach, value) in reaches.iter().zip(values) {
                reach.for_each(|i, b| moments[i] += b * value);
            }
            moments
        };
        let chunks = self.reaches.par_chunks(chunk).zip(r.par_chunks(chunk));
        let parts: Vec<Vec<Vector3>> = chunks.map(moments).collect();
        let mut sum = vec![Vector3::zeros(); lattice.len()];
        for part in parts {
            sum.iter_mut().zip(part).for_each(|(sum, moment)| *sum += moment);
        }
        sum
    }
}

fn inverse(diagonal: f64) -> f64 {
    if diagonal > 0.0 { 1.0 / diagonal } else { 0.0 }
}

/// Random points, the same each time: evenly strided ones would follow the grid.
fn sample(points: usize) -> Vec<usize> {
    let mut next = xorshift(0x2545_f491_4f6c_dd1d);
    (0..SAMPLES.min(4 * points)).map(|_| (next() % points as u64) as usize).collect()
}

/// The lattice with D_l = ρ_l Σ_a d_a bending_a over the nodes that a function
/// reaches, scaled so that the trace is that of P_lᵀ K P_l on the sample. The
/// values of the functions do not enter: near the boundary, where only their tails
/// reach, they bend as much as elsewhere.
fn level(
    operator: &Operator,
    layout: &Layout,
    lattice: Lattice,
    diagonal: &[SMatrix<f64, 1, 1>],
    bending: &[f64],
    sample: &[usize],
) -> Level {
    let mut lumped = vec![0.0; lattice.len()];
    for ((X, d), bend) in layout.nodes.iter().zip(diagonal).zip(bending) {
        lattice.at(X).for_each(|i, b| lumped[i] += if b != 0.0 { d.x * bend } else { 0.0 });
    }
    let measure = |q: &usize| energies(operator, layout, &lattice, bending, *q);
    let sum = |samples: &[usize]| samples.iter().map(measure).fold(NOTHING, add);
    let parts: Vec<Energies> = sample.par_chunks(SAMPLES_PER_TASK).map(sum).collect();
    let sums = parts.into_iter().fold(NOTHING, add);
    let factor = |i: usize| {
        let (energy, plain) = sums[lattice.kind(lattice.index(i))];
        if energy > 1e-14 * plain { plain / energy } else { 0.0 }
    };
    let inverse_diagonal =
        lumped.iter().enumerate().map(|(i, d)| factor(i) * inverse(*d)).collect();
    Level { lattice, inverse_diagonal }
}

/// Contributions of a point to the traces of P_lᵀ K P_l and of its estimate, by the
/// kinds of functions.
type Energies = [(f64, f64); 8];

const NOTHING: Energies = [(0.0, 0.0); 8];

fn add(mut sums: Energies, others: Energies) -> Energies {
    for (sum, other) in sums.iter_mut().zip(others) {
        *sum = (sum.0 + other.0, sum.1 + other.1);
    }
    sums
}

/// Sums over the support of a point for one function f: Σ W f², Σ W f p and the
/// lumped form of the first.
#[derive(Clone, Copy, Default)]
struct Sums {
    whole: f64,
    moments: Vector4<f64>,
    plain: f64,
}

fn energies(
    operator: &Operator,
    layout: &Layout,
    lattice: &Lattice,
    bending: &[f64],
    q: usize,
) -> Energies {
    let reaches: Vec<_> =
        operator.row(q).map(|entry| lattice.at(&layout.nodes[operator.node(entry)])).collect();
    let all = |axis: usize| reaches.iter().map(move |reach| reach.first[axis]);
    let low = [0, 1, 2].map(|axis| all(axis).min().unwrap_or(0));
    let high = [0, 1, 2].map(|axis| all(axis).max().unwrap_or(0));
    let size = [0, 1, 2].map(|axis| high[axis] - low[axis] + reaches[0].counts[axis]);
    let mut sums = vec![Sums::default(); size.iter().product()];
    for (entry, reach) in operator.row(q).zip(&reaches) {
        let p = operator.local(q, entry);
        let metric = operator.metric(entry);
        let term = operator.diagonal_term(q, entry) * bending[operator.node(entry)];
        reach.within(low, size).for_each(|place, b| {
            let sum = &mut sums[place];
            sum.whole += metric * b * b;
            sum.moments += p * (metric * b);
            sum.plain += if b != 0.0 { term } else { 0.0 };
        });
    }
    let mut energies = NOTHING;
    for (place, sum) in sums.iter().enumerate().filter(|(_, sum)| sum.plain > 0.0) {
        let at = [place % size[0], place / size[0] % size[1], place / (size[0] * size[1])];
        let (energy, plain) = &mut energies[lattice.kind([0, 1, 2].map(|k| low[k] + at[k]))];
        *energy += layout.weights[q] * (sum.whole - operator.square(q, &sum.moments)).max(0.0);
        *plain += sum.plain;
    }
    energies
}
