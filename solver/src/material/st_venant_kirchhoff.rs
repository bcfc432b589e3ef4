//! St Venant–Kirchhoff law.
#![allow(non_snake_case)]

use crate::algebra::real::Real;
use crate::algebra::tensor::{Matrix3, Tensor, map, right_cauchy_green, times_symmetric};
use crate::material::constants::ElasticConstants;
use crate::material::constitutive_law::{ConstitutiveLaw, Deformation};

/// ψ = λ/2 (tr E)² + μ E:E, E = (FᵀF − I)/2 \[Pa\] (method book, eq. 3.10).
/// Not sound in strong compression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StVenantKirchhoff {
    mu: f64,
    lambda: f64,
}

impl StVenantKirchhoff {
    /// From the constants at rest.
    pub fn new(constants: ElasticConstants) -> Self {
        StVenantKirchhoff { mu: constants.shear_modulus, lambda: constants.lame_modulus() }
    }
}

impl ConstitutiveLaw for StVenantKirchhoff {
    fn strain_energy(&self, F: &Matrix3) -> f64 {
        let E = (F.transpose() * F - Matrix3::identity()) * 0.5;
        0.5 * self.lambda * E.trace().powi(2) + self.mu * E.dot(&E)
    }

    /// P = F (λ tr E I + 2μ E).
    #[inline(always)]
    fn first_piola_kirchhoff<R: Real>(&self, state: &Deformation<R>) -> Tensor<R> {
        let C = right_cauchy_green(&state.F);
        let spherical = (C[0][0] + C[1][1] + C[2][2] - 3.0) * (0.5 * self.lambda);
        let S = map(
            #[inline(always)]
            |i, j| if i == j { (C[i][i] - 1.0) * self.mu + spherical } else { C[i][j] * self.mu },
        );
        times_symmetric(&state.F, &S)
    }

    fn constants(&self) -> ElasticConstants {
        ElasticConstants { shear_modulus: self.mu, bulk_modulus: self.lambda + 2.0 / 3.0 * self.mu }
    }
}
