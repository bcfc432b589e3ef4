//! Simple shear.
#![allow(non_snake_case)]

use mtled::algebra::tensor::Matrix3;
use mtled::material::Law;

/// F = I + γ e₁⊗e₂ \[–\].
pub(crate) fn deformation_gradient(shear: f64) -> Matrix3 {
    let mut F = Matrix3::identity();
    F[(0, 1)] = shear;
    F
}

/// First Piola–Kirchhoff stress P(I + γ e₁⊗e₂) of a law \[Pa\].
pub(crate) fn nominal_stress(law: &Law, shear: f64) -> Matrix3 {
    law.first_piola_kirchhoff(&deformation_gradient(shear))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use mtled::material::{ElasticConstants, NeoHookeanLogJ, StVenantKirchhoff};

    #[test]
    fn a_log_j_block_has_shear_stress_mu_gamma_and_the_universal_relation() {
        let c = ElasticConstants::from_shear_bulk(1000.0, 5000.0).unwrap();
        let law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(c));
        for gamma in [-0.5, 0.1, 1.2] {
            let P = nominal_stress(&law, gamma);
            assert_relative_eq!(P[(0, 1)], 1000.0 * gamma, epsilon = 1e-9);
            // Isotropy: σ₁₁ − σ₂₂ = γσ₁₂ whatever the law (Rivlin 1948).
            let sigma = law.cauchy(&deformation_gradient(gamma));
            let normal = sigma[(0, 0)] - sigma[(1, 1)];
            assert_relative_eq!(normal, gamma * sigma[(0, 1)], epsilon = 1e-9);
        }
    }

    #[test]
    fn a_st_venant_kirchhoff_block_has_the_closed_form() {
        // P₁₂ = μγ + (λ/2 + μ)γ³ from S = λ tr E I + 2μE.
        let c = ElasticConstants::from_lame_shear(2000.0, 1000.0).unwrap();
        let law = Law::StVenantKirchhoff(StVenantKirchhoff::new(c));
        for gamma in [-0.5_f64, 0.1, 1.2] {
            let expected = 1000.0 * gamma + 2000.0 * gamma.powi(3);
            let P = nominal_stress(&law, gamma);
            assert_relative_eq!(P[(0, 1)], expected, max_relative = 1e-12);
        }
    }
}
