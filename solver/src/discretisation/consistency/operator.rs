//! The operator K of the multipliers: its points, parts and diagonal.
#![allow(non_snake_case)]

use crate::algebra::lanes::with_vectors;
use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::inverse;
use crate::discretisation::rows::Rows;
use fearless_simd::Level;
use nalgebra::{Matrix4, SMatrix, Vector4};
use rayon::prelude::*;
use std::ops::Range;

/// Added to |φ| in the metric so that every entry can change \[–\]; 0.001 makes
/// bonded cubes 0.3 % stiffer.
pub(super) const METRIC_FLOOR: f64 = 0.03;
/// Points per part; the last part may have fewer.
const PART: usize = 1024;

/// A node that is not in a part yet.
const NEW: u32 = u32::MAX;

/// Nodes and points of the gradients.
#[derive(Debug)]
pub struct Layout<'a> {
    /// Reference positions \[node\] \[m\].
    pub nodes: &'a [Vector3],
    /// Local spacing \[node\] \[m\].
    pub spacing: &'a [f64],
    /// Quadrature points \[point\] \[m\].
    pub points: &'a [Vector3],
    /// Quadrature weights \[point\] \[m³\].
    pub weights: &'a [f64],
    /// Displacement components per node: 2 or 3.
    pub components: usize,
}

/// The multipliers of a node, or the integrals that they belong to, by component of the
/// gradient: one row for condition 2, three for condition 3.
pub(super) type Nodal<const M: usize> = SMatrix<f64, M, 3>;

/// K λ in one pass over the points. Parts run on any number of threads into sums of
/// their own, which are added in the order of the parts.
pub(super) struct Operator<'a> {
    pub(super) starts: &'a [usize],
    pub(super) nodes: &'a [u32],
    pub(super) phi: &'a [f64],
    pub(super) layout: &'a Layout<'a>,
    pub(super) points: Vec<Point>,
    pub(super) parts: Vec<Part>,
}

/// The affine fit at one point.
pub(super) struct Point {
    /// Over the mean distance of the support \[1/m\].
    pub inverse_scale: f64,
    /// (Σ_a W p pᵀ)⁻¹ with p = (1, (X_a − x_q)/scale).
    pub gram_inverse: Matrix4<f64>,
}

/// Consecutive points with their own numbering of the nodes they touch.
pub(super) struct Part {
    pub points: Range<usize>,
    /// Global node of each local one.
    pub nodes: Vec<u32>,
    /// \[local node\] \[m\]
    pub positions: Vec<Vector3>,
    /// \[local node\] \[1/m\]
    pub inverse_spacing: Vec<f64>,
    /// Local node of each entry.
    pub local: Vec<u32>,
}

impl<'a> Operator<'a> {
    /// The operator of rows, and their gradients, which it does not read.
    pub fn new(rows: &'a mut Rows, layout: &'a Layout<'a>) -> (Operator<'a>, &'a mut [Vector3]) {
        let Rows { starts, nodes, phi, grad_phi } = rows;
        let (starts, nodes, phi) = (&starts[..], &nodes[..], &phi[..]);
        let mut operator =
            Operator { starts, nodes, phi, layout, points: Vec::new(), parts: Vec::new() };
        let count = layout.points.len();
        let level = Level::new();
        let point = |q: usize| with_vectors!(level, (_simd, _numbers) => operator.point(q));
        operator.points = (0..count).into_par_iter().map(point).collect();
        operator.parts = (0..count.div_ceil(PART))
            .into_par_iter()
            .map_init(
                || vec![NEW; layout.nodes.len()],
                |places, part| operator.part(part * PART..count.min((part + 1) * PART), places),
            )
            .collect();
        (operator, grad_phi)
    }

    /// Entries of point `q`.
    pub fn row(&self, q: usize) -> Range<usize> {
        self.starts[q]..self.starts[q + 1]
    }

    /// Node of an entry.
    pub fn node(&self, entry: usize) -> usize {
        self.nodes[entry] as usize
    }

    /// W of an entry \[–\].
    pub fn metric(&self, entry: usize) -> f64 {
        self.phi[entry].abs() + METRIC_FLOOR
    }

