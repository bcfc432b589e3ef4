//! Uniaxial stress: one stretch is given, the lateral faces are free.
#![allow(non_snake_case)]

use super::roots::free_stretch;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::material::Law;

/// A homogeneous bar under uniaxial stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct UniaxialState {
    /// Lateral stretch \[–\].
    pub lateral_stretch: f64,
    /// Axial force per reference area P₁₁ \[Pa\].
    pub nominal_stress: f64,
}

/// Solves P₂₂(diag(λ, λ_l, λ_l)) = 0 for λ_l by bisection from the side of
/// λ_l = 1. None where no lateral stretch within a factor of four frees the faces.
pub(crate) fn uniaxial_stress(law: &Law, stretch: f64) -> Option<UniaxialState> {
    let P = |lateral: f64| {
        let F = Matrix3::from_diagonal(&Vector3::new(stretch, lateral, lateral));
        law.first_piola_kirchhoff(&F)
    };
    let lateral_stretch = free_stretch(|lateral| P(lateral)[(1, 1)])?;
    Some(UniaxialState { lateral_stretch, nominal_stress: P(lateral_stretch)[(0, 0)] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use mtled::material::{
        ElasticConstants, LinearElastic, MooneyRivlin, NeoHookeanIsochoric, NeoHookeanLogJ, Ogden,
        OgdenTerm, OgdenTerms, StVenantKirchhoff, VolumetricTerm,
    };

    const BRAIN: OgdenTerm = OgdenTerm { mu: 842.0, alpha: -4.7 };

    fn ogden(terms: &[OgdenTerm], bulk_modulus: f64) -> Law {
        let terms = OgdenTerms::new(terms).unwrap();
        Law::Ogden(Ogden::new(terms, bulk_modulus, VolumetricTerm::Quadratic).unwrap())
    }

    /// Cauchy stress of an incompressible neo-Hookean bar σ = μ(λ² − 1/λ) \[Pa\]
    /// (Treloar 1975).
    fn incompressible_cauchy_stress(shear_modulus: f64, stretch: f64) -> f64 {
        shear_modulus * (stretch * stretch - 1.0 / stretch)
    }

    /// Cauchy stress of an incompressible bar of Ogden's law σ = Σ 2μ/α (λ^α − λ^(−α/2))
    /// \[Pa\] (Ogden 1972; method book, eq. 3.14).
    fn incompressible_ogden_stress(terms: &[OgdenTerm], stretch: f64) -> f64 {
        let stress = |t: &OgdenTerm| {
            2.0 * t.mu / t.alpha * (stretch.powf(t.alpha) - stretch.powf(-0.5 * t.alpha))
        };
        terms.iter().map(stress).sum()
    }

    fn laws(poisson_ratio: f64) -> Vec<Law> {
        let c = ElasticConstants::from_young_poisson(3000.0, poisson_ratio).unwrap();
        let quadratic = NeoHookeanIsochoric::new(c, VolumetricTerm::Quadratic);
        let simo_taylor = NeoHookeanIsochoric::new(c, VolumetricTerm::SimoTaylor);
        vec![
            Law::NeoHookeanLogJ(NeoHookeanLogJ::new(c)),
            Law::NeoHookeanIsochoric(quadratic),
            Law::NeoHookeanIsochoric(simo_taylor),
            Law::StVenantKirchhoff(StVenantKirchhoff::new(c)),
            Law::LinearElastic(LinearElastic::new(c)),
            Law::MooneyRivlin(MooneyRivlin::new(900.0, 100.0, 0.49).unwrap()),
            ogden(&[BRAIN], 1e5),
        ]
    }

    #[test]
    fn small_stretches_obey_hooke_in_every_law() {
        let step = 1e-5;
        for law in laws(0.3) {
            let c = law.constants();
            let state = uniaxial_stress(&law, 1.0 + step).unwrap();
            let modulus = state.nominal_stress / step;
            assert_relative_eq!(modulus, c.young_modulus(), max_relative = 1e-3);
            let contraction = (1.0 - state.lateral_stretch) / step;
            assert_relative_eq!(contraction, c.poisson_ratio(), max_relative = 1e-3);
        }
    }

    #[test]
    fn st_venant_kirchhoff_agrees_with_its_closed_form() {
        // S = E_Y ε with ε = (λ² − 1)/2, so P = λ S and λ_l² = 1 − 2νε.
        for stretch in [0.8_f64, 1.0, 1.3] {
            let state = uniaxial_stress(&laws(0.3)[3], stretch).unwrap();
            let strain = 0.5 * (stretch * stretch - 1.0);
            assert_relative_eq!(state.nominal_stress, stretch * 3000.0 * strain, epsilon = 1e-9);
            let lateral = (1.0 - 0.6 * strain).sqrt();
            assert_relative_eq!(state.lateral_stretch, lateral, epsilon = 1e-13);
        }
    }

    #[test]
    fn nearly_incompressible_rubber_tends_to_the_incompressible_bar() {
        let constants = ElasticConstants::from_shear_bulk(1000.0, 1e9).unwrap();
        let law = Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(
            constants,
            VolumetricTerm::Quadratic,
        ));
        for stretch in [0.5, 0.9, 1.5, 2.0] {
            let state = uniaxial_stress(&law, stretch).unwrap();
            let expected = incompressible_cauchy_stress(1000.0, stretch) / stretch;
            assert_relative_eq!(state.nominal_stress, expected, max_relative = 1e-4);
        }
    }

    #[test]
    fn nearly_incompressible_brain_tissue_tends_to_the_incompressible_bar_of_ogden() {
        let terms = [BRAIN, OgdenTerm { mu: 100.0, alpha: 3.0 }];
        for stretch in [0.6, 0.9, 1.5, 2.0] {
            let state = uniaxial_stress(&ogden(&terms, 1e10), stretch).unwrap();
            let expected = incompressible_ogden_stress(&terms, stretch) / stretch;
            assert_relative_eq!(state.nominal_stress, expected, max_relative = 1e-5);
        }
        // With α = 2 it is the neo-Hookean bar.
        let neo_hookean = incompressible_ogden_stress(&[OgdenTerm { mu: 7.0, alpha: 2.0 }], 1.3);
        assert_relative_eq!(neo_hookean, incompressible_cauchy_stress(7.0, 1.3), epsilon = 1e-12);
    }

    #[test]
    fn the_nominal_stress_is_the_derivative_of_the_energy_along_the_path() {
        let energy = |law: &Law, stretch: f64| {
            let l = uniaxial_stress(law, stretch).unwrap().lateral_stretch;
            law.strain_energy(&Matrix3::from_diagonal(&Vector3::new(stretch, l, l)))
        };
        for law in laws(0.45) {
            for stretch in [0.8, 1.2] {
                let slope = (energy(&law, stretch + 1e-5) - energy(&law, stretch - 1e-5)) / 2e-5;
                let stress = uniaxial_stress(&law, stretch).unwrap().nominal_stress;
                assert_relative_eq!(slope, stress, max_relative = 1e-6);
            }
        }
    }
}
