//! Biaxial stretch of a sheet: two stretches are given, the third face is free
//! (Rivlin and Saunders 1951).
#![allow(non_snake_case)]

use super::roots::free_stretch;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::material::Law;

/// A homogeneous sheet under biaxial stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BiaxialState {
    /// Stretch of the thickness \[–\].
    pub lateral_stretch: f64,
    /// Forces per reference area P₁₁ and P₂₂ \[Pa\].
    pub nominal_stress: [f64; 2],
}

/// Solves P₃₃(diag(λ₁, λ₂, λ₃)) = 0 for λ₃. None where no stretch within a
/// factor of four frees the face.
pub(crate) fn biaxial_stress(law: &Law, stretches: [f64; 2]) -> Option<BiaxialState> {
    let P = |lateral: f64| {
        let F = Matrix3::from_diagonal(&Vector3::new(stretches[0], stretches[1], lateral));
        law.first_piola_kirchhoff(&F)
    };
    let lateral_stretch = free_stretch(|lateral| P(lateral)[(2, 2)])?;
    let P = P(lateral_stretch);
    Some(BiaxialState { lateral_stretch, nominal_stress: [P[(0, 0)], P[(1, 1)]] })
}

#[cfg(test)]
mod tests {
    use super::super::uniaxial::uniaxial_stress;
    use super::*;
    use approx::assert_relative_eq;
    use mtled::material::{ElasticConstants, NeoHookeanIsochoric, NeoHookeanLogJ, VolumetricTerm};

    #[test]
    fn a_sheet_that_may_contract_as_a_bar_is_a_bar() {
        let c = ElasticConstants::from_young_poisson(3000.0, 0.3).unwrap();
        let law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(c));
        let bar = uniaxial_stress(&law, 1.2).unwrap();
        let sheet = biaxial_stress(&law, [1.2, bar.lateral_stretch]).unwrap();
        assert_relative_eq!(sheet.lateral_stretch, bar.lateral_stretch, epsilon = 1e-12);
        assert_relative_eq!(sheet.nominal_stress[0], bar.nominal_stress, max_relative = 1e-12);
        assert!(sheet.nominal_stress[1].abs() < 1e-9);
    }

    #[test]
    fn rubber_tends_to_the_incompressible_sheet() {
        // σᵢ = μ(λᵢ² − 1/(λ₁λ₂)²), Pᵢ = σᵢ/λᵢ (Treloar 1975).
        let c = ElasticConstants::from_shear_bulk(1000.0, 1e9).unwrap();
        let law = Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(c, VolumetricTerm::Quadratic));
        let stretches = [1.5_f64, 0.9];
        let state = biaxial_stress(&law, stretches).unwrap();
        let thickness = 1.0 / (stretches[0] * stretches[1]);
        assert_relative_eq!(state.lateral_stretch, thickness, max_relative = 1e-5);
        for (P, l) in state.nominal_stress.iter().zip(stretches) {
            let expected = 1000.0 * (l * l - thickness * thickness) / l;
            assert_relative_eq!(*P, expected, max_relative = 1e-4);
        }
    }
}
