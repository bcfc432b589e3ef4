//! The motions of which the quadrature captures least, by minimising the quotient.

use super::pencil::Pencil;
use crate::algebra::packed::{axpy, dot};
use crate::algebra::random::noise;
use crate::algebra::tensor::Vector3;
use nalgebra::DMatrix;

/// A motion of whose strain energy the quadrature captures a fraction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapturedMotion {
    /// Captured part of its strain energy by the finer rule \[–\].
    pub fraction: f64,
    /// The node that moves most.
    pub node: usize,
    /// Its reference position \[m\].
    pub position: Vector3,
}

/// Squared length of a direction that is not round-off over the longest one \[–\]: images are
/// mixed in every iteration, and what is shorter grows until quotients are negative.
const SHORTEST: f64 = 1e-9;

/// Size of the block.
const MOTIONS: usize = 8;
/// Largest number of iterations.
const ITERATIONS: usize = 40;

/// The least captured motions, ascending, by preconditioned conjugate gradients in a
/// block (LOBPCG, Knyazev 2001). Smooth motions are no minima of the quotient, so
/// few iterations show whether there are zero-energy modes. Ends as soon as a
/// fraction is below `enough`: the true smallest is no larger.
pub(super) fn least_captured(pencil: &Pencil, enough: f64) -> Vec<CapturedMotion> {
    let mut block = Subspace::default();
    let mut random = noise();
    for _ in 0..MOTIONS {
        block.push(pencil, (0..pencil.model.size()).map(|_| random()).collect());
    }
    let (mut values, mut parts) = block.ritz(MOTIONS, 0);
    let mut block = parts.remove(0);
    let mut directions = Subspace::default();
    let d = pencil.model.components;
    for _ in 0..ITERATIONS {
        let is_enough = |values: &[f64]| values.first().is_none_or(|&least| least < enough);
        if is_enough(&values) {
            // Not by the round-off of images that were mixed: with new ones.
            let mut fresh = Subspace::default();
            block.vectors.into_iter().for_each(|vector| fresh.push(pencil, vector));
            (values, parts) = fresh.ritz(MOTIONS, 0);
            block = parts.remove(0);
            directions = Subspace::default();
            if is_enough(&values) {
                break;
            }
        }
        let mut space = block.clone();
        for (i, value) in values.iter().enumerate() {
            let mut residual: Vec<f64> =
                block.model[i].iter().zip(&block.finer[i]).map(|(a, b)| a - value * b).collect();
            residual
                .iter_mut()
                .enumerate()
                .for_each(|(k, r)| *r /= pencil.model.lumped_mass[k / d]);
            space.push(pencil, residual);
        }
        space.append(directions);
        let (next, mut parts) = space.ritz(MOTIONS, block.vectors.len());
        values = next;
        directions = parts.remove(1);
        block = parts.remove(0);
    }
    let motions = values.iter().zip(&block.vectors);
    motions.map(|(&fraction, vector)| captured_motion(pencil, fraction, vector)).collect()
}

fn captured_motion(pencil: &Pencil, fraction: f64, vector: &[f64]) -> CapturedMotion {
    let (positions, d) = (&pencil.model.positions, pencil.model.components);
    let size =
        |node: usize| -> f64 { vector[d * node..d * (node + 1)].iter().map(|x| x * x).sum() };
    let node = (0..positions.len()).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(0);
    CapturedMotion { fraction, node, position: positions[node] }
}

/// Vectors that span a space, with their products with both matrices of the pencil.
#[derive(Clone, Default)]
struct Subspace {
    vectors: Vec<Vec<f64>>,
    /// (K + δM)v.
    model: Vec<Vec<f64>>,
    /// (K̂ + δM)v.
    finer: Vec<Vec<f64>>,
}

impl Subspace {
    /// Adds a vector, projected and scaled, unless its projection is 0.
    fn push(&mut self, pencil: &Pencil, mut vector: Vec<f64>) {
        pencil.project(&mut vector);
        let finer = pencil.finer_product(&vector);
        let energy = dot(&vector, &finer);
        if energy > 0.0 {
            let scale = 1.0 / energy.sqrt();
            let model = pencil.model_product(&vector);
            self.vectors.push(scaled(vector, scale));
            self.model.push(scaled(model, scale));
            self.finer.push(scaled(finer, scale));
        }
    }

    fn append(&mut self, other: Subspace) {
        self.vectors.extend(other.vectors);
        self.model.extend(other.model);
        self.finer.extend(other.finer);
    }

    /// Rayleigh–Ritz: the `count` smallest quotients in the span of the block, their
    /// vectors, and the parts of these that do not come from the first `own` ones.
    fn ritz(&self, count: usize, own: usize) -> (Vec<f64>, Vec<Subspace>) {
        let n = self.vectors.len();
        let form = |images: &[Vec<f64>]| {
            DMatrix::from_fn(n, n, |i, j| {
                0.5 * (dot(&self.vectors[i], &images[j]) + dot(&self.vectors[j], &images[i]))
            })
        };
        // Orthonormal in the finer form, without directions of round-off.
        let gram = form(&self.finer).symmetric_eigen();
        let largest = gram.eigenvalues.iter().copied().fold(0.0, f64::max);
        let retained: Vec<usize> =
            (0..n).filter(|&i| gram.eigenvalues[i] > SHORTEST * largest).collect();
        let basis = DMatrix::from_fn(n, retained.len(), |i, j| {
            gram.eigenvectors[(i, retained[j])] / gram.eigenvalues[retained[j]].sqrt()
        });
        let eigen = (basis.transpose() * form(&self.model) * &basis).symmetric_eigen();
        let mut order: Vec<usize> = (0..retained.len()).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        order.truncate(count);
        let weights = basis * &eigen.eigenvectors;
        let values = order.iter().map(|&i| eigen.eigenvalues[i]).collect();
        let part = |from: usize| Subspace {
            vectors: order.iter().map(|&i| mix(&self.vectors, &weights, i, from)).collect(),
            model: order.iter().map(|&i| mix(&self.model, &weights, i, from)).collect(),
            finer: order.iter().map(|&i| mix(&self.finer, &weights, i, from)).collect(),
        };
        (values, vec![part(0), part(own)])
    }
}

/// Σ_i weights_i,column vectors_i over i ≥ `from`.
fn mix(vectors: &[Vec<f64>], weights: &DMatrix<f64>, column: usize, from: usize) -> Vec<f64> {
    let mut sum = vec![0.0; vectors[0].len()];
    for (i, vector) in vectors.iter().enumerate().skip(from) {
        axpy(&mut sum, weights[(i, column)], vector);
    }
    sum
}

fn scaled(mut vector: Vec<f64>, factor: f64) -> Vec<f64> {
    vector.iter_mut().for_each(|x| *x *= factor);
    vector
}
