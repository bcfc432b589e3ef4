//! Constitutive laws: strain energy ψ(F) per reference volume \[Pa\] and first
//! Piola–Kirchhoff stress P = ∂ψ/∂F \[Pa\], one law per file.
#![allow(non_snake_case)]

mod constants;
mod linear_elastic;
mod mooney_rivlin;
mod neo_hookean_isochoric;
mod neo_hookean_log_j;
mod st_venant_kirchhoff;

pub use constants::{ElasticConstants, MaterialError};
pub use linear_elastic::LinearElastic;
pub use mooney_rivlin::MooneyRivlin;
pub use neo_hookean_isochoric::{NeoHookeanIsochoric, VolumetricTerm};
pub use neo_hookean_log_j::NeoHookeanLogJ;
pub use st_venant_kirchhoff::StVenantKirchhoff;

use crate::algebra::real::Real;
use crate::algebra::tensor::{Matrix3, Tensor, dot, tensor, tensor_cofactor};

/// F with what every law makes of it.
#[derive(Debug, Clone, Copy)]
pub struct Deformation<R> {
    /// \[–\]
    pub F: Tensor<R>,
    /// cof F = J F⁻ᵀ \[–\]
    pub cof: Tensor<R>,
    /// det F \[–\]
    pub J: R,
}

impl<R: Real> Deformation<R> {
    #[inline(always)]
    pub fn new(F: Tensor<R>) -> Deformation<R> {
        let cof = tensor_cofactor(&F);
        Deformation { F, cof, J: dot(&F[0], &cof[0]) }
    }
}

/// What the internal force needs of a law. Implemented by the laws of this
/// module only; the loops over the stresses are compiled once per law.
pub trait ConstitutiveLaw: Copy + Send + Sync {
    /// Strain energy per reference volume ψ \[Pa\].
    fn strain_energy(&self, F: &Matrix3) -> f64;
    /// First Piola–Kirchhoff stress P \[Pa\].
    fn first_piola_kirchhoff<R: Real>(&self, state: &Deformation<R>) -> Tensor<R>;
    /// Shear and bulk modulus at rest.
    fn constants(&self) -> ElasticConstants;

    /// The part U(J) of ψ that resists a change of volume \[Pa\], convex, with
    /// U'(1) = 0 and U''(1) = λ or K; λ/2 (J − 1)² where ψ has no such part.
    fn bulk_energy(&self, J: f64) -> f64 {
        0.5 * self.constants().lame_modulus() * (J - 1.0).powi(2)
    }

    /// U'(J) \[Pa\].
    #[inline(always)]
    fn bulk_slope<R: Real>(&self, J: R) -> R {
        (J - 1.0) * self.constants().lame_modulus()
    }
}

/// A law with its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    MooneyRivlin(MooneyRivlin),
    NeoHookeanLogJ(NeoHookeanLogJ),
    NeoHookeanIsochoric(NeoHookeanIsochoric),
    StVenantKirchhoff(StVenantKirchhoff),
    LinearElastic(LinearElastic),
}

/// Runs `$body` with `$law` bound to the concrete law, so that it is compiled
/// once for each.
macro_rules! with_law {
    ($value:expr, $law:ident => $body:expr) => {
        match $value {
            $crate::material::Law::MooneyRivlin($law) => $body,
            $crate::material::Law::NeoHookeanLogJ($law) => $body,
            $crate::material::Law::NeoHookeanIsochoric($law) => $body,
            $crate::material::Law::StVenantKirchhoff($law) => $body,
            $crate::material::Law::LinearElastic($law) => $body,
        }
    };
}
pub(crate) use with_law;

impl Law {
    /// Strain energy per reference volume ψ(F) \[Pa\].
    pub fn strain_energy(&self, F: &Matrix3) -> f64 {
        with_law!(self, law => law.strain_energy(F))
    }

    /// First Piola–Kirchhoff stress P = ∂ψ/∂F \[Pa\].
    pub fn first_piola_kirchhoff(&self, F: &Matrix3) -> Matrix3 {
        let state = Deformation::new(tensor(F));
        let P = with_law!(self, law => law.first_piola_kirchhoff(&state));
        Matrix3::from_fn(|i, j| P[i][j])
    }

    /// Shear and bulk modulus at rest.
    pub fn constants(&self) -> ElasticConstants {
        with_law!(self, law => law.constants())
    }

    /// The part U(J) of the energy that resists a change of volume \[Pa\].
    pub fn bulk_energy(&self, J: f64) -> f64 {
        with_law!(self, law => law.bulk_energy(J))
    }

    /// U'(J) \[Pa\].
    pub fn bulk_slope(&self, J: f64) -> f64 {
        with_law!(self, law => law.bulk_slope(J))
    }

    /// Share s = max(0, 1 − 3μ/2λ) of the bulk energy that is projected on
    /// patches (method §3): none for ν ≤ 0.3, 0.97 for ν = 0.49. The linear
    /// law has none, J not being linear.
    pub fn projected_share(&self) -> f64 {
        let c = self.constants();
        match self {
            Law::LinearElastic(_) => 0.0,
            // A hair of tolerance: ν = 0.3 is λ = 3μ/2 up to round-off.
            _ => Some(1.0 - 1.5 * c.shear_modulus / c.lame_modulus())
                .filter(|s| *s > 1e-9)
                .unwrap_or(0.0),
        }
    }

    /// Cauchy stress σ = P Fᵀ/J \[Pa\].
    pub fn cauchy(&self, F: &Matrix3) -> Matrix3 {
        self.first_piola_kirchhoff(F) * F.transpose() / F.determinant()
    }
}

/// A law and a density.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Per reference volume \[kg/m³\].
    pub density: f64,
    pub law: Law,
}

impl Material {
    /// Speed of pressure waves at rest c = √((K + 4μ/3)/ρ) \[m/s\].
    pub fn wave_speed(&self) -> f64 {
        let c = self.law.constants();
        ((c.bulk_modulus + 4.0 / 3.0 * c.shear_modulus) / self.density).sqrt()
    }
}

#[cfg(test)]
mod tests;
