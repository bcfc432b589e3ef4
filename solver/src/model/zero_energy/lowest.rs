//! The motions that the quadrature sees least, by minimising the quotient.

use super::SoftMotion;
use super::pencil::Pencil;
use crate::algebra::packed::{self, axpy, dot};
use nalgebra::DMatrix;

/// Motions sought at once.
const SOUGHT: usize = 8;
const ROUNDS: usize = 40;

/// The least seen motions by preconditioned conjugate gradients in a block
/// (LOBPCG, Knyazev 2001). Smooth motions are no minima of the quotient, so
/// few rounds are enough to tell whether there are zero-energy modes. Ends as
/// soon as a share is below `enough`: the true smallest is no larger.
pub(super) fn softest(pencil: &Pencil, enough: f64) -> Vec<SoftMotion> {
    let mut block = Block { vectors: Vec::new(), seen: Vec::new(), whole: Vec::new() };
    for vector in noise(pencil.model.size()) {
        block.push(pencil, vector);
    }
    let (mut values, mut last) = block.ritz(SOUGHT, 0);
    let mut block = last.remove(0);
    let mut directions = Block { vectors: Vec::new(), seen: Vec::new(), whole: Vec::new() };
    let d = pencil.model.components;
    for _ in 0..ROUNDS {
        if values.first().is_none_or(|&least| least < enough) {
            break;
        }
        let mut space = block.clone();
        for (i, value) in values.iter().enumerate() {
            let mut residual: Vec<f64> =
                block.seen[i].iter().zip(&block.whole[i]).map(|(a, b)| a - value * b).collect();
            residual
                .iter_mut()
                .enumerate()
                .for_each(|(k, r)| *r /= pencil.model.lumped_mass[k / d]);
            space.push(pencil, residual);
        }
        space.append(directions);
        let (next, mut parts) = space.ritz(SOUGHT, block.vectors.len());
        values = next;
        directions = parts.remove(1);
        block = parts.remove(0);
    }
    let motion = |(share, vector): (&f64, &Vec<f64>)| {
        let size =
            |node: usize| -> f64 { vector[d * node..d * (node + 1)].iter().map(|x| x * x).sum() };
        let nodes = 0..pencil.model.positions.len();
        let node = nodes.max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(0);
        SoftMotion { share: *share, node, position: pencil.model.positions[node] }
    };
    values.iter().zip(&block.vectors).map(motion).collect()
}

/// Vectors with their images under both forms.
#[derive(Clone)]
struct Block {
    vectors: Vec<Vec<f64>>,
    seen: Vec<Vec<f64>>,
    whole: Vec<Vec<f64>>,
}

impl Block {
    /// Adds a vector, projected and scaled; none that the conditions forbid.
    fn push(&mut self, pencil: &Pencil, mut vector: Vec<f64>) {
        pencil.project(&mut vector);
        let whole = pencil.whole(&vector);
        let energy = dot(&vector, &whole);
        if energy > 0.0 {
            let scale = 1.0 / energy.sqrt();
            let seen = pencil.seen(&vector);
            self.vectors.push(scaled(vector, scale));
            self.seen.push(scaled(seen, scale));
            self.whole.push(scaled(whole, scale));
        }
    }

    fn append(&mut self, other: Block) {
        self.vectors.extend(other.vectors);
        self.seen.extend(other.seen);
        self.whole.extend(other.whole);
    }

    /// The smallest quotients in the span of the block, their motions, and
    /// the parts of these that do not come from the first `own` vectors.
    fn ritz(&self, count: usize, own: usize) -> (Vec<f64>, Vec<Block>) {
        let n = self.vectors.len();
        let form = |images: &[Vec<f64>]| {
            DMatrix::from_fn(n, n, |i, j| {
                0.5 * (dot(&self.vectors[i], &images[j]) + dot(&self.vectors[j], &images[i]))
            })
        };
        // Orthonormal in the whole energy, without what round-off leaves.
        let gram = form(&self.whole).symmetric_eigen();
        let largest = gram.eigenvalues.iter().copied().fold(0.0, f64::max);
        let kept: Vec<usize> = (0..n).filter(|&i| gram.eigenvalues[i] > 1e-12 * largest).collect();
        let basis = DMatrix::from_fn(n, kept.len(), |i, j| {
            gram.eigenvectors[(i, kept[j])] / gram.eigenvalues[kept[j]].sqrt()
        });
        let eigen = (basis.transpose() * form(&self.seen) * &basis).symmetric_eigen();
        let mut order: Vec<usize> = (0..kept.len()).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        order.truncate(count);
        let weights = basis * &eigen.eigenvectors;
        let values = order.iter().map(|&i| eigen.eigenvalues[i]).collect();
        let part = |from: usize| Block {
            vectors: order.iter().map(|&i| mix(&self.vectors, &weights, i, from)).collect(),
            seen: order.iter().map(|&i| mix(&self.seen, &weights, i, from)).collect(),
            whole: order.iter().map(|&i| mix(&self.whole, &weights, i, from)).collect(),
        };
        (values, vec![part(0), part(own)])
    }
}

fn mix(vectors: &[Vec<f64>], weights: &DMatrix<f64>, column: usize, from: usize) -> Vec<f64> {
    let mut sum = vec![0.0; vectors[0].len()];
    for (i, vector) in vectors.iter().enumerate().skip(from) {
        let weight = weights[(i, column)];
        axpy(&mut sum, weight, vector);
    }
    sum
}

fn scaled(mut vector: Vec<f64>, factor: f64) -> Vec<f64> {
    vector.iter_mut().for_each(|x| *x *= factor);
    vector
}

/// Starting vectors that depend on nothing but the number of unknowns.
fn noise(size: usize) -> Vec<Vec<f64>> {
    let mut next = packed::noise();
    (0..SOUGHT).map(|_| (0..size).map(|_| next()).collect()).collect()
}
