//! An additive multilevel preconditioner (Bramble, Pasciak, Xu 1990) on
//! nested lattices of quadratic B-splines.
//!
//! B r = D₀⁻¹ r + Σ_l P_l D_l⁻¹ P_lᵀ r: P_l takes coefficients on lattice l to
//! nodes, D_l estimates the diagonal of P_lᵀ K P_l. The number of iterations
//! does not grow with the number of nodes (method §3).
#![allow(non_snake_case)]

use super::operator::{Layout, Operator};
use crate::tensor::{Vector3, box_around};

/// Spacing of the finest lattice over that of the nodes \[–\].
const FINEST: f64 = 1.5;
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

/// Functions along one axis of a lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Axis {
    /// No extent: one constant.
    Flat,
    /// 1 and s − ½ over the whole extent, s from 0 to 1.
    Affine,
    /// Quadratic B-splines on this many cells; function i lives on the cells
    /// i − 2 to i.
    Splines(usize),
}

/// Products of functions along the axes of the box around the nodes. An axis
/// that has become short against the cells is left with affine functions, so
/// that the long waves of slender bodies are seen.
#[derive(Debug, Clone, Copy)]
struct Lattice {
    origin: Vector3,
    extent: Vector3,
    axes: [Axis; 3],
    counts: [usize; 3],
}

impl Axis {
    /// Cells of about `edge`, as many as can be halved down to 1 or 3.
    fn new(extent: f64, edge: f64) -> Axis {
        let n = (extent / edge).ceil().max(1.0) as usize;
        let power = n.next_power_of_two();
        let fits = power >= 4 && n <= 3 * power / 4;
        Axis::Splines(if fits { 3 * power / 4 } else { power })
    }

    fn count(self) -> usize {
        match self {
            Axis::Flat => 1,
            Axis::Affine => 2,
            Axis::Splines(cells) => cells + 2,
        }
    }

    fn coarser(self) -> Axis {
        match self {
            Axis::Splines(cells) if cells.is_multiple_of(2) => Axis::Splines(cells / 2),
            Axis::Splines(_) => Axis::Affine,
            axis => axis,
        }
    }

    /// First of up to three functions at s in \[0, 1\], and their values.
    fn at(self, s: f64) -> (usize, [f64; 3]) {
        match self {
            Axis::Flat => (0, [1.0, 0.0, 0.0]),
            Axis::Affine => (0, [1.0, s - 0.5, 0.0]),
            Axis::Splines(cells) => {
                let x = s * cells as f64;
                let index = (x.max(0.0) as usize).min(cells - 1);
                let t = (x - index as f64).clamp(0.0, 1.0);
                (index, [0.5 * (1.0 - t) * (1.0 - t), 0.5 + t * (1.0 - t), 0.5 * t * t])
            }
        }
    }

    /// Function `index` of the coarser axis as a sum of functions of this one:
    /// (1, 3, 3, 1)/4 for halved splines, values at the middles of the
    /// splines for affine functions.
    fn parts(self, index: usize) -> Vec<(usize, f64)> {
        match (self, self.coarser()) {
            (Axis::Splines(cells), Axis::Splines(_)) => {
                let fine = |m: usize| (2 * index + m).checked_sub(2).filter(|&i| i < cells + 2);
                (0..4).filter_map(|m| fine(m).map(|i| (i, [0.25, 0.75, 0.75, 0.25][m]))).collect()
            }
            (Axis::Splines(cells), _) => (0..cells + 2)
                .map(|i| match index {
                    0 => (i, 1.0),
                    _ => (i, (i as f64 - 0.5) / cells as f64 - 0.5),
                })
                .collect(),
            _ => vec![(index, 1.0)],
        }
    }
}

impl Lattice {
    fn new(nodes: &[Vector3], edge: f64, components: usize) -> Lattice {
        let (min, max) = box_around(nodes);
        let extent = max - min;
        let axes =
            [0, 1, 2].map(|k| if k < components { Axis::new(extent[k], edge) } else { Axis::Flat });
        Lattice { origin: min, extent, axes, counts: axes.map(Axis::count) }
    }

    fn len(&self) -> usize {
        self.counts.iter().product()
    }

    fn coarser(&self) -> Lattice {
        let axes = self.axes.map(Axis::coarser);
        Lattice { axes, counts: axes.map(Axis::count), ..*self }
    }

