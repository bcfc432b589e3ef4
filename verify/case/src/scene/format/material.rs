//! Constitutive laws and their parameters.

use crate::scene::format::choice::choice;
use crate::scene::format::conditions::AmplitudeFormat;
use crate::scene::format::fibres::DirectionFormat;
use mtled::material::{LAWS, NamedLaw, VolumetricTerm};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// A constitutive law with its parameters: exactly one pair of elastic constants; A, B and
/// poisson_ratio for mooney_rivlin; terms and poisson_ratio or bulk_modulus for ogden; constants and
/// poisson_ratio or bulk_modulus for yeoh and demiray; constants, bulk_modulus and directions for
/// laws with fibres.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialFormat {
    /// Its strain energy.
    pub law: LawFormat,
    /// Per reference volume [kg/m³].
    pub density: f64,
    /// E [Pa], with poisson_ratio; left out where another pair is given.
    pub young_modulus: Option<f64>,
    /// ν [–], -1 < ν < 0.5, with young_modulus, A and B, or terms; else left out.
    pub poisson_ratio: Option<f64>,
    /// First Lamé modulus λ [Pa], with shear_modulus; left out where another pair is given.
    pub lame_modulus: Option<f64>,
    /// μ [Pa], with lame_modulus or bulk_modulus; left out where another pair is given.
    pub shear_modulus: Option<f64>,
    /// K [Pa], with shear_modulus or terms; left out where another pair is given.
    pub bulk_modulus: Option<f64>,
    /// A of mooney_rivlin [Pa]; left out for other laws.
    #[serde(rename = "A")]
    pub a: Option<f64>,
    /// B of mooney_rivlin [Pa]; left out for other laws.
    #[serde(rename = "B")]
    pub b: Option<f64>,
    /// One to three terms of ogden; left out for other laws.
    pub terms: Option<Vec<OgdenTermFormat>>,
    /// Constants of yeoh, demiray and laws with fibres by their names in the formula [Pa, rad or –],
    /// such as { mu = 1000.0, b = 2.0 }; left out for other laws.
    pub constants: Option<BTreeMap<String, f64>>,
    /// Directions of the fibres, of a law or of an active stress; left out for others.
    pub fibres: Option<DirectionFormat>,
    /// Directions that lie in the sheets of the fibres; left out for laws without.
    pub sheets: Option<DirectionFormat>,
    /// One to six terms of viscosity, by which the isochoric stress relaxes after a sudden strain, whose
    /// constants the law has, to its part 1 − Σ g (1 − e^(−t/tau)); left out where nothing relaxes.
    pub prony: Option<Vec<PronyTermFormat>>,
    /// What muscle pulls with along its fibres, whatever its strain; left out where nothing pulls.
    pub active_stress: Option<ActiveStressFormat>,
    /// Volumetric energy of neo_hookean_isochoric, ogden and laws with constants; "quadratic" if left out.
    pub volumetric: Option<VolumetricFormat>,
}

/// The term 2μ/α² (λ̄₁^α + λ̄₂^α + λ̄₃^α − 3) of ogden, as Miller and Chinzei (2002) write it.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OgdenTermFormat {
    /// Its part of the shear modulus at rest [Pa], positive.
    pub mu: f64,
    /// Exponent α [–], not 0; -4.7 for brain tissue.
    pub alpha: f64,
}

/// A term of viscosity.
#[derive(Debug, Clone, Copy, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PronyTermFormat {
    /// The part of the isochoric stress that relaxes with it [–], positive; all sum to less than 1.
    pub g: f64,
    /// Its relaxation time [s], positive.
    pub tau: f64,
}

/// The second Piola–Kirchhoff stress T f ⊗ f with the direction f of the fibres at rest.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ActiveStressFormat {
    /// T at amplitude 1 [Pa].
    pub tension: f64,
    /// Factor over time; constant if left out.
    #[serde(default)]
    pub amplitude: AmplitudeFormat,
}

/// A constitutive law, by its name.
#[derive(Clone, Copy)]
pub struct LawFormat(pub &'static NamedLaw);

impl LawFormat {
    /// As case files write it.
    pub(crate) fn name(self) -> &'static str {
        self.0.name
    }
}

impl std::fmt::Debug for LawFormat {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl PartialEq for LawFormat {
    fn eq(&self, other: &LawFormat) -> bool {
        self.name() == other.name()
    }
}

impl Serialize for LawFormat {
    fn serialize<S: Serializer>(&self, writer: S) -> Result<S::Ok, S::Error> {
        writer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for LawFormat {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<LawFormat, D::Error> {
        static NAMES: LazyLock<Vec<&str>> =
            LazyLock::new(|| LAWS.iter().map(|law| law.name).collect());
        let word = String::deserialize(reader)?;
        let found = LAWS.iter().find(|law| law.name == word);
        found.map(LawFormat).ok_or_else(|| de::Error::unknown_variant(&word, &NAMES))
    }
}

impl JsonSchema for LawFormat {
    fn schema_name() -> Cow<'static, str> {
        "LawFormat".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let one = |law: &NamedLaw| {
            let description = format!("ψ = {}.", law.energy);
            json!({ "description": description, "type": "string", "const": law.name })
        };
        let all: Vec<Value> = LAWS.iter().map(one).collect();
        json_schema!({ "description": "A constitutive law.", "oneOf": all })
    }
}

choice! {
    /// Volumetric energy U(J) of neo_hookean_isochoric, ogden and laws with constants.
    VolumetricFormat for VolumetricTerm {
        /// U = K/2 (J−1)².
        "quadratic" Quadratic,
        /// U = K/4 (J² − 1 − 2 ln J).
        "simo_taylor" SimoTaylor,
    }
}
