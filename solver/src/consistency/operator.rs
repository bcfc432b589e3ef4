//! The operator K of the multipliers.
#![allow(non_snake_case)]

use crate::rows::Rows;
use crate::tensor::Vector3;
use nalgebra::{Matrix4, Matrix4x3, Vector4};
use rayon::prelude::*;

/// Added to |φ| in the metric so that no entry is out of reach \[–\]; 0.001 makes
/// bonded cubes 0.3 % stiffer.
const METRIC_FLOOR: f64 = 0.03;

/// Where and with what weight the gradients stand.
#[derive(Debug)]
pub struct Layout<'a> {
    /// \[node\] \[m\]
    pub nodes: &'a [Vector3],
    /// \[node\] \[m\]
    pub spacing: &'a [f64],
    /// \[point\] \[m\]
    pub points: &'a [Vector3],
    /// \[point\] \[m³\]
    pub weights: &'a [f64],
    pub components: usize,
}

/// K λ in two passes over the points, without storing fits per entry.
pub(super) struct Operator<'a> {
    pub rows: &'a Rows,
    layout: &'a Layout<'a>,
    /// W \[entry\] \[–\].
    pub metric: Vec<f64>,
    /// Mean distance of the support \[point\] \[m\].
    scale: Vec<f64>,
    /// (Σ_a W p pᵀ)⁻¹ with p = (1, (X_a − x_q)/scale) \[point\].
    gram_inverse: Vec<Matrix4<f64>>,
    /// Entries of node a in `by_node`: `starts[a]..starts[a + 1]`.
    starts: Vec<usize>,
    /// Point and w_q W of each entry.
    by_node: Vec<(u32, f64)>,
}

impl Operator<'_> {
    pub fn new<'a>(rows: &'a Rows, layout: &'a Layout<'a>) -> Operator<'a> {
        let metric: Vec<f64> = rows.phi.iter().map(|phi| phi.abs() + METRIC_FLOOR).collect();
        let mut operator = Operator {
            rows,
            layout,
            metric,
            scale: Vec::new(),
            gram_inverse: Vec::new(),
            starts: Vec::new(),
            by_node: Vec::new(),
        };
        operator.scale = (0..rows.len()).map(|q| operator.mean_distance(q)).collect();
        operator.gram_inverse =
            (0..rows.len()).into_par_iter().map(|q| operator.inverse_of_gram(q)).collect();
        operator.sort_by_node();
        operator
    }

    fn mean_distance(&self, q: usize) -> f64 {
        let row = self.rows.row(q);
        let count = row.len() as f64;
        let distances = row.map(|entry| {
            (self.layout.nodes[self.rows.nodes[entry] as usize] - self.layout.points[q]).norm()
        });
        distances.sum::<f64>() / count
    }

    /// p = (1, (X_a − x_q)/scale).
    fn local(&self, q: usize, node: usize) -> Vector4<f64> {
        let offset = (self.layout.nodes[node] - self.layout.points[q]) / self.scale[q];
        Vector4::new(1.0, offset.x, offset.y, offset.z)
    }

    fn inverse_of_gram(&self, q: usize) -> Matrix4<f64> {
        let mut gram = Matrix4::zeros();
        for entry in self.rows.row(q) {
            let p = self.local(q, self.rows.nodes[entry] as usize);
            gram += self.metric[entry] * p * p.transpose();
        }
        if self.layout.components == 2 {
            gram[(3, 3)] = 1.0;
        }
        gram.cholesky().map(|factor| factor.inverse()).unwrap_or_else(Matrix4::zeros)
    }

    fn sort_by_node(&mut self) {
        let rows = self.rows;
        let mut starts = vec![0usize; self.layout.nodes.len() + 1];
        rows.nodes.iter().for_each(|&node| starts[node as usize + 1] += 1);
        for node in 1..starts.len() {
            starts[node] += starts[node - 1];
        }
        let mut next = starts.clone();
        self.by_node = vec![(0, 0.0); rows.nodes.len()];
        for (q, weight) in self.layout.weights.iter().enumerate() {
            for entry in rows.row(q) {
                let slot = &mut next[rows.nodes[entry] as usize];
                self.by_node[*slot] = (q as u32, weight * self.metric[entry]);
                *slot += 1;
            }
        }
        self.starts = starts;
    }

    /// Coefficients of the affine fit of λ at every point.
    fn fits(&self, multipliers: &[Vector3]) -> Vec<Matrix4x3<f64>> {
        let fit = |q: usize| {
            let mut moments = Matrix4x3::zeros();
            for entry in self.rows.row(q) {
                let node = self.rows.nodes[entry] as usize;
                let p = self.metric[entry] * self.local(q, node);
                moments += p * multipliers[node].transpose();
            }
            self.gram_inverse[q] * moments
        };
        (0..self.rows.len()).into_par_iter().map(fit).collect()
    }

    /// K λ.
    pub fn apply(&self, multipliers: &[Vector3]) -> Vec<Vector3> {
        let fits = self.fits(multipliers);
        let gather = |node: usize| {
            let mut sum = Vector3::zeros();
            for &(q, weight) in &self.by_node[self.starts[node]..self.starts[node + 1]] {
                let q = q as usize;
                sum += weight * (multipliers[node] - fits[q].tr_mul(&self.local(q, node)));
            }
            sum
        };
        (0..multipliers.len()).into_par_iter().map(gather).collect()
    }

    /// dg = W (λ_a − fit), per entry.
    pub fn changes(&self, multipliers: &[Vector3]) -> Vec<Vector3> {
        let fits = self.fits(multipliers);
        let mut changes = Vec::with_capacity(self.rows.nodes.len());
        for (q, fit) in fits.iter().enumerate() {
            for entry in self.rows.row(q) {
                let node = self.rows.nodes[entry] as usize;
                let rest = multipliers[node] - fit.tr_mul(&self.local(q, node));
                changes.push(self.metric[entry] * rest);
            }
        }
        changes
    }

    /// What entry (q, a) adds to the diagonal of K, over w_q:
    /// W (1 − W pᵀ G⁻¹ p).
    pub fn diagonal_share(&self, q: usize, entry: usize) -> f64 {
        let p = self.local(q, self.rows.nodes[entry] as usize);
        let W = self.metric[entry];
        W * (1.0 - W * p.dot(&(self.gram_inverse[q] * p)))
    }

    /// Σ_a W f_a² less its affine part at point q, for nodal values `f` of
    /// the entries of its row.
    pub fn energy(&self, q: usize, f: &[f64]) -> f64 {
        let (mut moments, mut whole) = (Vector4::zeros(), 0.0);
        for (entry, value) in self.rows.row(q).zip(f) {
            let weighted = self.metric[entry] * value;
            moments += weighted * self.local(q, self.rows.nodes[entry] as usize);
            whole += weighted * value;
        }
        (whole - moments.dot(&(self.gram_inverse[q] * moments))).max(0.0)
    }
}
