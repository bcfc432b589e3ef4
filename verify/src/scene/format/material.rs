//! Constitutive laws and their parameters.

use crate::scene::format::choice::choice;
use mtled::material::VolumetricTerm;
use schemars::JsonSchema;
use serde::Deserialize;

/// A constitutive law with its parameters: exactly one pair of elastic constants; A, B and
/// poisson_ratio for mooney_rivlin; terms and poisson_ratio or bulk_modulus for ogden.
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
    /// Volumetric energy of neo_hookean_isochoric and ogden; "quadratic" if left out.
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
        /// ψ = λ/2 (tr E)² + μ E:E.
        "st_venant_kirchhoff" StVenantKirchhoff,
        /// ψ = λ/2 (tr ε)² + μ ε:ε, small displacements only.
        "linear_elastic" LinearElastic,
    }
}

choice! {
    /// Volumetric energy U(J) of neo_hookean_isochoric and ogden.
    VolumetricFormat for VolumetricTerm {
        /// U = K/2 (J−1)².
        "quadratic" Quadratic,
        /// U = K/4 (J² − 1 − 2 ln J).
        "simo_taylor" SimoTaylor,
    }
}
