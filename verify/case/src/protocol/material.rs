//! What a job says of each material beside its table.

use crate::scene::Case;
use crate::scene::format::{CaseFormat, MaterialFormat, RegionFormat, VolumetricFormat};
use mtled::material::Material;
use mtled::problem::Region;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A material in numbers, whatever constants its table states. With F the deformation gradient:
/// J = det F, C = FᵀF, I₁ = tr C, I, II and III the invariants of C, E = (C − 1)/2, ε the small
/// strain, λᵢ the principal stretches, C̄ = J^(−2/3) C, Ī₁ = tr C̄.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InNumbers {
    /// The strain energy per reference volume, for people: programs go by `law` and `volumetric`.
    pub strain_energy: String,
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
}

impl InNumbers {
    fn new(format: &MaterialFormat, material: &Material) -> InNumbers {
        let constants = material.law.constants();
        let rubber = format.a.zip(format.b).map(|(a, b)| {
            let nu = format.poisson_ratio.unwrap_or(constants.poisson_ratio());
            let d = (a * (5.0 * nu - 2.0) + b * (11.0 * nu - 5.0)) / (2.0 * (1.0 - 2.0 * nu));
            [a, b, 0.5 * a + b, d]
        });
        InNumbers {
            strain_energy: strain_energy(format),
            shear_modulus_pa: constants.shear_modulus,
            bulk_modulus_pa: constants.bulk_modulus,
            lame_modulus_pa: constants.lame_modulus(),
            young_modulus_pa: constants.young_modulus(),
            poisson_ratio: constants.poisson_ratio(),
            mooney_rivlin_pa: rubber,
        }
    }
}

/// The formula of a law with that of its volumetric energy.
fn strain_energy(format: &MaterialFormat) -> String {
    let volumetric = match format.volumetric.unwrap_or(VolumetricFormat::Quadratic) {
        VolumetricFormat::Quadratic => "K/2 (J − 1)²",
        VolumetricFormat::SimoTaylor => "K/4 (J² − 1 − 2 ln J)",
    };
    format.law.0.energy.replace("U(J)", volumetric)
}

/// The materials that regions of a sound case have, by their names.
pub(crate) fn materials(format: &CaseFormat, case: &Case) -> BTreeMap<String, InNumbers> {
    let pairs = format.region.iter().zip(&case.problem.regions);
    let in_numbers = |(row, region): (&RegionFormat, &Region)| {
        let table = format.material.get(&row.material)?;
        Some((row.material.clone(), InNumbers::new(table, &region.material)))
    };
    pairs.filter_map(in_numbers).collect()
}
