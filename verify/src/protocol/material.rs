//! Regions of the body with their materials in a job.

use super::geometry::Selection;
use crate::scene::Case;
use crate::scene::format::{CaseFormat, LawFormat, MaterialFormat, VolumetricFormat};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A part of the body with one material. Where regions overlap, the first one counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Region {
    pub name: String,
    #[serde(rename = "where")]
    pub part: Selection,
    pub material: Material,
}

/// A hyperelastic material. With F the deformation gradient: J = det F, C = FᵀF, I₁ = tr C, I, II
/// and III the invariants of C, E = (C − 1)/2, ε the small strain, λᵢ the principal stretches.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Material {
    pub law: LawFormat,
    /// The strain energy per reference volume, with the constants below.
    pub strain_energy: String,
    /// Per reference volume.
    pub density_kg_per_m3: f64,
    /// μ at rest.
    pub shear_modulus_pa: f64,
    /// K at rest.
    pub bulk_modulus_pa: f64,
    /// λ = K − 2μ/3.
    pub lame_modulus_pa: f64,
    /// E at rest.
    pub young_modulus_pa: f64,
    /// ν at rest.
    pub poisson_ratio: f64,
    /// A, B, C and D of mooney_rivlin, else null.
    pub mooney_rivlin_pa: Option<[f64; 4]>,
    /// Rows of μᵢ [Pa] and αᵢ [–] of ogden, else null.
    pub ogden_terms: Option<Vec<[f64; 2]>>,
}

impl Material {
    /// A material of a sound case with its constants.
    fn new(format: &MaterialFormat, known: &mtled::material::Material) -> Material {
        let constants = known.law.constants();
        let rubber = format.a.zip(format.b).map(|(a, b)| {
            let nu = format.poisson_ratio.unwrap_or(constants.poisson_ratio());
            let d = (a * (5.0 * nu - 2.0) + b * (11.0 * nu - 5.0)) / (2.0 * (1.0 - 2.0 * nu));
            [a, b, 0.5 * a + b, d]
        });
        let terms = format.terms.as_ref();
        Material {
            law: format.law,
            strain_energy: strain_energy(format.law, format.volumetric),
            density_kg_per_m3: known.density,
            shear_modulus_pa: constants.shear_modulus,
            bulk_modulus_pa: constants.bulk_modulus,
            lame_modulus_pa: constants.lame_modulus(),
            young_modulus_pa: constants.young_modulus(),
            poisson_ratio: constants.poisson_ratio(),
            mooney_rivlin_pa: rubber,
            ogden_terms: terms.map(|rows| rows.iter().map(|row| [row.mu, row.alpha]).collect()),
        }
    }
}

/// The formula of a law.
fn strain_energy(law: LawFormat, volumetric: Option<VolumetricFormat>) -> String {
    let volumetric = match volumetric.unwrap_or(VolumetricFormat::Quadratic) {
        VolumetricFormat::Quadratic => "K/2 (J - 1)^2",
        VolumetricFormat::SimoTaylor => "K/4 (J^2 - 1 - 2 ln J)",
    };
    match law {
        LawFormat::MooneyRivlin => "A (I - 3) + B (II - 3) + C (III^-2 - 1) + D (III - 1)^2".into(),
        LawFormat::NeoHookeanLogJ => "mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2".into(),
        LawFormat::NeoHookeanIsochoric => format!("mu/2 (J^(-2/3) I1 - 3) + {volumetric}"),
        LawFormat::Ogden => format!(
            "sum_i 2 mu_i/alpha_i^2 (l1^alpha_i + l2^alpha_i + l3^alpha_i - 3) + {volumetric}, \
             l_k = J^(-1/3) lambda_k"
        ),
        LawFormat::StVenantKirchhoff => "lambda/2 (tr E)^2 + mu E:E".into(),
        LawFormat::LinearElastic => "lambda/2 (tr eps)^2 + mu eps:eps".into(),
    }
}

/// The regions of a sound case; one for a body of one material.
pub fn regions(format: &CaseFormat, case: &Case, tolerance_m: f64) -> Vec<Region> {
    let known = case.problem.regions.iter();
    let region = |(n, known): (usize, &mtled::problem::Region)| {
        let row = format.region.get(n);
        let material = match row {
            Some(row) => format.material.get(&row.material),
            None => format.material.values().next(),
        };
        Some(Region {
            name: known.name.clone(),
            part: row.map_or(Selection::All, |row| Selection::new(&row.part, tolerance_m)),
            material: Material::new(material?, &known.material),
        })
    };
    known.enumerate().filter_map(region).collect()
}