    #[inline(always)]
    fn point(&self, q: usize) -> Point {
        let X = &self.layout.points[q];
        let offset = |entry: usize| self.layout.nodes[self.node(entry)] - X;
        let distances: f64 = self.row(q).map(|entry| offset(entry).norm()).sum();
        let inverse_scale = self.row(q).len() as f64 / distances;
        let mut gram = Matrix4::zeros();
        for entry in self.row(q) {
            let p = local(&offset(entry), inverse_scale);
            gram.ger(self.metric(entry), &p, &p, 1.0);
        }
        if self.layout.components == 2 {
            gram[(3, 3)] = 1.0;
        }
        let gram_inverse = inverse(&gram).unwrap_or_else(Matrix4::zeros);
        Point { inverse_scale, gram_inverse }
    }

    /// Numbers nodes as they come; `places` are all new before and after.
    fn part(&self, points: Range<usize>, places: &mut [u32]) -> Part {
        let entries = &self.nodes[self.starts[points.start]..self.starts[points.end]];
        let mut nodes = Vec::new();
        let mut local = Vec::with_capacity(entries.len());
        for &node in entries {
            let place = &mut places[node as usize];
            if *place == NEW {
                *place = nodes.len() as u32;
                nodes.push(node);
            }
            local.push(*place);
        }
        nodes.iter().for_each(|&node| places[node as usize] = NEW);
        let positions = nodes.iter().map(|&node| self.layout.nodes[node as usize]).collect();
        let inverse_spacing =
            nodes.iter().map(|&node| 1.0 / self.layout.spacing[node as usize]).collect();
        Part { points, nodes, positions, inverse_spacing, local }
    }

    /// p of an entry of point `q`.
    #[inline(always)]
    pub fn local(&self, q: usize, entry: usize) -> Vector4<f64> {
        let offset = self.layout.nodes[self.node(entry)] - self.layout.points[q];
        local(&offset, self.points[q].inverse_scale)
    }

    /// pᵀ (Σ_a W p pᵀ)⁻¹ p at point `q`.
    #[inline(always)]
    pub fn square(&self, q: usize, p: &Vector4<f64>) -> f64 {
        p.dot(&(self.points[q].gram_inverse * p))
    }

    /// The blocks of the nodes on the diagonal of K.
    pub fn diagonal<const M: usize>(&self) -> Vec<SMatrix<f64, M, M>> {
        let level = Level::new();
        let of_part = |part: &Part| {
            let mut blocks = vec![SMatrix::<f64, M, M>::zeros(); part.nodes.len()];
            with_vectors!(level, (_simd, _numbers) => self.add_diagonal(part, &mut blocks));
            blocks
        };
        let parts: Vec<_> = self.parts.par_iter().map(of_part).collect();
        let mut diagonal = vec![SMatrix::zeros(); self.layout.nodes.len()];
        for (part, blocks) in self.parts.iter().zip(parts) {
            for (&node, block) in part.nodes.iter().zip(blocks) {
                diagonal[node as usize] += block;
            }
        }
        diagonal
    }

    #[inline(always)]
    fn add_diagonal<const M: usize>(&self, part: &Part, blocks: &mut [SMatrix<f64, M, M>]) {
        let first = self.starts[part.points.start];
        for q in part.points.clone() {
            for entry in self.row(q) {
                let node = part.local[entry - first] as usize;
                let offset = part.positions[node] - self.layout.points[q];
                let m = monomials::<M>(&offset, part.inverse_spacing[node]);
                let term = self.diagonal_term(q, entry);
                for i in 0..M {
                    for j in 0..M {
                        blocks[node][(i, j)] += term * m[i] * m[j];
                    }
                }
            }
        }
    }

    /// Contribution of entry (q, a) to the diagonal of K: w_q W (1 − W pᵀ G⁻¹ p).
    #[inline(always)]
    pub fn diagonal_term(&self, q: usize, entry: usize) -> f64 {
        let W = self.metric(entry);
        self.layout.weights[q] * (W * (1.0 - W * self.square(q, &self.local(q, entry))))
    }
}

#[inline(always)]
pub(super) fn local(offset: &Vector3, inverse_scale: f64) -> Vector4<f64> {
    let scaled = offset * inverse_scale;
    Vector4::new(1.0, scaled.x, scaled.y, scaled.z)
}

/// What multiplies the rows of a node at a point: 1 for one row, the components of
/// (x_q − X_a)/h_a for three, from the offset X_a − x_q.
#[inline(always)]
pub(super) fn monomials<const M: usize>(offset: &Vector3, inverse_spacing: f64) -> [f64; M] {
    std::array::from_fn(|m| if M == 1 { 1.0 } else { -offset[m] * inverse_spacing })
}
