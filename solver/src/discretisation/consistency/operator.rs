//! The operator K of the multipliers.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::inverse;
use crate::discretisation::rows::Rows;
use nalgebra::{Matrix4, SMatrix, Vector4};
use rayon::prelude::*;
use std::ops::Range;

/// Added to |φ| in the metric so that every entry can change \[–\]; 0.001 makes
/// bonded cubes 0.3 % stiffer.
const METRIC_FLOOR: f64 = 0.03;
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
    starts: &'a [usize],
    nodes: &'a [u32],
    phi: &'a [f64],
    layout: &'a Layout<'a>,
    points: Vec<Point>,
    parts: Vec<Part>,
}

/// The affine fit at one point.
struct Point {
    /// Over the mean distance of the support \[1/m\].
    inverse_scale: f64,
    /// (Σ_a W p pᵀ)⁻¹ with p = (1, (X_a − x_q)/scale).
    gram_inverse: Matrix4<f64>,
}

/// Consecutive points with their own numbering of the nodes they touch.
struct Part {
    points: Range<usize>,
    /// Global node of each local one.
    nodes: Vec<u32>,
    /// \[local node\] \[m\]
    positions: Vec<Vector3>,
    /// \[local node\] \[1/m\]
    inverse_spacing: Vec<f64>,
    /// Local node of each entry.
    local: Vec<u32>,
}

/// An entry of a point's row, as a visitor sees it.
struct Entry<const M: usize> {
    point: usize,
    /// Of all entries.
    index: usize,
    /// In the part.
    node: usize,
    /// W \[–\].
    metric: f64,
    /// See [`monomials`].
    monomials: [f64; M],
}

/// Three components and a fourth that is not used.
type Quad = [f64; 4];

/// p_k c for the four entries of p and the components.
type Affine = [Quad; 4];

impl<'a> Operator<'a> {
    /// The operator of rows, and their gradients, which it does not read.
    pub fn new(rows: &'a mut Rows, layout: &'a Layout<'a>) -> (Operator<'a>, &'a mut [Vector3]) {
        let Rows { starts, nodes, phi, grad_phi } = rows;
        let (starts, nodes, phi) = (&starts[..], &nodes[..], &phi[..]);
        let mut operator =
            Operator { starts, nodes, phi, layout, points: Vec::new(), parts: Vec::new() };
        let count = layout.points.len();
        operator.points = (0..count).into_par_iter().map(|q| operator.point(q)).collect();
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
    #[inline]
    pub fn local(&self, q: usize, entry: usize) -> Vector4<f64> {
        let offset = self.layout.nodes[self.node(entry)] - self.layout.points[q];
        local(&offset, self.points[q].inverse_scale)
    }

    /// pᵀ (Σ_a W p pᵀ)⁻¹ p at point `q`.
    #[inline]
    pub fn square(&self, q: usize, p: &Vector4<f64>) -> f64 {
        p.dot(&(self.points[q].gram_inverse * p))
    }

    /// K λ.
    pub fn apply<const M: usize>(&self, multipliers: &[Nodal<M>]) -> Vec<Nodal<M>> {
        self.sums(|part, sums| {
            let values = part.gather(multipliers);
            self.for_each_rest(part, &values, |entry: Entry<M>, rest| {
                let weight = self.layout.weights[entry.point] * entry.metric;
                let sum = &mut sums[entry.node];
                for (m, monomial) in entry.monomials.iter().enumerate() {
                    (0..4).for_each(|c| sum[m][c] += weight * monomial * rest[c]);
                }
            });
        })
    }

    /// Σ_q w Grad φ_a of each node \[m²\], or
    /// Σ_q w ((x_q − X_a) ⊗ Grad φ_a + φ_a I)/h_a.
    pub fn integrals<const M: usize>(&self, gradients: &[Vector3]) -> Vec<Nodal<M>> {
        self.sums(|part, sums| {
            let first = self.starts[part.points.start];
            for q in part.points.clone() {
                let (X, weight) = (&self.layout.points[q], self.layout.weights[q]);
                for entry in self.row(q) {
                    let node = part.local[entry - first] as usize;
                    let inverse_spacing = part.inverse_spacing[node];
                    let offset = part.positions[node] - X;
                    let monomials = monomials::<M>(&offset, inverse_spacing);
                    let gradient = weight * gradients[entry];
                    let sum: &mut [Quad; M] = &mut sums[node];
                    for (m, monomial) in monomials.iter().enumerate() {
                        (0..3).for_each(|c| sum[m][c] += monomial * gradient[c]);
                    }
                    if M == 3 {
                        let value = weight * self.phi[entry] * inverse_spacing;
                        (0..self.layout.components).for_each(|m| sum[m][m] += value);
                    }
                }
            }
        })
    }

    /// Adds dg = W (λ_a − fit) to the gradients of the entries.
    pub fn change<const M: usize>(&self, multipliers: &[Nodal<M>], mut gradients: &mut [Vector3]) {
        let mut pieces = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            let (piece, others) = gradients.split_at_mut(part.local.len());
            pieces.push(piece);
            gradients = others;
        }
        self.parts.par_iter().zip(pieces).for_each(|(part, piece)| {
            let first = self.starts[part.points.start];
            let values = part.gather(multipliers);
            self.for_each_rest(part, &values, |entry: Entry<M>, [x, y, z, _]| {
                piece[entry.index - first] += entry.metric * Vector3::new(x, y, z);
            });
        });
    }

