//! At the quadrature points of a chunk, eight of them at a time: F, J, the projected
//! pressure and P. Nothing here depends on the dimension, so that each law is
//! compiled once per kind of number.
#![allow(non_snake_case)]

use crate::algebra::lanes::{Lanes, Parts, SimdBlock};
use crate::algebra::real::Real;
use crate::algebra::tensor::{Tensor, map, times_symmetric, transposed};
use crate::force::projection::{OwnPressure, PatchMoments, Projection};
use crate::material::{ConstitutiveLaw, Deformation};
use fearless_simd::Simd;
use std::ops::Range;

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

/// s (p_q − U'(J_q)) \[Pa\] of a patch, and what the displacements make of it.
pub fn pressures<S: Simd, R: Lanes<S>, L: ConstitutiveLaw>(
    simd: S,
    law: &L,
    (projection, own): (&Projection, Option<OwnPressure>),
    groups: Range<usize>,
    jacobians: &Parts<SimdBlock>,
    pressures: &mut Parts<SimdBlock>,
) -> PatchMoments {
    simd.vectorize(
        #[inline(always)]
        || projection.pressures::<S, R, _>(simd, law, groups, own, jacobians, pressures),
    )
}

/// J and P of the first `count` SIMD blocks; with a projected pressure p, P + p cof F, J being known.
/// A law with fibres has a frame for each SIMD block. The slopes of P may be known, and stand in place of the result then.
pub fn stresses<S: Simd, R: Lanes<S>, L: ConstitutiveLaw, const D: usize>(
    simd: S,
    (law, frames): (&L, &[[SimdBlock; 9]]),
    count: usize,
    deformation: &Parts<SimdBlock>,
    pressures: Option<&Parts<SimdBlock>>,
    (stress, jacobians, is_known): (&mut Parts<SimdBlock>, &mut Parts<SimdBlock>, bool),
) {
    simd.vectorize(
        #[inline(always)]
        || {
            for group in 0..count {
                for piece in 0..R::PER_BLOCK {
                    let F = load_tensor::<S, R>(simd, deformation, group, piece);
                    let state: Deformation<R> = Deformation::new(F);
                    let frame = if L::HAS_FIBRES { frames.get(group) } else { None };
                    let mut P = match (is_known, frame) {
                        (true, _) => load_tensor::<S, R>(simd, stress, group, piece),
                        (false, Some(rows)) => {
                            in_frame(law, &F, &frame_at::<S, R>(simd, rows, piece))
                        }
                        (false, None) => law.first_piola_kirchhoff(&state),
                    };
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

/// P at F of a law with fibres: P'(F Q) Qᵀ with the fibre frame Q (method book, eq. 3.22).
#[inline(always)]
fn in_frame<R: Real, L: ConstitutiveLaw>(law: &L, F: &Tensor<R>, Q: &Tensor<R>) -> Tensor<R> {
    let own = Deformation::new(times_symmetric(F, &transposed(Q)));
    times_symmetric(&law.first_piola_kirchhoff(&own), Q)
}

#[inline(always)]
fn frame_at<S: Simd, R: Lanes<S>>(simd: S, rows: &[SimdBlock; 9], piece: usize) -> Tensor<R> {
    map(
        #[inline(always)]
        |i, j| R::fixed(simd, &rows[3 * i + j], piece),
    )
}

#[inline(always)]
pub fn load_tensor<S: Simd, R: Lanes<S>>(
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
