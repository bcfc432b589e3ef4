//! An additive multilevel preconditioner (Bramble, Pasciak, Xu 1990) on
//! nested lattices of quadratic B-splines.
//!
//! B r = D₀⁻¹ r + Σ_l P_l D_l⁻¹ P_lᵀ r: P_l takes coefficients on lattice l to
//! nodes, D_l estimates the diagonal of P_lᵀ K P_l. The number of iterations
//! does not grow with the number of nodes (method §3).
#![allow(non_snake_case)]

use super::operator::{Layout, Operator};
use crate::tensor::Vector3;

/// Spacing of the finest lattice over that of the nodes \[–\].
const FINEST: f64 = 1.5;
/// The coarsest lattice has no more functions than this.
const COARSEST: usize = 60;
/// Points from which the size of a level's diagonal is estimated.
const SAMPLES: usize = 1000;
/// More functions than this make the finest lattice coarser.
const MOST_FUNCTIONS: usize = 4_000_000;

/// The preconditioner, ready to be applied.
pub(super) struct Multilevel<'a> {
    nodes: &'a [Vector3],
    inverse_diagonal: Vec<f64>,
    /// From fine to coarse.
    levels: Vec<Level>,
}

struct Level {
    lattice: Lattice,
    inverse_diagonal: Vec<f64>,
}

/// Tensor-product quadratic B-splines: function i of an axis lives on the
/// cells i − 2 to i.
#[derive(Debug, Clone, Copy)]
struct Lattice {
    origin: Vector3,
    cell: f64,
    /// Functions along each axis; 1 along an axis without extent.
    counts: [usize; 3],
}

impl Lattice {
    fn new(nodes: &[Vector3], cell: f64, components: usize) -> Lattice {
        let (mut min, mut max) = (nodes[0], nodes[0]);
        nodes.iter().for_each(|X| (min, max) = (min.inf(X), max.sup(X)));
        let counts = [0, 1, 2].map(|k| match k < components {
            true => ((max[k] - min[k]) / cell) as usize + 3,
            false => 1,
        });
        Lattice { origin: min, cell, counts }
    }

    fn len(&self) -> usize {
        self.counts.iter().product()
    }

    fn coarser(&self) -> Lattice {
        let counts = self.counts.map(|n| if n > 1 { (n - 2).div_ceil(2) + 2 } else { 1 });
        Lattice { cell: 2.0 * self.cell, counts, ..*self }
    }

    /// Calls `visit(function, value)` for the functions that are not 0 at X.
    fn for_each(&self, X: &Vector3, mut visit: impl FnMut(usize, f64)) {
        let axes = [0, 1, 2].map(|k| spline(X[k] - self.origin[k], self.cell, self.counts[k]));
        let [(i, x), (j, y), (k, z)] = axes;
        for (c, wz) in z.iter().enumerate().take(self.counts[2].min(3)) {
            for (b, wy) in y.iter().enumerate().take(self.counts[1].min(3)) {
                let row = ((k + c) * self.counts[1] + j + b) * self.counts[0] + i;
                for (a, wx) in x.iter().enumerate() {
                    visit(row + a, wx * wy * wz);
                }
            }
        }
    }
}

/// First function and values of the three that are not 0 at `x`.
fn spline(x: f64, cell: f64, count: usize) -> (usize, [f64; 3]) {
    if count == 1 {
        return (0, [1.0, 0.0, 0.0]);
    }
    let index = ((x / cell).max(0.0) as usize).min(count - 3);
    let t = (x / cell - index as f64).clamp(0.0, 1.0);
    (index, [0.5 * (1.0 - t) * (1.0 - t), 0.5 + t * (1.0 - t), 0.5 * t * t])
}

/// Coarse function I is Σ (1, 3, 3, 1)/4 of the fine ones from 2I − 2.
const MASK: [f64; 4] = [0.25, 0.75, 0.75, 0.25];

/// Calls `visit(coarse, fine, factor)` for all pairs of two nested lattices.
fn for_each_transfer(coarse: &Lattice, fine: &Lattice, mut visit: impl FnMut(usize, usize, f64)) {
    let pairs = |axis: usize, index: usize| -> Vec<(usize, f64)> {
        if coarse.counts[axis] == 1 {
            return vec![(0, 1.0)];
        }
        let at = |m: usize| (2 * index + m).checked_sub(2).filter(|&i| i < fine.counts[axis]);
        (0..4).filter_map(|m| at(m).map(|i| (i, MASK[m]))).collect()
    };
    for K in 0..coarse.counts[2] {
        let layers = pairs(2, K);
        for J in 0..coarse.counts[1] {
            let rows = pairs(1, J);
            for I in 0..coarse.counts[0] {
                let target = (K * coarse.counts[1] + J) * coarse.counts[0] + I;
                for (i, wx) in pairs(0, I) {
                    for &(j, wy) in &rows {
                        for &(k, wz) in &layers {
                            let source = (k * fine.counts[1] + j) * fine.counts[0] + i;
                            visit(target, source, wx * wy * wz);
                        }
                    }
                }
            }
        }
    }
}