    /// Sums at the nodes of what `add` collects from each part.
    fn sums<const M: usize>(&self, add: impl Fn(&Part, &mut [[Quad; M]]) + Sync) -> Vec<Nodal<M>> {
        let of_part = |part: &Part| {
            let mut sums = vec![[Quad::default(); M]; part.nodes.len()];
            add(part, &mut sums);
            sums
        };
        let parts: Vec<Vec<[Quad; M]>> = self.parts.par_iter().map(of_part).collect();
        let mut all = vec![Nodal::<M>::zeros(); self.layout.nodes.len()];
        for (part, sums) in self.parts.iter().zip(parts) {
            for (&node, sum) in part.nodes.iter().zip(sums) {
                all[node as usize] += Nodal::<M>::from_fn(|m, c| sum[m][c]);
            }
        }
        all
    }

    /// Calls `visit(entry, λ_a − fit)` for all entries of a part, λ_a as seen from the point.
    #[inline(always)]
    fn for_each_rest<const M: usize>(
        &self,
        part: &Part,
        values: &[[Quad; M]],
        mut visit: impl FnMut(Entry<M>, Quad),
    ) {
        let first = self.starts[part.points.start];
        let mut seen = Vec::new();
        for q in part.points.clone() {
            let row = self.row(q);
            let (X, point) = (&self.layout.points[q], &self.points[q]);
            let (phi, nodes) =
                (&self.phi[row.clone()], &part.local[row.start - first..row.end - first]);
            let mut moments = Affine::default();
            seen.clear();
            for (phi, &node) in phi.iter().zip(nodes) {
                let node = node as usize;
                let offset = part.positions[node] - X;
                let monomials = monomials::<M>(&offset, part.inverse_spacing[node]);
                let mut value = Quad::default();
                for (monomial, own) in monomials.iter().zip(&values[node]) {
                    (0..4).for_each(|c| value[c] += monomial * own[c]);
                }
                let metric = phi.abs() + METRIC_FLOOR;
                let p = local(&offset, point.inverse_scale);
                let weighted = p * metric;
                (0..4).for_each(|k| (0..4).for_each(|c| moments[k][c] += weighted[k] * value[c]));
                seen.push((monomials, p, value));
            }
            let fit = product(&point.gram_inverse, &moments);
            for (index, ((monomials, p, value), (phi, &node))) in
                row.zip(seen.iter().zip(phi.iter().zip(nodes)))
            {
                let mut rest = *value;
                (0..4).for_each(|k| (0..4).for_each(|c| rest[c] -= p[k] * fit[k][c]));
                let metric = phi.abs() + METRIC_FLOOR;
                let node = node as usize;
                visit(Entry { point: q, index, node, metric, monomials: *monomials }, rest);
            }
        }
    }

    /// The blocks of the nodes on the diagonal of K.
    pub fn diagonal<const M: usize>(&self) -> Vec<SMatrix<f64, M, M>> {
        let of_part = |part: &Part| {
            let mut blocks = vec![SMatrix::<f64, M, M>::zeros(); part.nodes.len()];
            let first = self.starts[part.points.start];
            for q in part.points.clone() {
                for entry in self.row(q) {
                    let node = part.local[entry - first] as usize;
                    let offset = part.positions[node] - self.layout.points[q];
                    let m = SMatrix::<f64, M, 1>::from(monomials::<M>(
                        &offset,
                        part.inverse_spacing[node],
                    ));
                    blocks[node].ger(self.diagonal_term(q, entry), &m, &m, 1.0);
                }
            }
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

    /// Contribution of entry (q, a) to the diagonal of K: w_q W (1 − W pᵀ G⁻¹ p).
    pub fn diagonal_term(&self, q: usize, entry: usize) -> f64 {
        let W = self.metric(entry);
        self.layout.weights[q] * (W * (1.0 - W * self.square(q, &self.local(q, entry))))
    }
}

impl Part {
    fn gather<const M: usize>(&self, field: &[Nodal<M>]) -> Vec<[Quad; M]> {
        let quads = |&node: &u32| {
            let value = &field[node as usize];
            std::array::from_fn(|m| [value[(m, 0)], value[(m, 1)], value[(m, 2)], 0.0])
        };
        self.nodes.iter().map(quads).collect()
    }
}

#[inline(always)]
fn local(offset: &Vector3, inverse_scale: f64) -> Vector4<f64> {
    let scaled = offset * inverse_scale;
    Vector4::new(1.0, scaled.x, scaled.y, scaled.z)
}

/// What multiplies the rows of a node at a point: 1 for one row, the components of
/// (x_q − X_a)/h_a for three, from the offset X_a − x_q.
#[inline(always)]
fn monomials<const M: usize>(offset: &Vector3, inverse_spacing: f64) -> [f64; M] {
    std::array::from_fn(|m| if M == 1 { 1.0 } else { -offset[m] * inverse_spacing })
}

#[inline(always)]
fn product(matrix: &Matrix4<f64>, moments: &Affine) -> Affine {
    let mut product = Affine::default();
    for k in 0..4 {
        for l in 0..4 {
            (0..4).for_each(|c| product[k][c] += matrix[(k, l)] * moments[l][c]);
        }
    }
    product
}
