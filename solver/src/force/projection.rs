//! J projected on patches, against volumetric locking (method book, eqs. 10.3 to
//! 10.5).
//!
//! On a patch with a basis B, orthonormal in the quadrature weights,
//! θ_q = Σ_b B_b(X_q) Σ_r w_r B_b(X_r) J_r. The energy per point is
//! ψ(F) − s U(J) + s U(θ), so the stress gains s (p_q − U'(J_q)) cof F with the
//! pressure p_q = Σ_b B_b(X_q) Σ_r w_r B_b(X_r) U'(θ_r).
#![allow(non_snake_case)]

use crate::algebra::lanes::{LANES, Lanes, Parts, SimdBlock, load_block};
use crate::material::{ConstitutiveLaw, Law};
use fearless_simd::{Simd, f64x8, prelude::*};
use std::ops::Range;

/// How J is projected in a block of points.
#[derive(Debug, Clone)]
pub struct Projection {
    /// Fraction s of the volumetric energy that depends on θ in place of J \[–\].
    pub fraction: f64,
    /// Weights and basis of all patches, each padded with zeros to whole blocks.
    pub blocks: Vec<BasisBlock>,
}

/// Weights w \[m³\] and basis B \[m^−3/2\] at eight points.
#[derive(Debug, Clone, Copy, Default)]
pub struct BasisBlock {
    pub weights: SimdBlock,
    pub basis: [SimdBlock; 4],
}

impl BasisBlock {
    /// The points of a patch, from their weights \[m³\] and basis \[m^−3/2\].
    pub fn of_patch(weights: &[f64], basis: &[[f64; 4]]) -> Vec<BasisBlock> {
        let mut blocks = vec![BasisBlock::default(); weights.len().div_ceil(LANES)];
        for (point, (weight, row)) in weights.iter().zip(basis).enumerate() {
            let BasisBlock { weights, basis } = &mut blocks[point / LANES];
            weights.0[point % LANES] = *weight;
            for b in 0..4 {
                basis[b].0[point % LANES] = row[b];
            }
        }
        blocks
    }
}

/// Σ_q w_q B_b(X_q) v_q of values v at the points of a patch; those at the padding must be
/// finite.
#[inline(always)]
fn moments<S: Simd>(simd: S, patch: &[BasisBlock], values: &[SimdBlock]) -> [f64; 4] {
    let mut moments = [f64x8::splat(simd, 0.0); 4];
    for (BasisBlock { weights, basis }, value) in patch.iter().zip(values) {
        let weighted = load_block(simd, weights) * load_block(simd, value);
        for b in 0..4 {
            moments[b] = weighted.mul_add(load_block(simd, &basis[b]), moments[b]);
        }
    }
    moments.map(
        #[inline(always)]
        |moment| moment.reduce_sum(),
    )
}

/// Replaces values at the points of a patch by Σ_b B_b(X_q) m_b of moments m.
#[inline(always)]
fn expand<S: Simd>(simd: S, patch: &[BasisBlock], moments: [f64; 4], values: &mut [SimdBlock]) {
    let mut sums = [f64x8::splat(simd, 0.0); 4];
    for b in 0..4 {
        sums[b] = f64x8::splat(simd, moments[b]);
    }
    for (BasisBlock { basis, .. }, value) in patch.iter().zip(values) {
        let mut sum = load_block(simd, &basis[0]) * sums[0];
        for b in 1..4 {
            sum = load_block(simd, &basis[b]).mul_add(sums[b], sum);
        }
        value.0 = sum.into();
    }
}

/// Replaces values at the points of a patch by their projection, whose moments it returns; the
/// values at the padding must be finite.
#[inline(always)]
fn project<S: Simd>(simd: S, patch: &[BasisBlock], values: &mut [SimdBlock]) -> [f64; 4] {
    let moments = moments(simd, patch, values);
    expand(simd, patch, moments, values);
    moments
}

/// What the displacements make of a patch.
#[derive(Debug, Clone, Copy, Default)]
pub struct PatchMoments {
    /// Σ_q w_q B_b(X_q) U'(θ_q) \[Pa·m^(3/2)\].
    pub pressure: [f64; 4],
    /// Σ_q w_q B_b(X_q) J_q \[m^(3/2)\], or its slope along a displacement.
    pub volume: [f64; 4],
}

