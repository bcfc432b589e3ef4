//! Regions of the body with their materials in a job.

use super::conditions::History;
use super::geometry::Selection;
use crate::scene::Case;
use crate::scene::format::{
    CaseFormat, DirectionFormat, LawFormat, MaterialFormat, VolumetricFormat,
};
use mtled::material::PronySeries;
use mtled::problem;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A part of the body with one material. Where regions overlap, the first one counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Region {
    pub name: String,
    #[serde(rename = "where")]
    pub part: Selection,
    pub material: Material,
}

/// A hyperelastic material. With F the deformation gradient: J = det F, C = FᵀF, I₁ = tr C, I, II
/// and III the invariants of C, E = (C − 1)/2, ε the small strain, λᵢ the principal stretches,
/// C̄ = J^(−2/3) C, Ī₁ = tr C̄.
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
    /// Constants of the other laws by the names in the formula, SI; empty without.
    #[serde(default)]
    pub constants: BTreeMap<String, f64>,
    /// Directions of the fibres, else null.
    #[serde(default)]
    pub fibres: Option<Direction>,
    /// Directions in the sheets of the fibres, else null.
    #[serde(default)]
    pub sheets: Option<Direction>,
    /// Rows of g [–] and τ [s] by which the isochoric stress relaxes after a sudden strain to its part
    /// 1 − Σ g (1 − e^(−t/τ)); empty where nothing relaxes.
    #[serde(default)]
    pub prony: Vec<[f64; 2]>,
    /// T f ⊗ f is added to the second Piola–Kirchhoff stress, f along the fibres, else null.
    #[serde(default)]
    pub active_stress: Option<ActiveStress>,
}

/// What muscle pulls with along its fibres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ActiveStress {
    /// T.
    pub tension_pa: f64,
    pub history: History,
}

/// A direction at every place, of any length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Direction {
    /// The same everywhere.
    Uniform { direction: [f64; 3] },
    /// Formulas of the reference position x, y, z [m], as of a displacement.
    Formula { x: String, y: String, z: String },
    /// Vectors at scattered points, in a file that the case names.
    Data,
}

impl Direction {
    fn new(format: &DirectionFormat) -> Direction {
        match (format.direction, &format.formula) {
            (Some(direction), _) => Direction::Uniform { direction },
            (None, Some(formula)) => {
                let [x, y, z] = formula.components();
                Direction::Formula { x, y, z }
            }
            (None, None) => Direction::Data,
        }
    }
}

impl Material {
    /// A material of a sound case with its constants.
    fn new(format: &MaterialFormat, region: &problem::Region, instants: &[f64]) -> Material {
        let known = &region.material;
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
            constants: format.constants.clone().unwrap_or_default(),
            fibres: format.fibres.as_ref().map(Direction::new),
            sheets: format.sheets.as_ref().map(Direction::new),
            prony: region
                .viscosity
                .iter()
                .flat_map(PronySeries::terms)
                .map(|t| [t.g, t.tau])
                .collect(),
            active_stress: region.active.as_ref().map(|active| ActiveStress {
                tension_pa: active.tension,
                history: History::new(&active.amplitude, instants),
            }),
        }
    }
}

/// The formula of a law with that of its volumetric energy.
fn strain_energy(law: LawFormat, volumetric: Option<VolumetricFormat>) -> String {
    let volumetric = match volumetric.unwrap_or(VolumetricFormat::Quadratic) {
        VolumetricFormat::Quadratic => "K/2 (J − 1)²",
        VolumetricFormat::SimoTaylor => "K/4 (J² − 1 − 2 ln J)",
    };
    law.0.energy.replace("U(J)", volumetric)
}

/// The regions of a sound case; one for a body of one material.
pub fn regions(
    format: &CaseFormat,
    case: &Case,
    tolerance_m: f64,
    instants: &[f64],
) -> Vec<Region> {
    let known = case.problem.regions.iter();
    let region = |(n, known): (usize, &problem::Region)| {
        let row = format.region.get(n);
        let material = match row {
            Some(row) => format.material.get(&row.material),
            None => format.material.values().next(),
        };
        Some(Region {
            name: known.name.clone(),
            part: row.map_or(Selection::All, |row| Selection::new(&row.part, tolerance_m)),
            material: Material::new(material?, known, instants),
        })
    };
    known.enumerate().filter_map(region).collect()
}
