//! Hooke's law for small displacements.
#![allow(non_snake_case)]

use crate::algebra::real::Real;
use crate::algebra::tensor::{Matrix3, Tensor, map};
use crate::material::constants::ElasticConstants;
use crate::material::constitutive_law::{ConstitutiveLaw, Deformation};

/// ψ = λ/2 (tr ε)² + μ ε:ε, ε = sym F − I \[Pa\] (method book, eq. 3.11). Not
/// objective: for small rotations only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearElastic {
    mu: f64,
    lambda: f64,
}

impl LinearElastic {
    /// From the constants at rest.
    pub fn new(constants: ElasticConstants) -> Self {
        LinearElastic { mu: constants.shear_modulus, lambda: constants.lame_modulus() }
    }
}

impl ConstitutiveLaw for LinearElastic {
    fn strain_energy(&self, F: &Matrix3) -> f64 {
        let strain = (F + F.transpose()) * 0.5 - Matrix3::identity();
        0.5 * self.lambda * strain.trace().powi(2) + self.mu * strain.dot(&strain)
    }

    /// P = λ tr ε I + 2μ ε.
    #[inline(always)]
    fn first_piola_kirchhoff<R: Real>(&self, state: &Deformation<R>) -> Tensor<R> {
        let F = &state.F;
        let trace = F[0][0] + F[1][1] + F[2][2] - 3.0;
        map(
            #[inline(always)]
            |i, j| {
                if i == j {
                    (F[i][i] - 1.0) * (2.0 * self.mu) + trace * self.lambda
                } else {
                    (F[i][j] + F[j][i]) * self.mu
                }
            },
        )
    }

    fn constants(&self) -> ElasticConstants {
        ElasticConstants { shear_modulus: self.mu, bulk_modulus: self.lambda + 2.0 / 3.0 * self.mu }
    }
}
