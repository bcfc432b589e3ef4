//! Compressible neo-Hookean law in the log-J form.
#![allow(non_snake_case)]

use crate::algebra::real::Real;
use crate::algebra::tensor::{Matrix3, Tensor, map};
use crate::material::constants::ElasticConstants;
use crate::material::constitutive_law::{ConstitutiveLaw, Deformation};

/// ψ = μ/2 (I₁ − 3) − μ ln J + λ/2 (ln J)² \[Pa\] (Bonet, Wood 2008, eq. 6.27;
/// method book, eq. 3.3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeoHookeanLogJ {
    mu: f64,
    lambda: f64,
}

impl NeoHookeanLogJ {
    /// From the constants at rest.
    pub fn new(constants: ElasticConstants) -> Self {
        NeoHookeanLogJ { mu: constants.shear_modulus, lambda: constants.lame_modulus() }
    }
}

impl ConstitutiveLaw for NeoHookeanLogJ {
    fn strain_energy(&self, F: &Matrix3) -> f64 {
        let log_J = F.determinant().ln();
        0.5 * self.mu * (F.dot(F) - 3.0) - self.mu * log_J + 0.5 * self.lambda * log_J * log_J
    }

    /// P = μ F + (λ ln J − μ) F⁻ᵀ.
    #[inline(always)]
    fn first_piola_kirchhoff<R: Real>(&self, state: &Deformation<R>) -> Tensor<R> {
        let Deformation { F, cof, J } = state;
        let factor = (J.ln() * self.lambda - self.mu) / *J;
        map(
            #[inline(always)]
            |i, j| cof[i][j].times_plus(factor, F[i][j] * self.mu),
        )
    }

    /// U = λ/2 (ln J)².
    fn bulk_energy(&self, J: f64) -> f64 {
        0.5 * self.lambda * J.ln().powi(2)
    }

    #[inline(always)]
    fn bulk_slope<R: Real>(&self, J: R) -> R {
        J.ln() * self.lambda / J
    }

    fn constants(&self) -> ElasticConstants {
        ElasticConstants { shear_modulus: self.mu, bulk_modulus: self.lambda + 2.0 / 3.0 * self.mu }
    }
}
