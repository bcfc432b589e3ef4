#![allow(non_snake_case)]

use super::*;
use crate::algebra::random::Random;
use crate::algebra::real::Dual;
use crate::algebra::tensor::{Matrix3, Vector3, map, rotation};
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
        ("Ogden, brain", ogden(&[(842.0, -4.7)], 0.49, VolumetricTerm::Quadratic)),
        (
            "Ogden, three terms",
            ogden(&[(300.0, 1.3), (40.0, 5.0), (90.0, -2.0)], 0.45, VolumetricTerm::SimoTaylor),
        ),
        ("Yeoh", yeoh([400.0, -20.0, 60.0]).unwrap()),
        ("Demiray", isochoric(&[1000.0, 2.0], Law::Demiray).unwrap()),
        ("Guccione", isochoric(&[2000.0, 8.0, 2.0, 4.0], Law::Guccione).unwrap()),
        (
            "Holzapfel, Gasser, Ogden",
            isochoric(&[7640.0, 996.6e3, 5.0, 0.226, 0.7], Law::HolzapfelGasserOgden).unwrap(),
        ),
        ("Holzapfel, Ogden", isochoric(&MUSCLE, Law::HolzapfelOgden).unwrap()),
        ("St Venant-Kirchhoff", Law::StVenantKirchhoff(StVenantKirchhoff::new(constants))),
        ("linear elastic", Law::LinearElastic(LinearElastic::new(constants))),
        ("Demiray's, of the caller's own", Law::Own(OwnLaw::new(Demiray).unwrap())),
    ]
}

/// ψ = μ/2b (e^(b (I₁ − 3)) − 1) − μ ln J + λ/2 (ln J)² (Demiray 1972) with b = 2.
#[derive(Debug)]
struct Demiray;

impl StrainEnergy for Demiray {
    fn energy(&self, C: &[[Number; 3]; 3]) -> Number {
        let minor = |a: usize, b: usize| C[1][a] * C[2][b] - C[1][b] * C[2][a];
        let third = C[0][0] * minor(1, 2) - C[0][1] * minor(0, 2) + C[0][2] * minor(0, 1);
        let (first, log) = (C[0][0] + C[1][1] + C[2][2] - 3.0, third.ln() * 0.5);
        ((first * 2.0).exp() - 1.0) * (1000.0 / 4.0) - log * 1000.0 + log * log * 1000.0
    }
}

/// The constants of Holzapfel and Ogden (2009, table 1) for simple shear.
const MUSCLE: [f64; 8] = [59.0, 8.023, 18472.0, 16.026, 2481.0, 11.12, 216.0, 11.436];

/// A law of the isochoric tensor, a hundred times stiffer against a change of volume.
fn isochoric<W: ShapeEnergy>(
    constants: &[f64],
    law: fn(Isochoric<W>) -> Law,
) -> Result<Law, MaterialError> {
    let shape = W::new(constants)?;
    let bulk_modulus = 100.0 * shape.shear_modulus();
    Ok(law(Isochoric::new(shape, bulk_modulus, VolumetricTerm::SimoTaylor)?))
}

fn yeoh(constants: [f64; 3]) -> Result<Law, MaterialError> {
    isochoric(&constants, Law::Yeoh)
}