    /// Whether only affine functions are left, which the operator ignores.
    fn is_affine(&self) -> bool {
        !self.axes.iter().any(|axis| matches!(axis, Axis::Splines(_)))
    }

    /// Calls `visit(function, value)` for the functions that may not be 0 at X.
    fn for_each(&self, X: &Vector3, mut visit: impl FnMut(usize, f64)) {
        let [(i, x), (j, y), (k, z)] = [0, 1, 2]
            .map(|axis| self.axes[axis].at((X[axis] - self.origin[axis]) / self.extent[axis]));
        for (c, wz) in z.iter().enumerate().take(self.counts[2].min(3)) {
            for (b, wy) in y.iter().enumerate().take(self.counts[1].min(3)) {
                let row = ((k + c) * self.counts[1] + j + b) * self.counts[0] + i;
                for (a, wx) in x.iter().enumerate().take(self.counts[0].min(3)) {
                    visit(row + a, wx * wy * wz);
                }
            }
        }
    }

    /// Along which axes a function is s − ½, as bits: functions of one kind
    /// bend alike.
    fn kind(&self, function: usize) -> usize {
        let [nx, ny, _] = self.counts;
        let index = [function % nx, function / nx % ny, function / (nx * ny)];
        (0..3).filter(|&k| self.axes[k] == Axis::Affine && index[k] == 1).map(|k| 1 << k).sum()
    }

    /// Calls `visit(coarse, fine, factor)` for all pairs with the next coarser
    /// lattice.
    fn for_each_transfer(&self, mut visit: impl FnMut(usize, usize, f64)) {
        let coarse = self.coarser();
        let parts = |axis: usize| -> Vec<Vec<(usize, f64)>> {
            (0..coarse.counts[axis]).map(|index| self.axes[axis].parts(index)).collect()
        };
        let [columns, rows, layers] = [parts(0), parts(1), parts(2)];
        let mut target = 0;
        for layer in &layers {
            for row in &rows {
                for column in &columns {
                    for &(k, wz) in layer {
                        for &(j, wy) in row {
                            let start = (k * self.counts[1] + j) * self.counts[0];
                            for &(i, wx) in column {
                                visit(target, start + i, wx * wy * wz);
                            }
                        }
                    }
                    target += 1;
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
        let mut edge = FINEST * smallest;
        let mut lattice = Lattice::new(layout.nodes, edge, layout.components);
        let room = MOST_FUNCTIONS.min(8 * layout.nodes.len() + 64);
        while lattice.len() > room {
            edge *= 1.2;
            lattice = Lattice::new(layout.nodes, edge, layout.components);
        }
        // Bending of a smooth function between neighbours grows as h⁴.
        let bending: Vec<f64> = layout.spacing.iter().map(|h| (h / mean).powi(4)).collect();
        let sample = sample(layout.points.len());
        let mut levels = Vec::new();
        loop {
            levels.push(level(operator, layout, lattice, &diagonal, &bending, &sample));
            lattice = lattice.coarser();
            if lattice.is_affine() {
                break;
            }
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

/// The lattice with D_l = ρ_l Σ_a d_a bending_a over the nodes that a function
/// reaches, scaled so that the trace is that of P_lᵀ K P_l on the sample. The
/// values of the functions do not enter: at the rim of the body, where only
/// their tails reach, they bend as much as elsewhere.
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
        lattice.for_each(X, |i, b| lumped[i] += if b != 0.0 { d * bend } else { 0.0 });
    }
    let mut sums = [(0.0, 0.0); 8];
    for &q in sample {
        let weight = layout.weights[q];
        for (function, values) in functions_at(operator, layout, &lattice, q) {
            let (energy, plain) = &mut sums[lattice.kind(function)];
            *energy += weight * operator.energy(q, &values);
            for (entry, b) in operator.rows.row(q).zip(&values) {
                let node = operator.rows.nodes[entry] as usize;
                if *b != 0.0 {
                    *plain += weight * operator.diagonal_share(q, entry) * bending[node];
                }
            }
        }
    }
    let factor = |i: usize| {
        let (energy, plain) = sums[lattice.kind(i)];
        if energy > 1e-14 * plain { plain / energy } else { 0.0 }
    };
    let inverse_diagonal =
        lumped.iter().enumerate().map(|(i, d)| factor(i) * inverse(*d)).collect();
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
