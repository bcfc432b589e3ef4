//! J projected on patches: relief from volumetric locking (method §3).
//!
//! On a patch with a basis B, orthonormal in the quadrature weights,
//! θ_q = Σ_b B_b(X_q) Σ_r w_r B_b(X_r) J_r. The energy per point is
//! ψ(F) − s U(J) + s U(θ), so the force gains s (p_q − U'(J_q)) cof F with the
//! pressure p_q = Σ_b B_b(X_q) Σ_r w_r B_b(X_r) U'(θ_r).
#![allow(non_snake_case)]

use crate::lanes::{Four, Lanes, Parts};
use crate::material::{ConstitutiveLaw, Law};
use fearless_simd::{Simd, f64x4, prelude::*};

/// How J is projected in a block of points.
#[derive(Debug, Clone)]
pub struct Projection {
    /// Share s of the bulk energy that sees θ \[–\].
    pub share: f64,
    /// B at each point \[m^−3/2\].
    pub basis: Vec<Four>,
}

/// Replaces values at the points of a patch, four to an entry, by their
/// projection.
#[inline(always)]
pub fn project<S: Simd>(simd: S, weights: &[f64], basis: &[Four], values: &mut [Four]) {
    let mut moments = f64x4::splat(simd, 0.0);
    for ((weights, rows), values) in weights.chunks(4).zip(basis.chunks(4)).zip(&*values) {
        for ((weight, row), value) in weights.iter().zip(rows).zip(values.0) {
            let row: f64x4<S> = row.0.simd_into(simd);
            moments = row.mul_add(f64x4::splat(simd, weight * value), moments);
        }
    }
    for (rows, values) in basis.chunks(4).zip(values) {
        for (row, value) in rows.iter().zip(&mut values.0) {
            let row: f64x4<S> = row.0.simd_into(simd);
            *value = (row * moments).reduce_sum();
        }
    }
}

impl Projection {
    /// From J at the points of a patch: s (p_q − U'(J_q)) \[Pa\].
    #[inline(always)]
    pub fn pressures<S: Simd, R: Lanes<S>, L: ConstitutiveLaw>(
        &self,
        simd: S,
        law: &L,
        (weights, basis): (&[f64], &[Four]),
        jacobians: &Parts,
        pressures: &mut Parts,
    ) {
        let groups = weights.len().div_ceil(4);
        pressures.values[..groups].copy_from_slice(&jacobians.values[..groups]);
        if R::SLOPES {
            pressures.slopes[..groups].copy_from_slice(&jacobians.slopes[..groups]);
        }
        let project_both = |parts: &mut Parts| {
            project(simd, weights, basis, &mut parts.values[..groups]);
            if R::SLOPES {
                project(simd, weights, basis, &mut parts.slopes[..groups]);
            }
        };
        project_both(pressures);
        for group in 0..groups {
            law.bulk_slope(R::load(simd, pressures, group)).store(pressures, group);
        }
        project_both(pressures);
        for group in 0..groups {
            let pointwise = law.bulk_slope(R::load(simd, jacobians, group));
            let pressure = R::load(simd, pressures, group);
            ((pressure - pointwise) * self.share).store(pressures, group);
        }
    }

    /// Σ_q w_q s (U(θ_q) − U(J_q)) \[J\] of a patch.
    pub fn energy(&self, law: &Law, rule: (&[f64], &[Four]), jacobians: &[f64]) -> f64 {
        let sum = |values: &[f64]| -> f64 {
            rule.0.iter().zip(values).map(|(w, J)| w * law.bulk_energy(*J)).sum()
        };
        self.share * (sum(&projected(rule, jacobians)) - sum(jacobians))
    }

    /// [`Projection::pressures`] of plain numbers, now and then.
    pub fn plain_pressures(
        &self,
        law: &Law,
        rule: (&[f64], &[Four]),
        jacobians: &[f64],
    ) -> Vec<f64> {
        let slopes = |values: &[f64]| values.iter().map(|J| law.bulk_slope(*J)).collect::<Vec<_>>();
        let pressures = projected(rule, &slopes(&projected(rule, jacobians)));
        let pairs = pressures.iter().zip(slopes(jacobians));
        pairs.map(|(p, pointwise)| self.share * (p - pointwise)).collect()
    }
}

/// The projection of values at the points of a patch.
fn projected((weights, basis): (&[f64], &[Four]), values: &[f64]) -> Vec<f64> {
    let mut moments = [0.0; 4];
    for ((weight, row), value) in weights.iter().zip(basis).zip(values) {
        moments.iter_mut().zip(row.0).for_each(|(m, b)| *m += weight * value * b);
    }
    basis.iter().map(|row| row.0.iter().zip(moments).map(|(b, m)| b * m).sum()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patches::orthonormal_basis;
    use crate::tensor::Vector3;
    use fearless_simd::{Level, dispatch};

    /// 27 points, so that the last entry is not full.
    fn patch() -> (Vec<Vector3>, Vec<f64>, Vec<Four>) {
        let at = |n: usize| Vector3::new((n % 3) as f64, (n / 3 % 3) as f64, (n / 9) as f64);
        let positions: Vec<Vector3> = (0..27).map(|n| at(n) + at(n * n % 27) * 0.1).collect();
        let weights: Vec<f64> = (0..27).map(|n| 1.0 + 0.1 * (n % 5) as f64).collect();
        let basis = orthonormal_basis(&positions, &weights, 0..27, 3);
        (positions, weights, basis.into_iter().map(Four).collect())
    }

    #[test]
    fn the_projection_keeps_linear_fields_and_the_mean_of_all() {
        let (positions, weights, basis) = patch();
        let rule = (&weights[..], &basis[..]);
        let linear: Vec<f64> = positions.iter().map(|X| 1.0 + 0.2 * X.x - 0.3 * X.z).collect();
        let kept = projected(rule, &linear);
        linear.iter().zip(&kept).for_each(|(a, b)| assert!((a - b).abs() < 1e-13));
        let rough: Vec<f64> = (0..27).map(|n| (n * 7 % 11) as f64).collect();
        let smooth = projected(rule, &rough);
        let mean =
            |values: &[f64]| -> f64 { values.iter().zip(&weights).map(|(v, w)| v * w).sum() };
        assert!((mean(&rough) - mean(&smooth)).abs() < 1e-12);
    }

    #[test]
    fn vectors_of_four_project_as_plain_numbers_do() {
        let (_, weights, basis) = patch();
        let rough: Vec<f64> = (0..27).map(|n| (n * 7 % 11) as f64).collect();
        let mut fours: Vec<Four> = rough
            .chunks(4)
            .map(|chunk| Four(std::array::from_fn(|l| chunk.get(l).copied().unwrap_or(f64::NAN))))
            .collect();
        dispatch!(Level::new(), simd => project(simd, &weights, &basis, &mut fours));
        let plain = projected((&weights, &basis), &rough);
        let pairs = fours.iter().flat_map(|four| four.0).zip(plain);
        pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-13, "{a} {b}"));
    }
}
