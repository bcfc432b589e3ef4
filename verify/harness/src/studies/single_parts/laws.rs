//! Constitutive laws by themselves: energy, stress, stiffness at rest.
#![allow(non_snake_case)]

use crate::studies::workbench::{Workbench, exact};
use anyhow::Result;
use mtled::algebra::random::Random;
use mtled::algebra::tensor::{Matrix3, Vector3, rotation};
use mtled::material::{
    ElasticConstants, Isochoric, Law, LinearElastic, MooneyRivlin, NeoHookeanIsochoric,
    NeoHookeanLogJ, Ogden, OgdenTerm, OgdenTerms, ShapeEnergy, StVenantKirchhoff, VolumetricTerm,
};
use mtled_checks::measure::larger;
use mtled_checks::study::{Cell, Study, Table, number, text};

/// Random deformations per law, entries of F − I up to [`SIZE_OF_STRAIN`].
const DEFORMATIONS: usize = 20;
const SIZE_OF_STRAIN: f64 = 0.15;
/// Step of central differences in F, C or J: truncation and round-off are both
/// below 1e-9 of the bulk modulus.
const STEP: f64 = 1e-5;

/// Every law with ordinary constants.
fn all_laws() -> Result<Vec<(&'static str, Law)>> {
    let constants = ElasticConstants::from_young_poisson(3000.0, 0.3)?;
    let stiff = ElasticConstants::from_young_poisson(3000.0, 0.49)?;
    let isochoric = |term| Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(stiff, term));
    Ok(vec![
        ("mooney_rivlin", Law::MooneyRivlin(MooneyRivlin::new(1052.0, 0.0, 0.49)?)),
        ("mooney_rivlin_b", Law::MooneyRivlin(MooneyRivlin::new(800.0, 252.0, 0.47)?)),
        ("neo_hookean_log_j", Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants))),
        ("isochoric_quadratic", isochoric(VolumetricTerm::Quadratic)),
        ("isochoric_simo_taylor", isochoric(VolumetricTerm::SimoTaylor)),
        ("ogden", ogden()?),
        ("yeoh", Law::Yeoh(named(&[400.0, -20.0, 60.0])?)),
        ("demiray", Law::Demiray(named(&[1000.0, 2.0])?)),
        ("guccione", Law::Guccione(named(&[2000.0, 8.0, 2.0, 4.0])?)),
        (
            "holzapfel_gasser_ogden",
            Law::HolzapfelGasserOgden(named(&[7640.0, 996.6e3, 5.0, 0.226, 0.7])?),
        ),
        (
            "holzapfel_ogden",
            Law::HolzapfelOgden(named(&[59.0, 8.0, 18472.0, 16.0, 2481.0, 11.1, 216.0, 11.4])?),
        ),
        ("st_venant_kirchhoff", Law::StVenantKirchhoff(StVenantKirchhoff::new(constants))),
        ("linear_elastic", Law::LinearElastic(LinearElastic::new(constants))),
    ])
}

/// A law of named constants, a hundred times as stiff against a change of volume.
fn named<W: ShapeEnergy>(constants: &[f64]) -> Result<Isochoric<W>> {
    let shape = W::new(constants)?;
    Ok(Isochoric::new(shape, 100.0 * shape.shear_modulus(), VolumetricTerm::SimoTaylor)?)
}

/// Brain tissue of Miller, Chinzei 2002 with a second term.
fn ogden() -> Result<Law> {
    let terms = [(842.0, -4.7), (200.0, 3.0)].map(|(mu, alpha)| OgdenTerm { mu, alpha });
    let terms = OgdenTerms::new(&terms)?;
    let constants = ElasticConstants::from_shear_poisson(terms.shear_modulus(), 0.49)?;
    Ok(Law::Ogden(Ogden::new(terms, constants.bulk_modulus, VolumetricTerm::Quadratic)?))
}

/// Largest errors of a law over its bulk modulus \[–\].
#[derive(Debug, Clone, Copy, Default)]
struct Errors {
    /// P − ∂ψ/∂F.
    derivative: f64,
    /// P(I) and ψ(I).
    rest: f64,
    /// P(RF) − R P(F); 0 for the linear law, which is not objective.
    objectivity: f64,
    /// Stiffness at rest against the moduli, relative.
    moduli: f64,
    /// U'(J) − dU/dJ.
    bulk: f64,
}

