//! The hot loop over the points of one block, four points or one node at a time
//! in the processor's vectors: chunk by chunk the gradients of the displacement,
//! J, the projected pressure, the stress and the nodal forces.
#![allow(non_snake_case)]

use crate::lanes::{Four, Lanes, Parts};
use crate::material::{ConstitutiveLaw, Deformation, with_law};
use crate::model::Block;
use crate::tensor::{Tensor, map};
use fearless_simd::{Simd, f64x4, prelude::*};
use std::ops::Range;

/// Scratch memory of one block; nothing in it outlives a step.
#[derive(Debug, Clone)]
pub struct Scratch {
    /// Displacements of the block's nodes \[m\].
    pub u: Vec<Four>,
    /// Displacements of the direction of a derivative \[m\]; empty without one.
    pub v: Vec<Four>,
    /// Forces on the block's nodes, or their derivative \[N\].
    pub f: Vec<Four>,
    /// The smallest J and its local point.
    pub smallest: (f64, usize),
    /// Columns of ∂u/∂X \[–\], later of P \[Pa\], of each point of a chunk.
    columns: Parts,
    /// F, row by row, of each four points.
    deformation: Parts,
    jacobians: Parts,
    pressures: Parts,
}

impl Scratch {
    pub fn new(block: &Block, components: usize) -> Scratch {
        let groups = block.chunks().map(|chunk| chunk.len().div_ceil(4)).max().unwrap_or(0);
        Scratch {
            u: vec![Four::default(); block.nodes.len()],
            v: Vec::new(),
            f: vec![Four::default(); block.nodes.len()],
            smallest: (f64::INFINITY, 0),
            columns: Parts::new(4 * groups * components),
            deformation: Parts::new(9 * groups),
            jacobians: Parts::new(groups),
            pressures: Parts::new(groups),
        }
    }
}

/// f_a = Σ_q w_q P(F_q) Grad φ_a(X_q) of the block's points at `scratch.u`; with
/// dual numbers its derivative along `scratch.v`.
#[inline(always)]
pub fn block_force<S: Simd, R: Lanes<S>, const D: usize>(
    simd: S,
    block: &Block,
    scratch: &mut Scratch,
) {
    scratch.f.fill(Four::default());
    scratch.smallest = (f64::INFINITY, 0);
    for chunk in block.chunks() {
        let columns = &mut scratch.columns;
        gradients::<S, D>(simd, block, &chunk, &scratch.u, &mut columns.values);
        if R::SLOPES {
            gradients::<S, D>(simd, block, &chunk, &scratch.v, &mut columns.slopes);
        }
        with_law!(&block.law, law => match &block.projection {
            None => stress::<S, R, _, D>(simd, law, chunk.len(), scratch),
            Some(projection) => {
                deform::<S, R, D>(simd, chunk.len(), scratch);
                let rule = (&block.quadrature_weights[chunk.clone()], &projection.basis[chunk.clone()]);
                let Scratch { jacobians, pressures, .. } = &mut *scratch;
                projection.pressures::<S, R, _>(simd, law, rule, jacobians, pressures);
                stress_and_pressure::<S, R, _, D>(simd, law, chunk.len(), scratch);
            }
        });
        keep_smallest(&chunk, scratch);
        let columns = if R::SLOPES { &scratch.columns.slopes } else { &scratch.columns.values };
        scatter::<S, D>(simd, block, &chunk, columns, &mut scratch.f);
    }
}

/// Columns Σ_a u_a ∂φ_a/∂X_j at the points of a chunk, 0 at what fills the last
/// four.
#[inline(always)]
fn gradients<S: Simd, const D: usize>(
    simd: S,
    block: &Block,
    chunk: &Range<usize>,
    u: &[Four],
    columns: &mut [Four],
) {
    let (columns, _) = columns.as_chunks_mut::<D>();
    let (filled, padding) = columns.split_at_mut(chunk.len());
    for (point, columns) in chunk.clone().zip(filled) {
        let (nodes, gradients) = block.support::<D>(point);
        // Two sums, so that one need not wait for the other.
        let mut sums = [[f64x4::splat(simd, 0.0); D]; 2];
        let ((pairs, node), (two, gradient)) = (nodes.as_chunks::<2>(), gradients.as_chunks::<2>());
        for (pair, two) in pairs.iter().zip(two) {
            for k in 0..2 {
                add_product(simd, &u[pair[k] as usize], &two[k], &mut sums[k]);
            }
        }
        if let ([node], [gradient]) = (node, gradient) {
            add_product(simd, &u[*node as usize], gradient, &mut sums[0]);
        }
        for j in 0..D {
            columns[j].0 = (sums[0][j] + sums[1][j]).into();
        }
    }
    let rest = chunk.len().next_multiple_of(4) - chunk.len();
    padding[..rest].fill([Four::default(); D]);
}

