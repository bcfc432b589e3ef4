//! Between nodes and quadrature points: gradients of the displacement from the
//! nodes of a support, and forces on them.
#![allow(non_snake_case)]

use crate::algebra::lanes::{LANES, PaddedVector, load_vector, prefetch};
use crate::model::Block;
use crate::model::blocks::StoredNumber;
use fearless_simd::{Simd, f64x4, prelude::*};
use std::ops::Range;

/// Columns Σ_a u_a ∂φ_a/∂X_j at the points of a chunk, 0 at the padding that fills
/// the last SIMD block.
#[inline(always)]
pub fn displacement_gradients<S: Simd, G: StoredNumber, const D: usize>(
    simd: S,
    (block, grad_phi): (&Block, &[G]),
    chunk: &Range<usize>,
    u: &[PaddedVector],
    columns: &mut [PaddedVector],
) {
    let (columns, _) = columns.as_chunks_mut::<D>();
    let (filled, padding) = columns.split_at_mut(chunk.len());
    for (point, columns) in chunk.clone().zip(filled) {
        let (nodes, gradients) = block.support::<G, D>(grad_phi, point);
        // Two sums, so that one need not wait for the other.
        let mut sums = [[f64x4::splat(simd, 0.0); D]; 2];
        for (nodes, gradients) in padded_entries(nodes, gradients) {
            let mut buffer = [[0.0; D]; 4];
            let gradients = G::widen(gradients, &mut buffer);
            for k in 0..4 {
                add_product(simd, &u[nodes[k] as usize], &gradients[k], &mut sums[k % 2]);
            }
        }
        for j in 0..D {
            columns[j].0 = (sums[0][j] + sums[1][j]).into();
        }
    }
    let rest = chunk.len().next_multiple_of(LANES) - chunk.len();
    padding[..rest].fill([PaddedVector::default(); D]);
}

/// The entries of a support, which blocks pad to a multiple of four.
#[inline(always)]
fn padded_entries<'a, G, const D: usize>(
    nodes: &'a [u32],
    gradients: &'a [[G; D]],
) -> impl Iterator<Item = (&'a [u32; 4], &'a [[G; D]; 4])> {
    nodes.as_chunks::<4>().0.iter().zip(gradients.as_chunks::<4>().0)
}

/// sums_j += u_a ∂φ_a/∂X_j.
#[inline(always)]
fn add_product<S: Simd, const D: usize>(
    simd: S,
    u: &PaddedVector,
    gradient: &[f64; D],
    sums: &mut [f64x4<S>; D],
) {
    let u = load_vector(simd, u);
    for j in 0..D {
        sums[j] = u.mul_add(f64x4::splat(simd, gradient[j]), sums[j]);
    }
}

/// f_a += w P Grad φ_a from the columns of P. On the way the processor is told to fetch
/// what the next chunk will read, as many entries ahead as this chunk has.
#[inline(always)]
pub fn add_forces<S: Simd, G: StoredNumber, const D: usize>(
    simd: S,
    (block, grad_phi): (&Block, &[G]),
    points: &Range<usize>,
    columns: &[PaddedVector],
    f: &mut [PaddedVector],
) {
    let ahead = (block.starts[points.end] - block.starts[points.start]) as usize;
    for (point, columns) in points.clone().zip(columns.as_chunks::<D>().0) {
        let weight = block.quadrature_weights[point];
        let mut weighted = [f64x4::splat(simd, 0.0); D];
        for j in 0..D {
            weighted[j] = load_vector(simd, &columns[j]) * weight;
        }
        let (nodes, gradients) = block.support::<G, D>(grad_phi, point);
        let next = block.entries_ahead::<G, D>(grad_phi, point, ahead);
        for (entry, (nodes, gradients)) in padded_entries(nodes, gradients).enumerate() {
            prefetch(next.1, 4 * entry);
            prefetch(next.1, 4 * entry + 2);
            let mut buffer = [[0.0; D]; 4];
            let gradients = G::widen(gradients, &mut buffer);
            for k in 0..4 {
                let force = &mut f[nodes[k] as usize];
                let mut sum = load_vector(simd, force);
                for j in 0..D {
                    sum = weighted[j].mul_add(f64x4::splat(simd, gradients[k][j]), sum);
                }
                force.0 = sum.into();
            }
        }
        for k in (0..nodes.len()).step_by(16) {
            prefetch(next.0, k);
        }
    }
}