/// Ogden's law with terms (μ \[Pa\], α).
fn ogden(terms: &[(f64, f64)], poisson_ratio: f64, volumetric: VolumetricTerm) -> Law {
    let terms: Vec<OgdenTerm> = terms.iter().map(|&(mu, alpha)| OgdenTerm { mu, alpha }).collect();
    let terms = OgdenTerms::new(&terms).unwrap();
    let constants =
        ElasticConstants::from_shear_poisson(terms.shear_modulus(), poisson_ratio).unwrap();
    Law::Ogden(Ogden::new(terms, constants.bulk_modulus, volumetric).unwrap())
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
        if law.has_fibres() {
            continue;
        }
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

/// dP of a law along `direction`, by dual numbers.
fn slope_of_stress(law: &Law, F: &Matrix3, direction: &Matrix3) -> Matrix3 {
    let F = map(|i, j| Dual { value: F[(i, j)], slope: direction[(i, j)] });
    let P = with_law!(law, law => law.first_piola_kirchhoff(&Deformation::new(F)));
    Matrix3::from_fn(|i, j| P[i][j].slope)
}

#[test]
fn tangents_are_derivatives_of_stresses_also_where_stretches_are_equal() {
    let turn = rotation(&Vector3::new(0.3, -0.5, 0.8), 0.7);
    let stretched = |stretches: [f64; 3]| turn * Matrix3::from_diagonal(&stretches.into());
    let direction = Matrix3::new(0.3, -0.2, 0.5, 0.4, 0.7, 0.1, -0.6, 0.2, -0.4);
    for F in [
        Matrix3::identity(),
        stretched([1.2, 1.2, 1.2]),
        stretched([1.3, 1.3, 0.7]) * turn,
        stretched([1.3, 1.3 + 1e-8, 0.7]) * turn,
        stretched([0.7, 1.0, 1.4]) * turn,
    ] {
        for (name, law) in laws() {
            let switches = matches!(law, Law::HolzapfelGasserOgden(_) | Law::HolzapfelOgden(_));
            let shape = F.transpose() * F / F.determinant().cbrt().powi(2);
            if switches && (shape - Matrix3::identity()).norm() < 1e-12 {
                // There fibres begin to carry, and the slope is that in tension.
                continue;
            }
            let step = 1e-5;
            let at = |along: f64| law.first_piola_kirchhoff(&(F + direction * along));
            let difference = (at(step) - at(-step)) / (2.0 * step);
            let slope = slope_of_stress(&law, &F, &direction);
            let error = (slope - difference).norm() / law.constants().bulk_modulus;
            assert!(error < 1e-8, "{name}: {error:e} at {F}");
        }
    }
}

#[test]
fn the_law_of_ogden_with_alpha_two_is_the_neo_hookean_law() {
    let F = deformation([0.2, -0.1, 0.3, 0.05, -0.15, 0.1, 0.0, 0.25, 0.1]);
    for volumetric in [VolumetricTerm::Quadratic, VolumetricTerm::SimoTaylor] {
        let law = ogden(&[(842.0, 2.0)], 0.49, volumetric);
        let twin = Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(law.constants(), volumetric));
        let (P, expected) = (law.first_piola_kirchhoff(&F), twin.first_piola_kirchhoff(&F));
        assert!((P - expected).norm() < 1e-14 * expected.norm(), "{P} {expected}");
        approx::assert_relative_eq!(
            law.strain_energy(&F),
            twin.strain_energy(&F),
            max_relative = 1e-14
        );
    }
}

#[test]
fn the_law_of_ogden_with_alpha_two_and_minus_two_is_that_of_mooney_and_rivlin() {
    let F = deformation([0.2, -0.1, 0.3, 0.05, -0.15, 0.1, 0.0, 0.25, 0.1]);
    let law = ogden(&[(500.0, 2.0), (300.0, -2.0)], 0.49, VolumetricTerm::Quadratic);
    let J = F.determinant();
    let C = F.transpose() * F / J.cbrt().powi(2);
    let second = 0.5 * (C.trace().powi(2) - C.dot(&C));
    let expected = 250.0 * (C.trace() - 3.0) + 150.0 * (second - 3.0) + law.bulk_energy(J);
    approx::assert_relative_eq!(law.strain_energy(&F), expected, max_relative = 1e-13);
}

#[test]
fn brain_tissue_of_miller_and_chinzei_is_stiffer_in_compression_than_in_tension() {
    let law = ogden(&[(842.0, -4.7)], 0.49, VolumetricTerm::Quadratic);
    approx::assert_relative_eq!(law.constants().shear_modulus, 842.0);
    let stress = |stretch: f64| {
        let lateral = 1.0 / stretch.sqrt();
        let F = Matrix3::from_diagonal(&Vector3::new(stretch, lateral, lateral));
        let P = law.first_piola_kirchhoff(&F);
        P[(0, 0)] - P[(1, 1)] * lateral / stretch
    };
    // Of an incompressible bar: P = 2μ/α (λ^(α − 1) − λ^(−α/2 − 1)).
    let exact = |l: f64| 2.0 * 842.0 / -4.7 * (l.powf(-5.7) - l.powf(1.35));
    for stretch in [0.7, 1.3] {
        approx::assert_relative_eq!(stress(stretch), exact(stretch), max_relative = 1e-13);
    }
    assert!(-stress(0.7) > 3.0 * stress(1.3));
}

#[test]
fn terms_of_ogden_that_give_no_stiffness_are_refused() {
    let term = |mu, alpha| OgdenTerm { mu, alpha };
    let refusal = |terms: &[OgdenTerm]| OgdenTerms::new(terms).unwrap_err().to_string();
    assert!(refusal(&[]).contains("one to three"));
    assert!(refusal(&[term(1.0, 2.0); 4]).contains("4 entries"));
    assert!(refusal(&[term(1.0, 2.0), term(-1.0, 4.0)]).contains("mu is -1"));
    assert!(refusal(&[term(1.0, 0.0)]).contains("alpha is 0"));
}

#[test]
fn no_direction_of_a_law_with_fibres_is_stiffer_at_rest_than_stated() {
    let mut random = Random(3);
    for (name, law) in laws().into_iter().filter(|(_, law)| law.has_fibres()) {
        let c = law.constants();
        let mut stiffest: f64 = 0.0;
        for _ in 0..300 {
            let strain = Matrix3::from_fn(|_, _| random.vector(1).x);
            let strain = strain + strain.transpose();
            let strain = strain - Matrix3::from_diagonal_element(strain.trace() / 3.0);
            let F = Matrix3::identity() + strain * (1e-4 / strain.norm());
            // ψ = μ ε:ε, and of second order in U too.
            let shape = law.strain_energy(&F) - law.bulk_energy(F.determinant());
            stiffest = stiffest.max(shape / 1e-8);
        }
        let ratio = stiffest / c.shear_modulus;
        assert!((0.3..1.01).contains(&ratio), "{name}: {ratio}");
    }
}