/// sums_j += u_a ∂φ_a/∂X_j.
#[inline(always)]
fn add_product<S: Simd, const D: usize>(
    simd: S,
    u: &Four,
    gradient: &[f64; D],
    sums: &mut [f64x4<S>; D],
) {
    let u: f64x4<S> = u.0.simd_into(simd);
    for j in 0..D {
        sums[j] = u.mul_add(f64x4::splat(simd, gradient[j]), sums[j]);
    }
}

/// F = I + ∂u/∂X with its cofactors and J at four points; in a plane F₃₃ = 1.
#[inline(always)]
fn deformation<S: Simd, R: Lanes<S>, const D: usize>(
    simd: S,
    columns: &Parts,
    group: usize,
) -> Deformation<R> {
    Deformation::new(map(
        #[inline(always)]
        |i, j| {
            let slope = R::from_parts(
                simd,
                columns,
                #[inline(always)]
                |columns, lane| match i < D && j < D {
                    true => columns[(4 * group + lane) * D + j].0[i],
                    false => 0.0,
                },
            );
            if i == j { slope + 1.0 } else { slope }
        },
    ))
}

/// F and J of `count` points.
#[inline(always)]
fn deform<S: Simd, R: Lanes<S>, const D: usize>(simd: S, count: usize, scratch: &mut Scratch) {
    for group in 0..count.div_ceil(4) {
        let state: Deformation<R> = deformation::<S, R, D>(simd, &scratch.columns, group);
        state.J.store(&mut scratch.jacobians, group);
        for (k, value) in state.F.iter().flatten().enumerate() {
            value.store(&mut scratch.deformation, 9 * group + k);
        }
    }
}

#[inline(always)]
fn keep_smallest(chunk: &Range<usize>, scratch: &mut Scratch) {
    let jacobians = scratch.jacobians.values.iter().flat_map(|four| four.0);
    for (point, jacobian) in chunk.clone().zip(jacobians) {
        if jacobian < scratch.smallest.0 {
            scratch.smallest = (jacobian, point);
        }
    }
}

/// J and the columns of P of `count` points.
#[inline(always)]
fn stress<S: Simd, R: Lanes<S>, L: ConstitutiveLaw, const D: usize>(
    simd: S,
    law: &L,
    count: usize,
    scratch: &mut Scratch,
) {
    for group in 0..count.div_ceil(4) {
        let state: Deformation<R> = deformation::<S, R, D>(simd, &scratch.columns, group);
        state.J.store(&mut scratch.jacobians, group);
        put_columns::<S, R, D>(&law.first_piola_kirchhoff(&state), group, &mut scratch.columns);
    }
}

/// The columns of P with the projected pressure p, P + p cof F.
#[inline(always)]
fn stress_and_pressure<S: Simd, R: Lanes<S>, L: ConstitutiveLaw, const D: usize>(
    simd: S,
    law: &L,
    count: usize,
    scratch: &mut Scratch,
) {
    for group in 0..count.div_ceil(4) {
        let state: Deformation<R> = Deformation::new(map(
            #[inline(always)]
            |i, j| R::load(simd, &scratch.deformation, 9 * group + 3 * i + j),
        ));
        let P = law.first_piola_kirchhoff(&state);
        let pressure = R::load(simd, &scratch.pressures, group);
        let P = map(
            #[inline(always)]
            |i, j| state.cof[i][j].times_plus(pressure, P[i][j]),
        );
        put_columns::<S, R, D>(&P, group, &mut scratch.columns);
    }
}

#[inline(always)]
fn put_columns<S: Simd, R: Lanes<S>, const D: usize>(
    P: &Tensor<R>,
    group: usize,
    columns: &mut Parts,
) {
    for i in 0..D {
        for j in 0..D {
            P[i][j].spread(
                columns,
                #[inline(always)]
                |lane| ((4 * group + lane) * D + j, i),
            );
        }
    }
}

/// f_a += w P Grad φ_a.
#[inline(always)]
fn scatter<S: Simd, const D: usize>(
    simd: S,
    block: &Block,
    chunk: &Range<usize>,
    columns: &[Four],
    f: &mut [Four],
) {
    for (point, columns) in chunk.clone().zip(columns.as_chunks::<D>().0) {
        let weight = block.quadrature_weights[point];
        let columns: [f64x4<S>; D] = std::array::from_fn(
            #[inline(always)]
            |j| {
                let column: f64x4<S> = columns[j].0.simd_into(simd);
                column * weight
            },
        );
        let (nodes, gradients) = block.support::<D>(point);
        for (&node, gradient) in nodes.iter().zip(gradients) {
            let force = &mut f[node as usize].0;
            let mut sum: f64x4<S> = (*force).simd_into(simd);
            for j in 0..D {
                sum = columns[j].mul_add(f64x4::splat(simd, gradient[j]), sum);
            }
            *force = sum.into();
        }
    }
}
