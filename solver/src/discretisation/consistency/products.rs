//! Products with the operator K of the multipliers.
#![allow(non_snake_case)]

use crate::algebra::lanes::with_vectors;
use crate::algebra::tensor::Vector3;
use crate::discretisation::consistency::operator::{
    METRIC_FLOOR, Nodal, Operator, Part, local, monomials,
};
use fearless_simd::{Level, Simd, f64x4, prelude::*};
use nalgebra::Matrix4;
use rayon::prelude::*;

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

/// What the first pass over the entries of a point leaves for the second.
#[derive(Clone, Copy)]
struct Seen<const M: usize> {
    metric: f64,
    monomials: [f64; M],
    /// p = (1, (X_a − x_q)/scale).
    affine: Quad,
    /// λ_a as seen from the point.
    value: Quad,
}

impl Operator<'_> {
    /// K λ.
    pub fn apply<const M: usize>(&self, multipliers: &[Nodal<M>]) -> Vec<Nodal<M>> {
        let level = Level::new();
        self.sums(|part, sums| {
            let values = part.gather(multipliers);
            with_vectors!(level, (simd, _numbers) => self.add_rests(simd, part, &values, sums));
        })
    }

    #[inline(always)]
    fn add_rests<S: Simd, const M: usize>(
        &self,
        simd: S,
        part: &Part,
        values: &[[Quad; M]],
        sums: &mut [[Quad; M]],
    ) {
        self.for_each_rest(
            simd,
            part,
            values,
            #[inline(always)]
            |entry: Entry<M>, rest: f64x4<S>| {
                let weighted = rest * (self.layout.weights[entry.point] * entry.metric);
                let sum = &mut sums[entry.node];
                for (sum, monomial) in sum.iter_mut().zip(entry.monomials) {
                    let before: f64x4<S> = (*sum).simd_into(simd);
                    *sum = weighted.mul_add(f64x4::splat(simd, monomial), before).into();
                }
            },
        );
    }

    /// Σ_q w Grad φ_a of each node \[m²\], or
    /// Σ_q w ((x_q − X_a) ⊗ Grad φ_a + φ_a I)/h_a.
    pub fn integrals<const M: usize>(&self, gradients: &[Vector3]) -> Vec<Nodal<M>> {
        let level = Level::new();
        self.sums(|part, sums| {
            with_vectors!(level, (simd, _numbers) => {
                self.add_integrals(simd, part, gradients, sums)
            });
        })
    }

    #[inline(always)]
    fn add_integrals<S: Simd, const M: usize>(
        &self,
        simd: S,
        part: &Part,
        gradients: &[Vector3],
        sums: &mut [[Quad; M]],
    ) {
        let first = self.starts[part.points.start];
        for q in part.points.clone() {
            let (X, weight) = (&self.layout.points[q], self.layout.weights[q]);
            for entry in self.row(q) {
                let node = part.local[entry - first] as usize;
                let inverse_spacing = part.inverse_spacing[node];
                let offset = part.positions[node] - X;
                let monomials = monomials::<M>(&offset, inverse_spacing);
                let [x, y, z]: [f64; 3] = gradients[entry].into();
                let gradient: f64x4<S> = [x, y, z, 0.0].simd_into(simd);
                let gradient = gradient * weight;
                let sum: &mut [Quad; M] = &mut sums[node];
                for (sum, monomial) in sum.iter_mut().zip(monomials) {
                    let before: f64x4<S> = (*sum).simd_into(simd);
                    *sum = gradient.mul_add(f64x4::splat(simd, monomial), before).into();
                }
                if M == 3 {
                    let value = weight * self.phi[entry] * inverse_spacing;
                    (0..self.layout.components).for_each(|m| sum[m][m] += value);
                }
            }
        }
    }

    /// Adds dg = W (λ_a − fit) to the gradients of the entries.
    pub fn change<const M: usize>(&self, multipliers: &[Nodal<M>], mut gradients: &mut [Vector3]) {
        let mut pieces = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            let (piece, others) = gradients.split_at_mut(part.local.len());
            pieces.push(piece);
            gradients = others;
        }
        let level = Level::new();
        self.parts.par_iter().zip(pieces).for_each(|(part, piece)| {
            let values = part.gather(multipliers);
            with_vectors!(level, (simd, _numbers) => self.add_changes(simd, part, &values, piece));
        });
    }

    #[inline(always)]
    fn add_changes<S: Simd, const M: usize>(
        &self,
        simd: S,
        part: &Part,
        values: &[[Quad; M]],
        gradients: &mut [Vector3],
    ) {
        let first = self.starts[part.points.start];
        self.for_each_rest(
            simd,
            part,
            values,
            #[inline(always)]
            |entry: Entry<M>, rest: f64x4<S>| {
                let [x, y, z, _]: Quad = (rest * entry.metric).into();
                gradients[entry.index - first] += Vector3::new(x, y, z);
            },
        );
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
    fn for_each_rest<S: Simd, const M: usize>(
        &self,
        simd: S,
        part: &Part,
        values: &[[Quad; M]],
        mut visit: impl FnMut(Entry<M>, f64x4<S>),
    ) {
        let first = self.starts[part.points.start];
        let zero = f64x4::splat(simd, 0.0);
        let mut seen: Vec<Seen<M>> = Vec::new();
        for q in part.points.clone() {
            let row = self.row(q);
            let (X, point) = (&self.layout.points[q], &self.points[q]);
            let (phi, nodes) =
                (&self.phi[row.clone()], &part.local[row.start - first..row.end - first]);
            let mut moments = [zero; 4];
            seen.clear();
            for (phi, &node) in phi.iter().zip(nodes) {
                let node = node as usize;
                let offset = part.positions[node] - X;
                let monomials = monomials::<M>(&offset, part.inverse_spacing[node]);
                let mut value = zero;
                for (&monomial, own) in monomials.iter().zip(&values[node]) {
                    let own: f64x4<S> = (*own).simd_into(simd);
                    value = own.mul_add(f64x4::splat(simd, monomial), value);
                }
                let metric = phi.abs() + METRIC_FLOOR;
                let affine: Quad = local(&offset, point.inverse_scale).into();
                for k in 0..4 {
                    moments[k] = f64x4::splat(simd, affine[k] * metric).mul_add(value, moments[k]);
                }
                seen.push(Seen { metric, monomials, affine, value: value.into() });
            }
            let fit = fit(simd, &point.gram_inverse, &moments);
            for (index, (seen, &node)) in row.zip(seen.iter().zip(nodes)) {
                let Seen { metric, monomials, affine, value } = *seen;
                let mut rest: f64x4<S> = value.simd_into(simd);
                for k in 0..4 {
                    rest = f64x4::splat(simd, -affine[k]).mul_add(fit[k], rest);
                }
                let node = node as usize;
                visit(Entry { point: q, index, node, metric, monomials }, rest);
            }
        }
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

/// The affine function with given moments, by its coefficients.
#[inline(always)]
fn fit<S: Simd>(simd: S, gram_inverse: &Matrix4<f64>, moments: &[f64x4<S>; 4]) -> [f64x4<S>; 4] {
    let mut fit = [f64x4::splat(simd, 0.0); 4];
    for k in 0..4 {
        for l in 0..4 {
            fit[k] = f64x4::splat(simd, gram_inverse[(k, l)]).mul_add(moments[l], fit[k]);
        }
    }
    fit
}
