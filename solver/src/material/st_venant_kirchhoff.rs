//! St Venant–Kirchhoff law.
#![allow(non_snake_case)]

use super::{ConstitutiveLaw, ElasticConstants};
use crate::tensor::Matrix3;

/// ψ = λ/2 (tr E)² + μ E:E, E = (FᵀF − I)/2 \[Pa\]. Fails in strong compression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StVenantKirchhoff {
    mu: f64,
    lambda: f64,
}

impl StVenantKirchhoff {
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
    #[inline]
    fn first_piola_kirchhoff(&self, F: &Matrix3) -> Matrix3 {
        let E = (F.transpose() * F - Matrix3::identity()) * 0.5;
        let S = E * (2.0 * self.mu) + Matrix3::from_diagonal_element(self.lambda * E.trace());
        F * S
    }

    fn constants(&self) -> ElasticConstants {
        ElasticConstants { shear_modulus: self.mu, bulk_modulus: self.lambda + 2.0 / 3.0 * self.mu }
    }
}
