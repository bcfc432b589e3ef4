//! J projected on patches: relief from volumetric locking (method §3).
//!
//! On a patch with a basis B, orthonormal in the quadrature weights,
//! θ_q = Σ_b B_b(X_q) Σ_r w_r B_b(X_r) J_r. The energy per point is
//! ψ(F) − s U(J) + s U(θ), so the force gains s (p_q − U'(J_q)) cof F with the
//! pressure p_q = Σ_b B_b(X_q) Σ_r w_r B_b(X_r) U'(θ_r).
#![allow(non_snake_case)]

use crate::algebra::lanes::{Eight, Lanes, Parts, eight};
use crate::material::{ConstitutiveLaw, Law};
use fearless_simd::{Simd, f64x8, prelude::*};
use std::ops::Range;

/// How J is projected in a block of points.
#[derive(Debug, Clone)]
pub struct Projection {
    /// Share s of the bulk energy that sees θ \[–\].
    pub share: f64,
    /// Of each eight points of a patch, the last filled with zeros.
    pub eights: Vec<Weighted>,
}

/// Weights w \[m³\] and basis B \[m^−3/2\] at eight points.
#[derive(Debug, Clone, Copy, Default)]
pub struct Weighted {
    pub weights: Eight,
    pub basis: [Eight; 4],
}

impl Weighted {
    /// Of the points of a patch.
    pub fn eights(weights: &[f64], basis: &[[f64; 4]]) -> Vec<Weighted> {
        let mut eights = vec![Weighted::default(); weights.len().div_ceil(8)];
        for (point, (weight, row)) in weights.iter().zip(basis).enumerate() {
            let Weighted { weights, basis } = &mut eights[point / 8];
            weights.0[point % 8] = *weight;
            for b in 0..4 {
                basis[b].0[point % 8] = row[b];
            }
        }
        eights
    }
}

/// Replaces values at the points of a patch by their projection. What stands
/// where no point is must be finite.
#[inline(always)]
pub fn project<S: Simd>(simd: S, patch: &[Weighted], values: &mut [Eight]) {
    let mut moments = [f64x8::splat(simd, 0.0); 4];
    for (Weighted { weights, basis }, value) in patch.iter().zip(&*values) {
        let weighted = eight(simd, weights) * eight(simd, value);
        for b in 0..4 {
            moments[b] = weighted.mul_add(eight(simd, &basis[b]), moments[b]);
        }
    }
    let mut sums = moments;
    for b in 0..4 {
        sums[b] = f64x8::splat(simd, moments[b].reduce_sum());
    }
    for (Weighted { basis, .. }, value) in patch.iter().zip(values) {
        let mut sum = eight(simd, &basis[0]) * sums[0];
        for b in 1..4 {
            sum = eight(simd, &basis[b]).mul_add(sums[b], sum);
        }
        value.0 = sum.into();
    }
}

impl Projection {
    /// From J at the points of a patch: s (p_q − U'(J_q)) \[Pa\].
    #[inline(always)]
    pub fn pressures<S: Simd, R: Lanes<S>, L: ConstitutiveLaw>(
        &self,
        simd: S,
        law: &L,
        eights: Range<usize>,
        jacobians: &Parts<Eight>,
        pressures: &mut Parts<Eight>,
    ) {
        let count = eights.len();
        let patch = &self.eights[eights];
        pressures.values[..count].copy_from_slice(&jacobians.values[..count]);
        project(simd, patch, &mut pressures.values[..count]);
        if R::SLOPES {
            pressures.slopes[..count].copy_from_slice(&jacobians.slopes[..count]);
            project(simd, patch, &mut pressures.slopes[..count]);
        }
        for entry in 0..count {
            law.bulk_slope(R::load(simd, pressures, entry)).store(pressures, entry);
        }
        // Where no point is, θ is 0 and U' may be none; a weight of 0 does not undo that.
        if let Some(last) = patch.last() {
            for lane in (0..8).filter(|&lane| last.weights.0[lane] == 0.0) {
                pressures.values[count - 1].0[lane] = 0.0;
                pressures.slopes[count - 1].0[lane] = 0.0;
            }
        }
        project(simd, patch, &mut pressures.values[..count]);
        if R::SLOPES {
            project(simd, patch, &mut pressures.slopes[..count]);
        }
        for entry in 0..count {
            let pointwise = law.bulk_slope(R::load(simd, jacobians, entry));
            let pressure = R::load(simd, pressures, entry);
            ((pressure - pointwise) * self.share).store(pressures, entry);
        }
    }