/// Moments of the pressure of a patch that has one of its own, beside that which J gives.
#[derive(Debug, Clone, Copy)]
pub struct OwnPressure {
    /// Σ_q w_q B_b(X_q) p_q \[Pa·m^(3/2)\].
    pub moments: [f64; 4],
    /// Their slope along a displacement, beside that which J gives.
    pub slopes: [f64; 4],
    /// Part c of the difference between the two that acts beside it \[–\].
    pub part: f64,
}

impl OwnPressure {
    /// p + c (P − p) with the moments P that J gives (method book, eq. 21.13).
    #[inline(always)]
    pub fn approached(&self, found: [f64; 4]) -> [f64; 4] {
        let OwnPressure { moments, part, .. } = self;
        [0, 1, 2, 3].map(
            #[inline(always)]
            |b| moments[b] + part * (found[b] - moments[b]),
        )
    }

    /// The slope of [`OwnPressure::approached`] with that of P.
    #[inline(always)]
    fn slope(&self, found: [f64; 4]) -> [f64; 4] {
        let OwnPressure { slopes, part, .. } = self;
        [0, 1, 2, 3].map(
            #[inline(always)]
            |b| slopes[b] + part * found[b],
        )
    }
}

impl Projection {
    /// B_b \[m^−3/2\] at the point in a lane of the block.
    pub fn basis_at(&self, lane: usize) -> [f64; 4] {
        self.blocks[lane / LANES].basis.map(|values| values.0[lane % LANES])
    }

    /// s (p_q − U'(J_q)) \[Pa\] from J at the points of a patch, which may have a pressure of
    /// its own.
    #[inline(always)]
    pub fn pressures<S: Simd, R: Lanes<S>, L: ConstitutiveLaw>(
        &self,
        simd: S,
        law: &L,
        groups: Range<usize>,
        own: Option<OwnPressure>,
        jacobians: &Parts<SimdBlock>,
        pressures: &mut Parts<SimdBlock>,
    ) -> PatchMoments {
        let count = groups.len();
        let patch = &self.blocks[groups];
        pressures.values[..count].copy_from_slice(&jacobians.values[..count]);
        let mut volume = project(simd, patch, &mut pressures.values[..count]);
        if R::SLOPES {
            pressures.slopes[..count].copy_from_slice(&jacobians.slopes[..count]);
            volume = project(simd, patch, &mut pressures.slopes[..count]);
        }
        for entry in 0..count {
            for piece in 0..R::PER_BLOCK {
                let theta = R::load(simd, pressures, entry, piece);
                law.bulk_slope(theta).store(pressures, entry, piece);
            }
        }
        // At the padding θ is 0 and U' may be NaN, which a weight of 0 does not remove.
        if let Some(last) = patch.last() {
            for lane in (0..LANES).filter(|&lane| last.weights.0[lane] == 0.0) {
                pressures.values[count - 1].0[lane] = 0.0;
                pressures.slopes[count - 1].0[lane] = 0.0;
            }
        }
        let found = moments(simd, patch, &pressures.values[..count]);
        let acting = own.map_or(found, |own| own.approached(found));
        expand(simd, patch, acting, &mut pressures.values[..count]);
        if R::SLOPES {
            let found = moments(simd, patch, &pressures.slopes[..count]);
            let acting = own.map_or(found, |own| own.slope(found));
            expand(simd, patch, acting, &mut pressures.slopes[..count]);
        }
        for entry in 0..count {
            for piece in 0..R::PER_BLOCK {
                let pointwise = law.bulk_slope(R::load(simd, jacobians, entry, piece));
                let pressure = R::load(simd, pressures, entry, piece);
                ((pressure - pointwise) * self.fraction).store(pressures, entry, piece);
            }
        }
        PatchMoments { pressure: found, volume }
    }

    /// Σ_q w_q s (U(θ_q) − U(J_q)) \[J\] of a patch.
    pub fn energy(&self, law: &Law, groups: Range<usize>, jacobians: &[f64]) -> f64 {
        let patch = &self.blocks[groups];
        let weights = patch.iter().flat_map(|block| block.weights.0);
        let thetas = projected(patch, jacobians);
        let gains = jacobians
            .iter()
            .zip(thetas)
            .map(|(J, theta)| law.bulk_energy(theta) - law.bulk_energy(*J));
        self.fraction * weights.zip(gains).map(|(w, gain)| w * gain).sum::<f64>()
    }

