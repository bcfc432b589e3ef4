//! Materials.

use crate::scene::{self, Scene};
use anyhow::Result;
use mtled::material::{
    ElasticConstants, Law, LinearElastic, Material, MooneyRivlin, NeoHookeanIsochoric,
    NeoHookeanLogJ, Ogden, OgdenTerm, OgdenTerms, StVenantKirchhoff, VolumetricTerm,
};

/// The material of a scene, `stiffness` times as stiff.
pub fn material(scene: &Scene, stiffness: f64) -> Result<Material> {
    let young = stiffness * scene.young_modulus;
    let constants = ElasticConstants::from_young_poisson(young, scene.poisson_ratio)?;
    let mu = constants.shear_modulus;
    let term = VolumetricTerm::Quadratic;
    let law = match scene.law {
        scene::Law::LogJ => Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants)),
        scene::Law::Isochoric => {
            Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(constants, term))
        }
        // The shear modulus at rest is 2(A + B).
        scene::Law::MooneyRivlin => {
            Law::MooneyRivlin(MooneyRivlin::new(0.5 * mu, 0.0, scene.poisson_ratio)?)
        }
        scene::Law::Ogden => {
            let terms = OgdenTerms::new(&[OgdenTerm { mu, alpha: -4.7 }])?;
            Law::Ogden(Ogden::new(terms, constants.bulk_modulus, term)?)
        }
        scene::Law::StVenantKirchhoff => Law::StVenantKirchhoff(StVenantKirchhoff::new(constants)),
        scene::Law::Linear => Law::LinearElastic(LinearElastic::new(constants)),
    };
    Ok(Material { density: scene.density, law })
}