/// Checks every law.
pub(crate) fn laws(bench: &Workbench, study: &mut Study) -> Result<()> {
    let mut rows = Vec::new();
    for (name, law) in all_laws()? {
        let mut random = Random(bench.seed(17));
        let e = measure(&law, &mut random);
        rows.push(row(name, &e));
        for (quantity, label, value, bound, source) in [
            (
                "derivative",
                "stress against differences of the energy",
                e.derivative,
                1e-7,
                DERIVATIVE,
            ),
            ("rest", "stress and energy at rest", e.rest, 1e-12, "no strain; round-off"),
            ("objectivity", "stress after a rotation", e.objectivity, 1e-12, "P(RF) = R P(F)"),
            ("moduli", "shear and bulk stiffness at rest", e.moduli, 1e-6, "the linear limit"),
            ("bulk", "slope of the bulk energy against its differences", e.bulk, 1e-7, DERIVATIVE),
        ] {
            if quantity == "objectivity" && !is_objective(&law) {
                continue;
            }
            let id = format!("parts/{name}/{quantity}");
            let label = format!("{label}, largest error over the bulk modulus");
            study.checks.push(exact(&id, &label, value, bound, source));
        }
    }
    study.tables.push(Table {
        title: "Largest errors of the laws over their bulk modulus".into(),
        columns: vec![
            text("law"),
            number("stress", "1"),
            number("at rest", "1"),
            number("objectivity", "1"),
            number("moduli", "1"),
            number("bulk slope", "1"),
        ],
        rows,
    });
    Ok(())
}

const DERIVATIVE: &str = "P = ∂ψ/∂F and U' = dU/dJ; central differences over 1e-5 are good to 1e-9";

fn row(name: &str, e: &Errors) -> Vec<Cell> {
    let numbers = [e.derivative, e.rest, e.objectivity, e.moduli, e.bulk].map(Cell::Number);
    [Cell::Text(name.into())].into_iter().chain(numbers).collect()
}

fn is_objective(law: &Law) -> bool {
    !matches!(law, Law::LinearElastic(_))
}

fn measure(law: &Law, random: &mut Random) -> Errors {
    let bulk_modulus = law.constants().bulk_modulus;
    let rest = law.first_piola_kirchhoff(&Matrix3::identity()).amax()
        + law.strain_energy(&Matrix3::identity()).abs();
    let mut errors =
        Errors { rest: rest / bulk_modulus, moduli: moduli_error(law), ..Errors::default() };
    for _ in 0..DEFORMATIONS {
        let F = Matrix3::identity() + Matrix3::from_fn(|_, _| SIZE_OF_STRAIN * random.symmetric());
        errors.derivative = larger(errors.derivative, derivative_error(law, &F) / bulk_modulus);
        if is_objective(law) {
            let axis = (random.vector(3) + Vector3::new(0.0, 0.0, 2.0)).normalize();
            let R = rotation(&axis, 3.0 * random.symmetric());
            let difference =
                law.first_piola_kirchhoff(&(R * F)) - R * law.first_piola_kirchhoff(&F);
            errors.objectivity = larger(errors.objectivity, difference.amax() / bulk_modulus);
        }
        let J = F.determinant();
        let slope = (law.bulk_energy(J + STEP) - law.bulk_energy(J - STEP)) / (2.0 * STEP);
        errors.bulk = larger(errors.bulk, (slope - law.bulk_slope(J)).abs() / bulk_modulus);
    }
    errors
}

/// Largest entry of P − ∂ψ/∂F \[Pa\].
fn derivative_error(law: &Law, F: &Matrix3) -> f64 {
    let P = law.first_piola_kirchhoff(F);
    let difference = Matrix3::from_fn(|i, j| {
        let (mut ahead, mut behind) = (*F, *F);
        ahead[(i, j)] += STEP;
        behind[(i, j)] -= STEP;
        (law.strain_energy(&ahead) - law.strain_energy(&behind)) / (2.0 * STEP)
    });
    (P - difference).iter().map(|e| e.abs()).fold(0.0, larger)
}

/// Largest relative error of ∂P₁₂/∂F₁₂ = μ and ∂tr P/∂e = 9K at F = (1 + e)I. Of a law with fibres μ is
/// a bound of all directions: how far the shear modulus is above it.
fn moduli_error(law: &Law) -> f64 {
    let constants = law.constants();
    let slope = |direction: Matrix3, read: fn(&Matrix3) -> f64| {
        let at = |step: f64| law.first_piola_kirchhoff(&(Matrix3::identity() + step * direction));
        (read(&at(STEP)) - read(&at(-STEP))) / (2.0 * STEP)
    };
    let mut sheared = Matrix3::zeros();
    sheared[(0, 1)] = 1.0;
    let shear = slope(sheared, |P| P[(0, 1)]) / constants.shear_modulus;
    let bulk = slope(Matrix3::identity(), |P| P.trace()) / (9.0 * constants.bulk_modulus);
    let shear = if law.has_fibres() { (shear - 1.0).max(0.0) } else { (shear - 1.0).abs() };
    larger(shear, (bulk - 1.0).abs())
}
