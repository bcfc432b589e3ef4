//! The hot loop over the points of one block, eight points or one node at a time
//! in the processor's vectors: chunk by chunk the gradients of the displacement,
//! J, the projected pressure, the stress and the nodal forces.
#![allow(non_snake_case)]

use crate::algebra::lanes::{Eight, Four, Lanes, Parts, four, prefetch};
use crate::algebra::tensor::{Tensor, map};
use crate::material::{ConstitutiveLaw, Deformation, with_law};
use crate::model::blocks::{Held, with_stored};
use crate::model::{Block, Chunk};
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
    columns: Parts<Four>,
    /// F, row by row, of each eight points.
    deformation: Parts<Eight>,
    jacobians: Parts<Eight>,
    pressures: Parts<Eight>,
}

impl Scratch {
    pub fn new(block: &Block, components: usize) -> Scratch {
        let groups = block.chunks().map(|chunk| chunk.eights.len()).max().unwrap_or(0);
        Scratch {
            u: vec![Four::default(); block.nodes.len()],
            v: Vec::new(),
            f: vec![Four::default(); block.nodes.len()],
            smallest: (f64::INFINITY, 0),
            columns: Parts::new(8 * groups * components),
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
    for Chunk { points, eights } in block.chunks() {
        let columns = &mut scratch.columns;
        with_stored!(&block.grad_phi, held => {
            let stream = (block, &held[..]);
            gradients::<S, _, D>(simd, stream, &points, &scratch.u, &mut columns.values);
            if R::SLOPES {
                gradients::<S, _, D>(simd, stream, &points, &scratch.v, &mut columns.slopes);
            }
        });
        with_law!(&block.law, law => match &block.projection {
            None => stress::<S, R, _, D>(simd, law, eights.len(), scratch),
            Some(projection) => {
                deform::<S, R, D>(simd, eights.len(), scratch);
                let Scratch { jacobians, pressures, .. } = &mut *scratch;
                projection.pressures::<S, R, _>(simd, law, eights.clone(), jacobians, pressures);
                stress_and_pressure::<S, R, _, D>(simd, law, eights.len(), scratch);
            }
        });
        keep_smallest(&points, scratch);
        let columns = if R::SLOPES { &scratch.columns.slopes } else { &scratch.columns.values };
        with_stored!(&block.grad_phi, held => {
            scatter::<S, _, D>(simd, (block, &held[..]), &points, columns, &mut scratch.f);
        });
    }
}

/// Columns Σ_a u_a ∂φ_a/∂X_j at the points of a chunk, 0 at what fills the last
/// eight.
#[inline(always)]
fn gradients<S: Simd, G: Held, const D: usize>(
    simd: S,
    (block, grad_phi): (&Block, &[G]),
    chunk: &Range<usize>,
    u: &[Four],
    columns: &mut [Four],
) {
    let (columns, _) = columns.as_chunks_mut::<D>();
    let (filled, padding) = columns.split_at_mut(chunk.len());
    for (point, columns) in chunk.clone().zip(filled) {
        let (nodes, gradients) = block.support::<G, D>(grad_phi, point);
        // Two sums, so that one need not wait for the other.
        let mut sums = [[f64x4::splat(simd, 0.0); D]; 2];
        for (nodes, gradients) in in_fours(nodes, gradients) {
            let mut room = [[0.0; D]; 4];
            let gradients = G::wide(gradients, &mut room);
            for k in 0..4 {
                add_product(simd, &u[nodes[k] as usize], &gradients[k], &mut sums[k % 2]);
            }
        }
        for j in 0..D {
            columns[j].0 = (sums[0][j] + sums[1][j]).into();
        }
    }
    let rest = chunk.len().next_multiple_of(8) - chunk.len();
    padding[..rest].fill([Four::default(); D]);
}

/// The entries of a support, which blocks fill up to whole fours.
#[inline(always)]
fn in_fours<'a, G, const D: usize>(
    nodes: &'a [u32],
    gradients: &'a [[G; D]],
) -> impl Iterator<Item = (&'a [u32; 4], &'a [[G; D]; 4])> {
    nodes.as_chunks::<4>().0.iter().zip(gradients.as_chunks::<4>().0)
}

/// sums_j += u_a ∂φ_a/∂X_j.
#[inline(always)]
fn add_product<S: Simd, const D: usize>(
    simd: S,
    u: &Four,
    gradient: &[f64; D],
    sums: &mut [f64x4<S>; D],
) {
    let u = four(simd, u);
    for j in 0..D {
        sums[j] = u.mul_add(f64x4::splat(simd, gradient[j]), sums[j]);
    }
}

/// F = I + ∂u/∂X with its cofactors and J at eight points; in a plane F₃₃ = 1.
#[inline(always)]
fn deformation<S: Simd, R: Lanes<S>, const D: usize>(
    simd: S,
    columns: &Parts<Four>,
    group: usize,
) -> Deformation<R> {
    Deformation::new(map(
        #[inline(always)]
        |i, j| {
            if i >= D || j >= D {
                return R::constant(simd, if i == j { 1.0 } else { 0.0 });
            }
            let slope = R::gather(
                simd,
                columns,
                #[inline(always)]
                |lane| ((8 * group + lane) * D + j, i),
            );
            if i == j { slope + 1.0 } else { slope }
        },
    ))
}

/// F and J of so many eights of points.
#[inline(always)]
fn deform<S: Simd, R: Lanes<S>, const D: usize>(simd: S, eights: usize, scratch: &mut Scratch) {
    for group in 0..eights {
        let state: Deformation<R> = deformation::<S, R, D>(simd, &scratch.columns, group);
        state.J.store(&mut scratch.jacobians, group);
        for (k, value) in state.F.iter().flatten().enumerate() {
            value.store(&mut scratch.deformation, 9 * group + k);
        }
    }
}

#[inline(always)]
fn keep_smallest(chunk: &Range<usize>, scratch: &mut Scratch) {
    let jacobians = scratch.jacobians.values.iter().flat_map(|eight| eight.0);
    for (point, jacobian) in chunk.clone().zip(jacobians) {
        if jacobian < scratch.smallest.0 {
            scratch.smallest = (jacobian, point);
        }
    }
}

/// J and the columns of P of so many eights of points.
#[inline(always)]
fn stress<S: Simd, R: Lanes<S>, L: ConstitutiveLaw, const D: usize>(
    simd: S,
    law: &L,
    eights: usize,
    scratch: &mut Scratch,
) {
    for group in 0..eights {
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
    eights: usize,
    scratch: &mut Scratch,
) {
    for group in 0..eights {
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
    columns: &mut Parts<Four>,
) {
    for (i, row) in P.iter().enumerate().take(D) {
        for (j, entry) in row.iter().enumerate().take(D) {
            entry.spread(
                columns,
                #[inline(always)]
                |lane| ((8 * group + lane) * D + j, i),
            );
        }
    }
}

/// f_a += w P Grad φ_a. On the way the processor is told to fetch what the
/// next chunk will read, as many entries ahead as this chunk has.
#[inline(always)]
fn scatter<S: Simd, G: Held, const D: usize>(
    simd: S,
    (block, grad_phi): (&Block, &[G]),
    points: &Range<usize>,
    columns: &[Four],
    f: &mut [Four],
) {
    let ahead = (block.starts[points.end] - block.starts[points.start]) as usize;
    for (point, columns) in points.clone().zip(columns.as_chunks::<D>().0) {
        let weight = block.quadrature_weights[point];
        let mut weighted = [f64x4::splat(simd, 0.0); D];
        for j in 0..D {
            weighted[j] = four(simd, &columns[j]) * weight;
        }
        let (nodes, gradients) = block.support::<G, D>(grad_phi, point);
        let coming = block.coming::<G, D>(grad_phi, point, ahead);
        for (entry, (nodes, gradients)) in in_fours(nodes, gradients).enumerate() {
            prefetch(coming.1, 4 * entry);
            prefetch(coming.1, 4 * entry + 2);
            let mut room = [[0.0; D]; 4];
            let gradients = G::wide(gradients, &mut room);
            for k in 0..4 {
                let force = &mut f[nodes[k] as usize];
                let mut sum = four(simd, force);
                for j in 0..D {
                    sum = weighted[j].mul_add(f64x4::splat(simd, gradients[k][j]), sum);
                }
                force.0 = sum.into();
            }
        }
        for k in (0..nodes.len()).step_by(16) {
            prefetch(coming.0, k);
        }
    }
}
