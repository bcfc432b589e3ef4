//! Constitutive laws: strain energy ψ(F) per reference volume \[Pa\] and first
//! Piola–Kirchhoff stress P = ∂ψ/∂F \[Pa\], one law per file.

mod catalogue;
mod constants;
mod constitutive_law;
mod isochoric;
mod law;
mod linear_elastic;
mod mooney_rivlin;
mod neo_hookean_isochoric;
mod neo_hookean_log_j;
mod ogden;
mod own_law;
mod prony;
mod st_venant_kirchhoff;
mod volumetric_term;

pub use catalogue::{LAWS, NamedConstants, NamedLaw, Takes};
pub use constants::{ElasticConstants, MaterialError};
pub use constitutive_law::{ConstitutiveLaw, Deformation};
pub use isochoric::{
    Constant, Demiray, Guccione, HolzapfelGasserOgden, HolzapfelOgden, Isochoric, ShapeEnergy, Yeoh,
};
pub(crate) use law::with_law;
pub use law::{Law, Material};
pub use linear_elastic::LinearElastic;
pub use mooney_rivlin::MooneyRivlin;
pub use neo_hookean_isochoric::NeoHookeanIsochoric;
pub use neo_hookean_log_j::NeoHookeanLogJ;
pub use ogden::{Ogden, OgdenTerm, OgdenTerms};
pub use own_law::{Number, OwnLaw, StrainEnergy};
pub use prony::{PronySeries, PronyTerm};
pub use st_venant_kirchhoff::StVenantKirchhoff;
pub use volumetric_term::VolumetricTerm;

#[cfg(test)]
mod tests;
