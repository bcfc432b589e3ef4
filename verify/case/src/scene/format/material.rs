//! Constitutive laws and their parameters.

use crate::scene::format::choice::choice;
use crate::scene::format::conditions::AmplitudeFormat;
use crate::scene::format::fibres::DirectionFormat;
use mtled::material::VolumetricTerm;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A constitutive law with its parameters: exactly one pair of elastic constants; A, B and
/// poisson_ratio for mooney_rivlin; terms and poisson_ratio or bulk_modulus for ogden; constants and
/// poisson_ratio or bulk_modulus for yeoh and demiray; constants, bulk_modulus and directions for
/// laws with fibres.
#[derive(Debug, Deserialize, JsonSchema)]
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
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OgdenTermFormat {
    /// Its part of the shear modulus at rest [Pa], positive.
    pub mu: f64,
    /// Exponent α [–], not 0; -4.7 for brain tissue.
    pub alpha: f64,
}

/// A term of viscosity.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PronyTermFormat {
    /// The part of the isochoric stress that relaxes with it [–], positive; all sum to less than 1.
    pub g: f64,
    /// Its relaxation time [s], positive.
    pub tau: f64,
}

/// The second Piola–Kirchhoff stress T f ⊗ f with the direction f of the fibres at rest.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ActiveStressFormat {
    /// T at amplitude 1 [Pa].
    pub tension: f64,
    /// Factor over time; constant if left out.
    #[serde(default)]
    pub amplitude: AmplitudeFormat,
}

choice! {
    /// A constitutive law.
    LawFormat {
        /// ψ = A(I−3) + B(II−3) + C(III⁻²−1) + D(III−1)².
        "mooney_rivlin" MooneyRivlin,
        /// ψ = μ/2 (I₁−3) − μ ln J + λ/2 (ln J)².
        "neo_hookean_log_j" NeoHookeanLogJ,
        /// ψ = μ/2 (J^(−2/3) I₁ − 3) + U(J).
        "neo_hookean_isochoric" NeoHookeanIsochoric,
        /// ψ = Σ 2μ/α² (λ̄₁^α + λ̄₂^α + λ̄₃^α − 3) + U(J), λ̄ = J^(−1/3) λ.
        "ogden" Ogden,
        /// ψ = C1 x + C2 x² + C3 x³ + U(J), x = Ī₁ − 3 [Pa]; C2 and C3 are 0 if left out.
        "yeoh" Yeoh,
        /// ψ = mu/2b (exp(b (Ī₁ − 3)) − 1) + U(J).
        "demiray" Demiray,
        /// ψ = C/2 (exp Q − 1) + U(J), Q = b_f E₁₁² + b_t (E₂₂² + E₃₃² + 2 E₂₃²) + 2 b_fs (E₁₂² + E₁₃²),
        /// Ē in the frame of the fibres.
        "guccione" Guccione,
        /// ψ = mu/2 (Ī₁ − 3) + k1/2k2 Σ (exp(k2 E²) − 1) + U(J), E = ⟨kappa (Ī₁ − 3) + (1 − 3 kappa)(Ī₄ − 1)⟩
        /// of two families of fibres at ± angle [rad] from `fibres` towards `sheets`; kappa and angle
        /// are 0 if left out.
        "holzapfel_gasser_ogden" HolzapfelGasserOgden,
        /// ψ = a/2b (exp(b (Ī₁ − 3)) − 1) + a_f/2b_f (exp(b_f ⟨Ī₄f − 1⟩²) − 1) + a_s/2b_s (exp(b_s ⟨Ī₄s − 1⟩²) − 1)
        /// + a_fs/2b_fs (exp(b_fs Ī₈²) − 1) + U(J); terms of sheets are left out with their constants.
        "holzapfel_ogden" HolzapfelOgden,
        /// ψ = λ/2 (tr E)² + μ E:E.
        "st_venant_kirchhoff" StVenantKirchhoff,
        /// ψ = λ/2 (tr ε)² + μ ε:ε, small displacements only.
        "linear_elastic" LinearElastic,
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