    /// Slopes of the moments of the pressure along those of J, of which a part acts \[Pa\]:
    /// s c Σ_q w_q B_b B_c U''(θ_q) \[b\]\[c\].
    pub fn slopes(
        &self,
        law: &Law,
        groups: Range<usize>,
        jacobians: &[f64],
        part: f64,
    ) -> [[f64; 4]; 4] {
        let patch = &self.blocks[groups];
        let mut slopes = [[0.0; 4]; 4];
        for (q, theta) in projected(patch, jacobians).into_iter().enumerate() {
            let BasisBlock { weights, basis } = &patch[q / LANES];
            let basis = basis.map(|b| b.0[q % LANES]);
            let bulk = self.fraction * part * weights.0[q % LANES] * law.bulk_curvature(theta);
            for b in 0..4 {
                (0..4).for_each(|c| slopes[b][c] += bulk * basis[b] * basis[c]);
            }
        }
        slopes
    }

    /// As [`Projection::pressures`], for output.
    pub fn plain_pressures(&self, law: &Law, groups: Range<usize>, jacobians: &[f64]) -> Vec<f64> {
        let patch = &self.blocks[groups];
        let slopes = |values: &[f64]| values.iter().map(|J| law.bulk_slope(*J)).collect::<Vec<_>>();
        let pressures = projected(patch, &slopes(&projected(patch, jacobians)));
        let pairs = pressures.iter().zip(slopes(jacobians));
        pairs.map(|(p, pointwise)| self.fraction * (p - pointwise)).collect()
    }
}

/// The projection of values at the points of a patch.
fn projected(patch: &[BasisBlock], values: &[f64]) -> Vec<f64> {
    let row = |q: usize| patch[q / LANES].basis.map(|b| b.0[q % LANES]);
    let mut moments = [0.0; 4];
    for (q, value) in values.iter().enumerate() {
        let weight = patch[q / LANES].weights.0[q % LANES];
        moments.iter_mut().zip(row(q)).for_each(|(m, b)| *m += weight * value * b);
    }
    (0..values.len()).map(|q| row(q).iter().zip(moments).map(|(b, m)| b * m).sum()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::tensor::Vector3;
    use crate::discretisation::patches::orthonormal_basis;
    use fearless_simd::{Level, dispatch};

    /// 27 points, so that the last block is padded.
    fn patch() -> (Vec<Vector3>, Vec<f64>, Vec<BasisBlock>) {
        let at = |n: usize| Vector3::new((n % 3) as f64, (n / 3 % 3) as f64, (n / 9) as f64);
        let positions: Vec<Vector3> = (0..27).map(|n| at(n) + at(n * n % 27) * 0.1).collect();
        let weights: Vec<f64> = (0..27).map(|n| 1.0 + 0.1 * (n % 5) as f64).collect();
        let basis = orthonormal_basis(&positions, &weights, 0..27, 3);
        let blocks = BasisBlock::of_patch(&weights, &basis);
        (positions, weights, blocks)
    }

    #[test]
    fn the_projection_keeps_linear_fields_and_the_mean_of_all() {
        let (positions, weights, patch) = patch();
        let linear: Vec<f64> = positions.iter().map(|X| 1.0 + 0.2 * X.x - 0.3 * X.z).collect();
        let projection = projected(&patch, &linear);
        linear.iter().zip(&projection).for_each(|(a, b)| assert!((a - b).abs() < 1e-13));
        let rough: Vec<f64> = (0..27).map(|n| (n * 7 % 11) as f64).collect();
        let smooth = projected(&patch, &rough);
        let mean =
            |values: &[f64]| -> f64 { values.iter().zip(&weights).map(|(v, w)| v * w).sum() };
        assert!((mean(&rough) - mean(&smooth)).abs() < 1e-12);
    }

    #[test]
    fn vectors_project_as_plain_numbers_do() {
        let (_, _, patch) = patch();
        let rough: Vec<f64> = (0..27).map(|n| (n * 7 % 11) as f64).collect();
        let mut blocks: Vec<SimdBlock> = rough
            .chunks(LANES)
            .map(|chunk| SimdBlock(std::array::from_fn(|l| chunk.get(l).copied().unwrap_or(1e3))))
            .collect();
        dispatch!(Level::new(), simd => project(simd, &patch, &mut blocks));
        let plain = projected(&patch, &rough);
        let pairs = blocks.iter().flat_map(|block| block.0).zip(plain);
        pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-13, "{a} {b}"));
    }
}
