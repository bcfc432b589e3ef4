//! Compressible neo-Hookean law in the log-J form.
#![allow(non_snake_case)]

use super::{ConstitutiveLaw, ElasticConstants};
use crate::tensor::{Matrix3, cofactor};

/// ψ = μ/2 (I₁ − 3) − μ ln J + λ/2 (ln J)² \[Pa\] (Bonet and Wood 2008,
/// eq. 6.27): volumetric term in ln J.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeoHookeanLogJ {
    mu: f64,
    lambda: f64,
}

impl NeoHookeanLogJ {
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
    #[inline]
    fn first_piola_kirchhoff(&self, F: &Matrix3) -> Matrix3 {
        let cof = cofactor(F);
        let J = F.row(0).dot(&cof.row(0));
        F * self.mu + cof * ((self.lambda * J.ln() - self.mu) / J)
    }

    /// U = λ/2 (ln J)².
    fn bulk_energy(&self, J: f64) -> f64 {
        0.5 * self.lambda * J.ln().powi(2)
    }

    #[inline]
    fn bulk_slope(&self, J: f64) -> f64 {
        self.lambda * J.ln() / J
    }

    fn constants(&self) -> ElasticConstants {
        ElasticConstants { shear_modulus: self.mu, bulk_modulus: self.lambda + 2.0 / 3.0 * self.mu }
    }
}
