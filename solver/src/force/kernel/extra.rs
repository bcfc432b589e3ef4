//! Stresses beside those of a law, fixed while displacements are looked for.
#![allow(non_snake_case)]

use super::points::load_tensor;
use crate::algebra::lanes::{LANES, Lanes, Parts, SimdBlock};
use crate::algebra::tensor::{
    Matrix3, Tensor, contract, map, right_cauchy_green, times_symmetric, transposed,
};
use crate::material::Deformation;
use fearless_simd::Simd;
use std::ops::Range;

/// The entries of a symmetric tensor in the order in which six numbers stand for them.
pub const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];
/// The number of each entry.
const NUMBERS: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

/// A symmetric tensor at eight points.
pub type Symmetric = [SimdBlock; 6];

/// What acts beside the law at the points of a block.
#[derive(Debug, Clone, Default)]
pub struct ExtraStress {
    /// Part of the isochoric stress that has relaxed by now, however it grew since the last
    /// equilibrium \[–\].
    pub relaxed: f64,
    /// Second Piola–Kirchhoff stress \[SIMD block\] \[Pa\].
    pub stress: Vec<Symmetric>,
    /// What the last forces were computed from \[SIMD block\].
    pub found: Vec<Found>,
}

/// The state of eight points.
#[derive(Debug, Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
pub struct Found {
    /// The isochoric part of the law's second Piola–Kirchhoff stress \[Pa\].
    pub isochoric: Symmetric,
    /// C \[–\].
    pub right_cauchy_green: Symmetric,
}

impl ExtraStress {
    /// None, at so many SIMD blocks.
    pub fn zero(groups: usize) -> ExtraStress {
        let (stress, found) = (vec![Symmetric::default(); groups], vec![Found::default(); groups]);
        ExtraStress { relaxed: 0.0, stress, found }
    }

    /// ½ S : (C − 1) at the point in a lane \[Pa\].
    pub fn energy(&self, lane: usize, C: &Matrix3) -> f64 {
        let stress = &self.stress[lane / LANES];
        let terms = ENTRIES.iter().zip(stress).map(|(&(i, j), entry)| {
            let strain = if i == j { 0.5 * (C[(i, j)] - 1.0) } else { C[(i, j)] };
            entry.0[lane % LANES] * strain
        });
        terms.sum()
    }

    /// Adds to P of some SIMD blocks, from the first on, what acts beside the law: P − r P̄ + F S
    /// (method book, eq. 3.25). A pressure in P has no part in P̄.
    pub fn add<S: Simd, R: Lanes<S>>(
        &mut self,
        simd: S,
        groups: Range<usize>,
        deformation: &Parts<SimdBlock>,
        stress: &mut Parts<SimdBlock>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                for (local, group) in groups.enumerate() {
                    for piece in 0..R::PER_BLOCK {
                        let F = load_tensor::<S, R>(simd, deformation, local, piece);
                        let P = load_tensor::<S, R>(simd, stress, local, piece);
                        let state = Deformation::new(F);
                        let P = self.added::<S, R>(simd, (group, piece), &state, &P);
                        for (i, row) in P.iter().enumerate() {
                            for (j, entry) in row.iter().enumerate() {
                                entry.store(stress, 9 * local + 3 * i + j, piece);
                            }
                        }
                    }
                }
            },
        );
    }

    /// P at a SIMD block with what acts beside the law.
    #[inline(always)]
    fn added<S: Simd, R: Lanes<S>>(
        &mut self,
        simd: S,
        (group, piece): (usize, usize),
        state: &Deformation<R>,
        P: &Tensor<R>,
    ) -> Tensor<R> {
        let Deformation { F, cof, J } = state;
        let mean = contract(P, F) / *J * (-1.0 / 3.0);
        let isochoric = map(
            #[inline(always)]
            |i, j| cof[i][j].times_plus(mean, P[i][j]),
        );
        if !R::SLOPES {
            self.keep::<S, R>(simd, (group, piece), state, &isochoric);
        }
        let stress = &self.stress[group];
        let own = map(
            #[inline(always)]
            |i, j| R::fixed(simd, &stress[NUMBERS[i][j]], piece),
        );
        let FS = times_symmetric(F, &own);
        map(
            #[inline(always)]
            |i, j| P[i][j] - isochoric[i][j] * self.relaxed + FS[i][j],
        )
    }

    /// Keeps S̄ = F⁻¹ P̄ and C.
    #[inline(always)]
    fn keep<S: Simd, R: Lanes<S>>(
        &mut self,
        simd: S,
        (group, piece): (usize, usize),
        Deformation { F, cof, J }: &Deformation<R>,
        isochoric: &Tensor<R>,
    ) {
        let S = times_symmetric(&transposed(cof), &transposed(isochoric));
        let C = right_cauchy_green(F);
        let Found { isochoric, right_cauchy_green } = &mut self.found[group];
        for (n, (i, j)) in ENTRIES.into_iter().enumerate() {
            (S[i][j] / *J).write(simd, &mut isochoric[n], piece);
            C[i][j].write(simd, &mut right_cauchy_green[n], piece);
        }
    }
}