    /// Σ_q w_q s (U(θ_q) − U(J_q)) \[J\] of a patch.
    pub fn energy(&self, law: &Law, eights: Range<usize>, jacobians: &[f64]) -> f64 {
        let patch = &self.eights[eights];
        let weights = patch.iter().flat_map(|eight| eight.weights.0);
        let thetas = projected(patch, jacobians);
        let gained = jacobians
            .iter()
            .zip(thetas)
            .map(|(J, theta)| law.bulk_energy(theta) - law.bulk_energy(*J));
        self.share * weights.zip(gained).map(|(w, gained)| w * gained).sum::<f64>()
    }

    /// [`Projection::pressures`] of plain numbers, now and then.
    pub fn plain_pressures(&self, law: &Law, eights: Range<usize>, jacobians: &[f64]) -> Vec<f64> {
        let patch = &self.eights[eights];
        let slopes = |values: &[f64]| values.iter().map(|J| law.bulk_slope(*J)).collect::<Vec<_>>();
        let pressures = projected(patch, &slopes(&projected(patch, jacobians)));
        let pairs = pressures.iter().zip(slopes(jacobians));
        pairs.map(|(p, pointwise)| self.share * (p - pointwise)).collect()
    }
}

/// The projection of values at the points of a patch.
fn projected(patch: &[Weighted], values: &[f64]) -> Vec<f64> {
    let row = |q: usize| patch[q / 8].basis.map(|b| b.0[q % 8]);
    let mut moments = [0.0; 4];
    for (q, value) in values.iter().enumerate() {
        let weight = patch[q / 8].weights.0[q % 8];
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

    /// 27 points, so that the last eight are not full.
    fn patch() -> (Vec<Vector3>, Vec<f64>, Vec<Weighted>) {
        let at = |n: usize| Vector3::new((n % 3) as f64, (n / 3 % 3) as f64, (n / 9) as f64);
        let positions: Vec<Vector3> = (0..27).map(|n| at(n) + at(n * n % 27) * 0.1).collect();
        let weights: Vec<f64> = (0..27).map(|n| 1.0 + 0.1 * (n % 5) as f64).collect();
        let basis = orthonormal_basis(&positions, &weights, 0..27, 3);
        let eights = Weighted::eights(&weights, &basis);
        (positions, weights, eights)
    }

    #[test]
    fn the_projection_keeps_linear_fields_and_the_mean_of_all() {
        let (positions, weights, patch) = patch();
        let linear: Vec<f64> = positions.iter().map(|X| 1.0 + 0.2 * X.x - 0.3 * X.z).collect();
        let kept = projected(&patch, &linear);
        linear.iter().zip(&kept).for_each(|(a, b)| assert!((a - b).abs() < 1e-13));
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
        let mut eights: Vec<Eight> = rough
            .chunks(8)
            .map(|chunk| Eight(std::array::from_fn(|l| chunk.get(l).copied().unwrap_or(1e3))))
            .collect();
        dispatch!(Level::new(), simd => project(simd, &patch, &mut eights));
        let plain = projected(&patch, &rough);
        let pairs = eights.iter().flat_map(|eight| eight.0).zip(plain);
        pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-13, "{a} {b}"));
    }
}
