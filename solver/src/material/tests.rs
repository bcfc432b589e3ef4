#![allow(non_snake_case)]

use super::*;
use crate::algebra::tensor::{Matrix3, Vector3, rotation};
use proptest::prelude::*;

/// Every law, each with ordinary constants; a new law is covered by its line.
fn laws() -> Vec<(&'static str, Law)> {
    let constants = ElasticConstants::from_young_poisson(3000.0, 0.3).unwrap();
    let stiff = ElasticConstants::from_young_poisson(3000.0, 0.49).unwrap();
    let soft = ElasticConstants::from_young_poisson(10.0, 0.1).unwrap();
    vec![
        ("rubber", Law::MooneyRivlin(MooneyRivlin::new(1052.0, 0.0, 0.49).unwrap())),
        ("rubber with B", Law::MooneyRivlin(MooneyRivlin::new(800.0, 252.0, 0.47).unwrap())),
        ("log-J", Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants))),
        ("soft log-J", Law::NeoHookeanLogJ(NeoHookeanLogJ::new(soft))),
        (
            "isochoric",
            Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(stiff, VolumetricTerm::Quadratic)),
        ),
        (
            "isochoric Simo-Taylor",
            Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(stiff, VolumetricTerm::SimoTaylor)),
        ),
        ("St Venant-Kirchhoff", Law::StVenantKirchhoff(StVenantKirchhoff::new(constants))),
        ("linear elastic", Law::LinearElastic(LinearElastic::new(constants))),
    ]
}

fn deformation(entries: [f64; 9]) -> Matrix3 {
    Matrix3::identity() + Matrix3::from_row_slice(&entries)
}

proptest! {
    #[test]
    fn stress_is_the_derivative_of_the_energy(entries in prop::array::uniform9(-0.15..0.15f64)) {
        let F = deformation(entries);
        for (name, law) in laws() {
            let P = law.first_piola_kirchhoff(&F);
            let step = 1e-6;
            for i in 0..3 {
                for j in 0..3 {
                    let (mut plus, mut minus) = (F, F);
                    plus[(i, j)] += step;
                    minus[(i, j)] -= step;
                    let difference =
                        (law.strain_energy(&plus) - law.strain_energy(&minus)) / (2.0 * step);
                    let scale = law.constants().bulk_modulus;
                    prop_assert!(
                        (difference - P[(i, j)]).abs() < 1e-6 * scale,
                        "{name} {i}{j}: {difference} against {}", P[(i, j)]
                    );
                }
            }
        }
    }

    #[test]
    fn energy_does_not_change_and_stress_turns_under_a_rotation(
        entries in prop::array::uniform9(-0.15..0.15f64),
        axis in prop::array::uniform3(-1.0..1.0f64),
        angle in -3.0..3.0f64,
    ) {
        let axis = Vector3::from(axis);
        prop_assume!(axis.norm() > 0.1);
        let (F, R) = (deformation(entries), rotation(&axis, angle));
        for (name, law) in laws() {
            if matches!(law, Law::LinearElastic(_)) {
                continue;
            }
            let scale = law.constants().bulk_modulus;
            let turned = R * F;
            prop_assert!((law.strain_energy(&turned) - law.strain_energy(&F)).abs() < 1e-12 * scale, "{name}");
            let difference = law.first_piola_kirchhoff(&turned) - R * law.first_piola_kirchhoff(&F);
            prop_assert!(difference.norm() < 1e-11 * scale, "{name}");
        }
    }
}

#[test]
fn energy_and_stress_vanish_at_rest() {
    for (name, law) in laws() {
        let scale = law.constants().bulk_modulus;
        assert!(law.strain_energy(&Matrix3::identity()).abs() < 1e-14 * scale, "{name}");
        let P = law.first_piola_kirchhoff(&Matrix3::identity());
        assert!(P.norm() < 1e-13 * scale, "{name}");
    }
}

#[test]
fn the_tangent_at_rest_has_the_stated_moduli() {
    let step = 1e-6;
    for (name, law) in laws() {
        let c = law.constants();
        let shear = Matrix3::new(0.0, step, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        let tau = (law.first_piola_kirchhoff(&(Matrix3::identity() + shear))[(0, 1)]
            - law.first_piola_kirchhoff(&(Matrix3::identity() - shear))[(0, 1)])
            / (2.0 * step);
        approx::assert_relative_eq!(tau, c.shear_modulus, max_relative = 1e-5);
        let swell = Matrix3::identity() * step;
        let pressure = (law.first_piola_kirchhoff(&(Matrix3::identity() + swell)).trace()
            - law.first_piola_kirchhoff(&(Matrix3::identity() - swell)).trace())
            / (2.0 * step)
            / 9.0;
        assert!((pressure / c.bulk_modulus - 1.0).abs() < 1e-5, "{name}: {pressure}");
    }
}

#[test]
fn the_rubber_has_the_corrected_constant_and_the_printed_modulus() {
    let law = MooneyRivlin::new(1052.0, 0.0, 0.49).unwrap();
    approx::assert_relative_eq!(law.constants().shear_modulus, 2104.0);
    approx::assert_relative_eq!(law.constants().poisson_ratio(), 0.49, max_relative = 1e-12);
}

#[test]
fn the_rubber_is_refused_where_it_is_unstable() {
    let message = MooneyRivlin::new(1052.0, 0.0, 0.1).unwrap_err().to_string();
    assert!(message.contains("ν ≥ 0.4000"), "{message}");
    assert!(MooneyRivlin::new(1052.0, 0.0, 0.4).is_ok());
    assert!(MooneyRivlin::new(1052.0, 0.0, 0.5).is_err());
    assert!(MooneyRivlin::new(-1.0, 0.0, 0.45).is_err());
}

#[test]
fn pairs_of_constants_convert_into_each_other() {
    let a = ElasticConstants::from_young_poisson(10.0, 0.1).unwrap();
    let b = ElasticConstants::from_lame_shear(a.lame_modulus(), a.shear_modulus).unwrap();
    approx::assert_relative_eq!(b.young_modulus(), 10.0, max_relative = 1e-14);
    approx::assert_relative_eq!(b.poisson_ratio(), 0.1, max_relative = 1e-14);
}
