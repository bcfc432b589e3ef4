//! The operator K of the multipliers.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::inverse;
use crate::discretisation::rows::Rows;
use nalgebra::{Matrix4, Vector4};
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
    /// Local node of each entry.
    local: Vec<u32>,
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
        Part { points, nodes, positions, local }
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
    pub fn apply(&self, multipliers: &[Vector3]) -> Vec<Vector3> {
        let image = |part: &Part| {
            let values = part.gather(multipliers);
            let mut sums = vec![Quad::default(); part.nodes.len()];
            self.for_each_rest(part, &values, |q, _, node, metric, rest| {
                let weight = self.layout.weights[q] * metric;
                (0..4).for_each(|c| sums[node][c] += weight * rest[c]);
            });
            sums
        };
        let images: Vec<Vec<Quad>> = self.parts.par_iter().map(image).collect();
        let mut sum = vec![Vector3::zeros(); multipliers.len()];
        for (part, image) in self.parts.iter().zip(images) {
            for (&node, [x, y, z, _]) in part.nodes.iter().zip(image) {
                sum[node as usize] += Vector3::new(x, y, z);
            }
        }
        sum
    }

    /// Adds dg = W (λ_a − fit) to the gradients of the entries.
    pub fn change(&self, multipliers: &[Vector3], mut gradients: &mut [Vector3]) {
        let mut pieces = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            let (piece, others) = gradients.split_at_mut(part.local.len());
            pieces.push(piece);
            gradients = others;
        }
        self.parts.par_iter().zip(pieces).for_each(|(part, piece)| {
            let values = part.gather(multipliers);
            self.for_each_rest(part, &values, |_, entry, _, metric, [x, y, z, _]| {
                piece[entry] += metric * Vector3::new(x, y, z);
            });
        });
    }

    /// Calls `visit(point, entry of the part, local node, W, λ_a − fit)` for all
    /// entries of a part.
    #[inline(always)]
    fn for_each_rest(
        &self,
        part: &Part,
        values: &[Quad],
        mut visit: impl FnMut(usize, usize, usize, f64, Quad),
    ) {
        let first = self.starts[part.points.start];
        for q in part.points.clone() {
            let row = self.row(q);
            let (X, point) = (&self.layout.points[q], &self.points[q]);
            let (phi, nodes) =
                (&self.phi[row.clone()], &part.local[row.start - first..row.end - first]);
            let mut moments = Affine::default();
            for (phi, &node) in phi.iter().zip(nodes) {
                let metric = phi.abs() + METRIC_FLOOR;
                let p = local(&(part.positions[node as usize] - X), point.inverse_scale) * metric;
                let value = &values[node as usize];
                (0..4).for_each(|k| (0..4).for_each(|c| moments[k][c] += p[k] * value[c]));
            }
            let fit = product(&point.gram_inverse, &moments);
            for (entry, (phi, &node)) in (row.start - first..).zip(phi.iter().zip(nodes)) {
                let p = local(&(part.positions[node as usize] - X), point.inverse_scale);
                let mut rest = values[node as usize];
                (0..4).for_each(|k| (0..4).for_each(|c| rest[c] -= p[k] * fit[k][c]));
                visit(q, entry, node as usize, phi.abs() + METRIC_FLOOR, rest);
            }
        }
    }

    /// The diagonal of K.
    pub fn diagonal(&self) -> Vec<f64> {
        let terms = |part: &Part| -> Vec<f64> {
            let point = |q: usize| self.row(q).map(move |entry| self.diagonal_term(q, entry));
            part.points.clone().flat_map(point).collect()
        };
        let terms: Vec<Vec<f64>> = self.parts.par_iter().map(terms).collect();
        let mut diagonal = vec![0.0; self.layout.nodes.len()];
        for (&node, term) in self.nodes.iter().zip(terms.iter().flatten()) {
            diagonal[node as usize] += term;
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
    fn gather(&self, field: &[Vector3]) -> Vec<Quad> {
        let quad = |&node: &u32| {
            let value = &field[node as usize];
            [value.x, value.y, value.z, 0.0]
        };
        self.nodes.iter().map(quad).collect()
    }
}

#[inline(always)]
fn local(offset: &Vector3, inverse_scale: f64) -> Vector4<f64> {
    let scaled = offset * inverse_scale;
    Vector4::new(1.0, scaled.x, scaled.y, scaled.z)
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
