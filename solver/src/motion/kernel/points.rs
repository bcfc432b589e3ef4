//! At the quadrature points of a chunk, eight of them at a time: F, J, the projected
//! pressure and P. Nothing here depends on the dimension, so that each law is
//! compiled once per kind of number.
#![allow(non_snake_case)]

use crate::algebra::lanes::{LANES, Lanes, PaddedVector, Parts, SimdBlock};
use crate::algebra::tensor::{Tensor, map};
use crate::material::{ConstitutiveLaw, Deformation};
use crate::model::projection::Projection;
use fearless_simd::{Simd, f64x8, prelude::*};
use std::ops::Range;

/// Rows of F from the columns of ∂u/∂X of the first `count` SIMD blocks; `identity` is 1, or 0 for
/// its derivative. In a plane the third row and column are left alone.
#[inline(always)]
pub fn read_columns<S: Simd, const D: usize>(
    simd: S,
    columns: &[PaddedVector],
    count: usize,
    identity: f64,
    deformation: &mut [SimdBlock],
) {
    let columns = columns.as_chunks::<D>().0.as_chunks::<LANES>().0;
    for (columns, rows) in columns.iter().zip(deformation.as_chunks_mut::<9>().0).take(count) {
        for i in 0..D {
            for j in 0..D {
                // In registers: eight short stores would hold up the long load after them.
                let slopes = f64x8::from_fn(
                    simd,
                    #[inline(always)]
                    |lane| columns[lane][j].0[i],
                );
                let entries = if i == j { slopes + identity } else { slopes };
                rows[3 * i + j].0 = entries.into();
            }
        }
    }
}

/// The columns of P of the first `count` SIMD blocks: the opposite of [`read_columns`].
#[inline(always)]
pub fn write_columns<const D: usize>(
    stress: &[SimdBlock],
    count: usize,
    columns: &mut [PaddedVector],
) {
    let columns = columns.as_chunks_mut::<D>().0.as_chunks_mut::<LANES>().0;
    for (columns, rows) in columns.iter_mut().zip(stress.as_chunks::<9>().0).take(count) {
        for (lane, columns) in columns.iter_mut().enumerate() {
            for (j, column) in columns.iter_mut().enumerate() {
                let mut entries = [0.0; 4];
                for i in 0..D {
                    entries[i] = rows[3 * i + j].0[lane];
                }
                *column = PaddedVector(entries);
            }
        }
    }
}

/// J of the first `count` SIMD blocks.
pub fn jacobians<S: Simd, R: Lanes<S>>(
    simd: S,
    count: usize,
    deformation: &Parts<SimdBlock>,
    jacobians: &mut Parts<SimdBlock>,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            for group in 0..count {
                for piece in 0..R::PER_BLOCK {
                    let state =
                        Deformation::new(load_tensor::<S, R>(simd, deformation, group, piece));
                    state.J.store(jacobians, group, piece);
                }
            }
        },
    );
}

/// s (p_q − U'(J_q)) \[Pa\] of a patch.
pub fn pressures<S: Simd, R: Lanes<S>, L: ConstitutiveLaw>(
    simd: S,
    law: &L,
    projection: &Projection,
    groups: Range<usize>,
    jacobians: &Parts<SimdBlock>,
    pressures: &mut Parts<SimdBlock>,
) {
    simd.vectorize(
        #[inline(always)]
        || projection.pressures::<S, R, _>(simd, law, groups, jacobians, pressures),
    );
}

/// J and P of the first `count` SIMD blocks; with a projected pressure p, P + p cof F, J being known.
pub fn stresses<S: Simd, R: Lanes<S>, L: ConstitutiveLaw, const D: usize>(
    simd: S,
    law: &L,
    count: usize,
    deformation: &Parts<SimdBlock>,
    pressures: Option<&Parts<SimdBlock>>,
    (stress, jacobians): (&mut Parts<SimdBlock>, &mut Parts<SimdBlock>),
) {
    simd.vectorize(
        #[inline(always)]
        || {
            for group in 0..count {
                for piece in 0..R::PER_BLOCK {
                    let F = load_tensor::<S, R>(simd, deformation, group, piece);
                    let state: Deformation<R> = Deformation::new(F);
                    let mut P = law.first_piola_kirchhoff(&state);
                    match pressures {
                        None => state.J.store(jacobians, group, piece),
                        Some(pressures) => {
                            let pressure = R::load(simd, pressures, group, piece);
                            P = map(
                                #[inline(always)]
                                |i, j| state.cof[i][j].times_plus(pressure, P[i][j]),
                            );
                        }
                    }
                    for (i, row) in P.iter().enumerate().take(D) {
                        for (j, entry) in row.iter().enumerate().take(D) {
                            entry.store(stress, 9 * group + 3 * i + j, piece);
                        }
                    }
                }
            }
        },
    );
}

#[inline(always)]
fn load_tensor<S: Simd, R: Lanes<S>>(
    simd: S,
    rows: &Parts<SimdBlock>,
    group: usize,
    piece: usize,
) -> Tensor<R> {
    map(
        #[inline(always)]
        |i, j| R::load(simd, rows, 9 * group + 3 * i + j, piece),
    )
}
