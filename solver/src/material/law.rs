//! Every law as one value, and the material that it belongs to.
#![allow(non_snake_case)]

use crate::algebra::real::Dual;
use crate::algebra::tensor::{Matrix3, tensor};
use crate::material::constants::ElasticConstants;
use crate::material::constitutive_law::{ConstitutiveLaw, Deformation};
use crate::material::isochoric::{
    Demiray, Guccione, HolzapfelGasserOgden, HolzapfelOgden, Isochoric, ShapeEnergy, Yeoh,
};
use crate::material::linear_elastic::LinearElastic;
use crate::material::mooney_rivlin::MooneyRivlin;
use crate::material::neo_hookean_isochoric::NeoHookeanIsochoric;
use crate::material::neo_hookean_log_j::NeoHookeanLogJ;
use crate::material::ogden::Ogden;
use crate::material::own_law::OwnLaw;
use crate::material::st_venant_kirchhoff::StVenantKirchhoff;

/// A law with its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// Compressible Mooney–Rivlin rubber.
    MooneyRivlin(MooneyRivlin),
    /// Compressible neo-Hookean law, volumetric term in ln J.
    NeoHookeanLogJ(NeoHookeanLogJ),
    /// Neo-Hookean law with the isochoric split.
    NeoHookeanIsochoric(NeoHookeanIsochoric),
    /// Ogden's law with the isochoric split.
    Ogden(Ogden),
    /// Yeoh's rubber.
    Yeoh(Isochoric<Yeoh>),
    /// Isotropic tissue that stiffens exponentially.
    Demiray(Isochoric<Demiray>),
    /// Transversely isotropic muscle.
    Guccione(Isochoric<Guccione>),
    /// Arteries: two families of dispersed fibres.
    HolzapfelGasserOgden(Isochoric<HolzapfelGasserOgden>),
    /// Muscle with fibres and sheets.
    HolzapfelOgden(Isochoric<HolzapfelOgden>),
    /// Linear in the Green–Lagrange strain.
    StVenantKirchhoff(StVenantKirchhoff),
    /// Hooke's law for small rotations.
    LinearElastic(LinearElastic),
    /// A strain energy of the caller's own.
    Own(OwnLaw),
}

/// Runs `$body` with `$law` bound to the concrete law, so that it is compiled
/// once for each.
macro_rules! with_law {
    ($value:expr, $law:ident => $body:expr) => {
        match $value {
            $crate::material::Law::MooneyRivlin($law) => $body,
            $crate::material::Law::NeoHookeanLogJ($law) => $body,
            $crate::material::Law::NeoHookeanIsochoric($law) => $body,
            $crate::material::Law::Ogden($law) => $body,
            $crate::material::Law::Yeoh($law) => $body,
            $crate::material::Law::Demiray($law) => $body,
            $crate::material::Law::Guccione($law) => $body,
            $crate::material::Law::HolzapfelGasserOgden($law) => $body,
            $crate::material::Law::HolzapfelOgden($law) => $body,
            $crate::material::Law::StVenantKirchhoff($law) => $body,
            $crate::material::Law::LinearElastic($law) => $body,
            $crate::material::Law::Own($law) => $body,
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

    /// U''(J) \[Pa\].
    pub fn bulk_curvature(&self, J: f64) -> f64 {
        with_law!(self, law => law.bulk_slope(Dual { value: J, slope: 1.0 }).slope)
    }

    /// Fraction s = max(0, 1 − 3μ/2λ) of the bulk energy that is projected on
    /// patches (method book, eq. 3.13): 0 for ν ≤ 0.3, 0.97 for ν = 0.49. It is
    /// 0 for the linear law, as J is not linear in the displacement.
    pub fn projected_fraction(&self) -> f64 {
        let c = self.constants();
        match self {
            Law::LinearElastic(_) => 0.0,
            // ν = 0.3 is λ = 3μ/2 up to round-off.
            _ => Some(1.0 - 1.5 * c.shear_modulus / c.lame_modulus())
                .filter(|s| *s > 1e-9)
                .unwrap_or(0.0),
        }
    }

    /// Whether it depends on the directions of fibres, so that F must be given in their frame.
    pub fn has_fibres(&self) -> bool {
        fn of<L: ConstitutiveLaw>(_: &L) -> bool {
            L::HAS_FIBRES
        }
        with_law!(self, law => of(law))
    }

    /// Whether it depends on the directions of sheets too.
    pub fn has_sheets(&self) -> bool {
        match self {
            Law::HolzapfelGasserOgden(law) => law.shape().has_sheets(),
            Law::HolzapfelOgden(law) => law.shape().has_sheets(),
            _ => false,
        }
    }

    /// Whether its energy is one of shape plus one of volume, so that its stress has an isochoric part.
    pub fn is_split(&self) -> bool {
        match self {
            Law::NeoHookeanIsochoric(_)
            | Law::Ogden(_)
            | Law::Yeoh(_)
            | Law::Demiray(_)
            | Law::Guccione(_)
            | Law::HolzapfelGasserOgden(_)
            | Law::HolzapfelOgden(_) => true,
            Law::MooneyRivlin(_)
            | Law::NeoHookeanLogJ(_)
            | Law::StVenantKirchhoff(_)
            | Law::LinearElastic(_)
            | Law::Own(_) => false,
        }
    }

    /// Whether its derivative costs more than a product with ∂P/∂F, so that it pays to keep that.
    pub fn is_costly(&self) -> bool {
        self.has_fibres() || matches!(self, Law::Ogden(_) | Law::Own(_) | Law::Demiray(_))
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
    /// Its stress–strain law.
    pub law: Law,
}

impl Material {
    /// Speed of pressure waves at rest c = √((K + 4μ/3)/ρ) \[m/s\] (method book, eq. 3.2).
    pub fn wave_speed(&self) -> f64 {
        let c = self.law.constants();
        ((c.bulk_modulus + 4.0 / 3.0 * c.shear_modulus) / self.density).sqrt()
    }
}
