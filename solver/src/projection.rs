//! J projected on patches: relief from volumetric locking (method §3).
//!
//! On a patch with a basis B, orthonormal in the quadrature weights,
//! θ_q = Σ_b B_b(X_q) Σ_r w_r B_b(X_r) J_r. The energy per point is
//! ψ(F) − s U(J) + s U(θ), so the force gains s (p_q − U'(J_q)) cof F with the
//! pressure p_q = Σ_b B_b(X_q) Σ_r w_r B_b(X_r) U'(θ_r).
#![allow(non_snake_case)]

use crate::material::ConstitutiveLaw;

/// The patches of a block of points.
#[derive(Debug, Clone)]
pub struct Projection {
    /// Share s of the bulk energy that sees θ \[–\].
    pub share: f64,
    /// Local points of patch p: `starts[p]..starts[p + 1]`.
    pub starts: Vec<u32>,
    /// B at each point \[m^−3/2\].
    pub basis: Vec<[f64; 4]>,
}

/// Replaces values at the points of a patch by their projection.
#[inline]
pub fn project(weights: &[f64], basis: &[[f64; 4]], values: &mut [f64]) {
    let mut moments = [0.0; 4];
    for ((w, row), value) in weights.iter().zip(basis).zip(&*values) {
        for b in 0..4 {
            moments[b] += w * row[b] * value;
        }
    }
    for (row, value) in basis.iter().zip(values) {
        *value = (0..4).map(|b| row[b] * moments[b]).sum();
    }
}

impl Projection {
    /// From J at the points of a patch: s (p_q − U'(J_q)) \[Pa\].
    pub fn pressures<L: ConstitutiveLaw>(
        &self,
        law: &L,
        weights: &[f64],
        basis: &[[f64; 4]],
        jacobians: &[f64],
        pressures: &mut [f64],
    ) {
        pressures.copy_from_slice(jacobians);
        project(weights, basis, pressures);
        pressures.iter_mut().for_each(|theta| *theta = law.bulk_slope(*theta));
        project(weights, basis, pressures);
        for (p, J) in pressures.iter_mut().zip(jacobians) {
            *p = self.share * (*p - law.bulk_slope(*J));
        }
    }

    /// Σ_q w_q s (U(θ_q) − U(J_q)) \[J\] of a patch; `jacobians` are lost.
    pub fn energy<L: ConstitutiveLaw>(
        &self,
        law: &L,
        weights: &[f64],
        basis: &[[f64; 4]],
        jacobians: &mut [f64],
    ) -> f64 {
        let sum = |values: &[f64]| -> f64 {
            weights.iter().zip(values).map(|(w, J)| w * law.bulk_energy(*J)).sum()
        };
        let pointwise = sum(jacobians);
        project(weights, basis, jacobians);
        self.share * (sum(jacobians) - pointwise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patches::orthonormal_basis;
    use crate::tensor::Vector3;

    #[test]
    fn the_projection_keeps_linear_fields_and_the_mean_of_all() {
        let at = |n: usize| Vector3::new((n % 3) as f64, (n / 3 % 3) as f64, (n / 9) as f64);
        let positions: Vec<Vector3> = (0..27).map(|n| at(n) + at(n * n % 27) * 0.1).collect();
        let weights: Vec<f64> = (0..27).map(|n| 1.0 + 0.1 * (n % 5) as f64).collect();
        let basis = orthonormal_basis(&positions, &weights, 0..27, 3);
        let linear: Vec<f64> = positions.iter().map(|X| 1.0 + 0.2 * X.x - 0.3 * X.z).collect();
        let mut projected = linear.clone();
        project(&weights, &basis, &mut projected);
        linear.iter().zip(&projected).for_each(|(a, b)| assert!((a - b).abs() < 1e-13));
        let rough: Vec<f64> = (0..27).map(|n| (n * 7 % 11) as f64).collect();
        let mut smooth = rough.clone();
        project(&weights, &basis, &mut smooth);
        let mean =
            |values: &[f64]| -> f64 { values.iter().zip(&weights).map(|(v, w)| v * w).sum() };
        assert!((mean(&rough) - mean(&smooth)).abs() < 1e-12);
    }
}
