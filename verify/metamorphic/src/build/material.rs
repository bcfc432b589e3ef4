//! Materials.
#![allow(non_snake_case)]

use super::conditions::{duration, ramp};
use super::frame::Frame;
use crate::scene::{self, Memory, Scene};
use anyhow::Result;
use mtled::Vector3;
use mtled::geometry::Selector;
use mtled::material::{
    ElasticConstants, Guccione, HolzapfelOgden, Isochoric, Law, LinearElastic, Material,
    MooneyRivlin, NeoHookeanIsochoric, NeoHookeanLogJ, Ogden, OgdenTerm, OgdenTerms, PronySeries,
    PronyTerm, ShapeEnergy, StVenantKirchhoff, VolumetricTerm,
};
use mtled::problem::{ActiveStress, Fibres, Field, Region};

/// The fibres of a scene in a frame: they turn along x, and rise a little; sheets lie askew.
fn fibres(scene: &Scene, frame: &Frame) -> Option<Fibres> {
    let frame = *frame;
    let fibre = move |X: &Vector3| {
        let (sine, cosine) = (2.0 * frame.home_of(X).x).sin_cos();
        frame.direction(&Vector3::new(cosine, sine, 0.3))
    };
    let sheet = frame.direction(&Vector3::new(-0.4, 0.3, 1.0));
    let fibres = || Fibres { fibre: Field::of(fibre), sheet: Some(sheet.into()) };
    (scene.law.has_fibres() || scene.tension.is_some()).then(fibres)
}

/// A region with the material of a scene, `stiffness` times as stiff, its fibres, memory and
/// tension.
pub(crate) fn region(
    scene: &Scene,
    frame: &Frame,
    name: &str,
    part: Selector,
    stiffness: f64,
) -> Result<Region> {
    let term = |memory: Memory| {
        let tau = memory.time * duration(scene);
        PronySeries::new(&[PronyTerm { g: memory.part, tau }])
    };
    let active = |tension: f64| ActiveStress {
        tension: scene.young_modulus * tension,
        amplitude: ramp(scene),
    };
    Ok(Region {
        fibres: fibres(scene, frame),
        viscosity: scene.memory.map(term).transpose()?,
        active: scene.tension.map(active),
        ..Region::new(name, part, material(scene, stiffness, 1.0)?)
    })
}

/// The materials of the regions of a scene when all has relaxed that does.
pub(crate) fn relaxed_materials(scene: &Scene) -> Result<Vec<Material>> {
    let left = scene.memory.map_or(1.0, |memory| 1.0 - memory.part);
    let half = scene.inclusion.map(|inclusion| inclusion.stiffness);
    half.into_iter().chain([1.0]).map(|stiffness| material(scene, stiffness, left)).collect()
}

/// The material of a scene, `stiffness` times as stiff, with what is `left` of its shear modulus.
fn material(scene: &Scene, stiffness: f64, left: f64) -> Result<Material> {
    let young = stiffness * scene.young_modulus;
    let constants = ElasticConstants::from_young_poisson(young, scene.poisson_ratio)?;
    let mu = left * constants.shear_modulus;
    let constants = match left {
        1.0 => constants,
        _ => ElasticConstants::from_shear_bulk(mu, constants.bulk_modulus)?,
    };
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
        scene::Law::Muscle => {
            let shape = Guccione::new(&[0.25 * mu, 8.0, 2.0, 4.0])?;
            Law::Guccione(Isochoric::new(shape, constants.bulk_modulus, term)?)
        }
        scene::Law::Sheets => {
            let [a, fibre, sheet, shear] = [0.4, 0.3, 0.1, 0.1].map(|part| part * mu);
            let shape = HolzapfelOgden::new(&[a, 2.0, fibre, 4.0, sheet, 3.0, shear, 2.0])?;
            Law::HolzapfelOgden(Isochoric::new(shape, constants.bulk_modulus, term)?)
        }
    };
    Ok(Material { density: scene.density, law })
}