impl Multilevel<'_> {
    pub fn new<'a>(operator: &Operator, layout: &'a Layout<'a>) -> Multilevel<'a> {
        let diagonal = diagonal(operator, layout);
        let mean = layout.spacing.iter().sum::<f64>() / layout.spacing.len() as f64;
        let smallest = layout.spacing.iter().copied().fold(f64::INFINITY, f64::min);
        let mut lattice = Lattice::new(layout.nodes, FINEST * smallest, layout.components);
        let room = MOST_FUNCTIONS.min(8 * layout.nodes.len() + 64);
        while lattice.len() > room {
            lattice = Lattice::new(layout.nodes, 1.2 * lattice.cell, layout.components);
        }
        // Bending of a smooth function between neighbours grows as h⁴.
        let bending: Vec<f64> = layout.spacing.iter().map(|h| (h / mean).powi(4)).collect();
        let sample = sample(layout.points.len());
        let mut levels = Vec::new();
        loop {
            levels.push(level(operator, layout, lattice, &diagonal, &bending, &sample));
            if lattice.len() <= COARSEST {
                break;
            }
            lattice = lattice.coarser();
        }
        let inverse_diagonal = diagonal.iter().map(|d| inverse(*d)).collect();
        Multilevel { nodes: layout.nodes, inverse_diagonal, levels }
    }

    /// B r.
    pub fn apply(&self, r: &[Vector3]) -> Vec<Vector3> {
        let mut moments = vec![vec![Vector3::zeros(); self.levels[0].lattice.len()]];
        for (X, value) in self.nodes.iter().zip(r) {
            self.levels[0].lattice.for_each(X, |i, b| moments[0][i] += b * value);
        }
        for pair in self.levels.windows(2) {
            let fine = &moments[moments.len() - 1];
            let mut coarse = vec![Vector3::zeros(); pair[1].lattice.len()];
            for_each_transfer(&pair[1].lattice, &pair[0].lattice, |I, i, w| {
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
            for_each_transfer(&self.levels[l].lattice, &self.levels[l - 1].lattice, |I, i, w| {
                fine[i] += w * coarse[I];
            });
        }
        let mut out: Vec<Vector3> =
            r.iter().zip(&self.inverse_diagonal).map(|(r, d)| r * *d).collect();
        for (X, value) in self.nodes.iter().zip(&mut out) {
            self.levels[0].lattice.for_each(X, |i, b| *value += b * moments[0][i]);
        }
        out
    }
}

fn inverse(diagonal: f64) -> f64 {
    if diagonal > 0.0 { 1.0 / diagonal } else { 0.0 }
}

fn diagonal(operator: &Operator, layout: &Layout) -> Vec<f64> {
    let mut diagonal = vec![0.0; layout.nodes.len()];
    for (q, weight) in layout.weights.iter().enumerate() {
        for entry in operator.rows.row(q) {
            let node = operator.rows.nodes[entry] as usize;
            diagonal[node] += weight * operator.diagonal_share(q, entry);
        }
    }
    diagonal
}

/// Points at random, the same each time: evenly strided ones would follow
/// the grid.
fn sample(points: usize) -> Vec<usize> {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let draw = |_| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % points as u64) as usize
    };
    (0..SAMPLES.min(4 * points)).map(draw).collect()
}

/// The lattice with D_l = ρ_l Σ_a B² d_a bending_a: nodal diagonals lumped to
/// the lattice, scaled so that the trace is that of P_lᵀ K P_l on the sample.
fn level(
    operator: &Operator,
    layout: &Layout,
    lattice: Lattice,
    diagonal: &[f64],
    bending: &[f64],
    sample: &[usize],
) -> Level {
    let mut lumped = vec![0.0; lattice.len()];
    for ((X, d), bend) in layout.nodes.iter().zip(diagonal).zip(bending) {
        lattice.for_each(X, |i, b| lumped[i] += b * b * d * bend);
    }
    let (mut energy, mut plain) = (0.0, 0.0);
    for &q in sample {
        let weight = layout.weights[q];
        for (function, values) in functions_at(operator, layout, &lattice, q) {
            debug_assert!(function < lattice.len());
            energy += weight * operator.energy(q, &values);
            for (entry, b) in operator.rows.row(q).zip(&values) {
                let node = operator.rows.nodes[entry] as usize;
                plain += weight * operator.diagonal_share(q, entry) * b * b * bending[node];
            }
        }
    }
    let factor = if energy > 0.0 { plain / energy } else { 0.0 };
    let inverse_diagonal = lumped.iter().map(|d| factor * inverse(*d)).collect();
    Level { lattice, inverse_diagonal }
}

/// The functions that reach the support of a point, with their values at its
/// nodes.
fn functions_at(
    operator: &Operator,
    layout: &Layout,
    lattice: &Lattice,
    q: usize,
) -> Vec<(usize, Vec<f64>)> {
    let row = operator.rows.row(q);
    let count = row.len();
    let mut entries = Vec::new();
    for (a, entry) in row.enumerate() {
        let X = &layout.nodes[operator.rows.nodes[entry] as usize];
        lattice.for_each(X, |i, b| entries.push((i, a, b)));
    }
    entries.sort_unstable_by_key(|(i, a, _)| (*i, *a));
    let mut functions: Vec<(usize, Vec<f64>)> = Vec::new();
    for (i, a, b) in entries {
        if functions.last().is_none_or(|(last, _)| *last != i) {
            functions.push((i, vec![0.0; count]));
        }
        if let Some((_, values)) = functions.last_mut() {
            values[a] = b;
        }
    }
    functions
}