#[test]
fn fibres_in_tension_carry_and_compressed_ones_do_not() {
    let along = |stretch: f64| {
        let lateral = 1.0 / stretch.sqrt();
        Matrix3::from_diagonal(&Vector3::new(stretch, lateral, lateral))
    };
    let muscle = isochoric(&MUSCLE, Law::HolzapfelOgden).unwrap();
    let passive = isochoric(&[59.0, 8.023, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], Law::HolzapfelOgden);
    let pull = |law: &Law, stretch: f64| {
        let sigma = law.cauchy(&along(stretch));
        sigma[(0, 0)] - sigma[(2, 2)]
    };
    let ground = passive.unwrap();
    // σ₁₁ − σ₃₃ of the fibres is 2 Ī₄ a_f (Ī₄ − 1) e^(b_f (Ī₄ − 1)²).
    let fourth = 1.1f64.powi(2);
    let expected =
        2.0 * fourth * 18472.0 * (fourth - 1.0) * (16.026 * (fourth - 1.0).powi(2)).exp();
    let fibres = pull(&muscle, 1.1) - pull(&ground, 1.1);
    approx::assert_relative_eq!(fibres, expected, max_relative = 1e-12);
    // In compression along the fibres the sheets are stretched, the normals are not loaded.
    let P = muscle.first_piola_kirchhoff(&along(0.9));
    let twin = ground.first_piola_kirchhoff(&along(0.9));
    assert!(P[(1, 1)] > twin[(1, 1)] + 100.0);
    approx::assert_relative_eq!(
        (P - twin)[(0, 0)] * 0.9,
        -(P - twin)[(1, 1)] * 0.9f64.powf(-0.5) / 2.0,
        max_relative = 1e-9
    );
}

#[test]
fn laws_with_fibres_become_known_ones_without_them() {
    let F = deformation([0.2, -0.1, 0.3, 0.05, -0.15, 0.1, 0.0, 0.25, 0.1]);
    let twins = [
        (
            isochoric(&[500.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], Law::HolzapfelOgden),
            isochoric(&[500.0, 3.0], Law::Demiray),
        ),
        (
            // Fibres in all directions alike: E = (Ī₁ − 3)/3.
            isochoric(&[500.0, 900.0, 2.0, 1.0 / 3.0, 0.3], Law::HolzapfelGasserOgden),
            isochoric(&[500.0, 900.0, 2.0, 1.0 / 3.0, 1.1], Law::HolzapfelGasserOgden),
        ),
        (yeoh([250.0, 0.0, 0.0]), isochoric(&[500.0, 1e-9], Law::Demiray)),
    ];
    for (law, twin) in twins {
        let (P, expected) =
            (law.unwrap().first_piola_kirchhoff(&F), twin.unwrap().first_piola_kirchhoff(&F));
        assert!((P - expected).norm() < 1e-8 * expected.norm(), "{P} {expected}");
    }
}

#[test]
fn constants_with_which_a_body_would_lose_its_stiffness_are_refused() {
    let message = |made: Result<Law, MaterialError>| made.unwrap_err().to_string();
    let few = isochoric(&[1.0], Law::Demiray);
    assert!(message(few).contains("1 constants are given; the law takes 2"));
    assert!(message(yeoh([0.0, 1.0, 1.0])).contains("C1 is 0"));
    assert!(message(yeoh([400.0, -300.0, 60.0])).contains("C2 > -√(3 C1 C3)"));
    assert!(message(yeoh([400.0, 1.0, -1e-3])).contains("C3 ≥ 0"));
    assert!(yeoh([400.0, -260.0, 60.0]).is_ok());
    assert!(message(isochoric(&[1.0, 8.0, 0.0, 4.0], Law::Guccione)).contains("b_t is 0"));
    let arteries =
        |kappa, angle| isochoric(&[1.0, 1.0, 1.0, kappa, angle], Law::HolzapfelGasserOgden);
    assert!(message(arteries(0.4, 0.0)).contains("kappa is 0.4"));
    assert!(message(arteries(0.1, f64::NAN)).contains("angle is NaN"));
    let muscle =
        |a_s, b_s| isochoric(&[1.0, 1.0, 1.0, 1.0, a_s, b_s, 0.0, 0.0], Law::HolzapfelOgden);
    assert!(message(muscle(1.0, 0.0)).contains("b_s is 0"));
    assert!(message(muscle(-1.0, 1.0)).contains("a_s is -1"));
}
