//! Simple bodies, their material, recipe and conditions, as several studies use them.
#![allow(non_snake_case)]

use mtled::algebra::tensor::Vector3;
use mtled::geometry::{Extent, Selector, Shape};
use mtled::material::{ElasticConstants, Law, Material, NeoHookeanLogJ};
use mtled::problem::{
    Amplitude, Cloud, Dimension, EssentialCondition, Loads, MassRule, Motion, Prescribed, Problem,
    Recipe, Region, Relaxation, defaults,
};

/// Plane strain in a slab of 1 m.
pub const PLANE: Dimension = Dimension::PlaneStrain { thickness: 1.0, z: 0.0 };

/// Edge of the cube and the square, diameter of the sphere \[m\].
pub const SIZE: f64 = 0.1;

/// The cube [0, SIZE]³, or its cross-section in a plane.
pub fn block_shape() -> Shape {
    Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(SIZE) }
}

/// The sphere inside that cube.
pub fn sphere_shape() -> Shape {
    Shape::Sphere { centre: Vector3::repeat(0.5 * SIZE), radius: 0.5 * SIZE }
}

/// Soft tissue: log-J neo-Hookean, E = 3 kPa, 1000 kg/m³.
pub fn tissue(poisson_ratio: f64) -> anyhow::Result<Material> {
    let constants = ElasticConstants::from_young_poisson(3000.0, poisson_ratio)?;
    Ok(Material { density: 1000.0, law: Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants)) })
}

/// The recommended recipe on a lattice or jittered nodes, but with masses split evenly and
/// gradients consistent to round-off.
pub fn recipe(spacing: f64, jitter: f64, seed: u64) -> Recipe {
    let cloud = match jitter {
        0.0 => Cloud::Regular { spacing },
        jitter => Cloud::Jittered { spacing, jitter, seed },
    };
    Recipe {
        cloud,
        mass: MassRule::EvenSplit,
        gradients: defaults::GRADIENTS.with_tolerance(1e-12),
        ..Recipe::with_spacing(spacing)
    }
}

/// An unloaded, unconstrained body of one material; its motion is a dynamic relaxation.
pub fn free_body(dimension: Dimension, body: Shape, material: Material, recipe: Recipe) -> Problem {
    let region = Region::new("body", Selector::All, material);
    Problem {
        dimension,
        body,
        regions: vec![region],
        recipe,
        conditions: Vec::new(),
        loads: Loads::default(),
        obstacles: Vec::new(),
        motion: relaxation(200, 1e-6),
    }
}

/// Prescribes all components on the block's face `axis` = `at` \[m\]: `by` \[m\] along that
/// axis, 0 along the others.
pub fn bonded_face(axis: usize, at: f64, by: f64, amplitude: Amplitude) -> EssentialCondition {
    let mut normal = Vector3::zeros();
    normal[axis] = 1.0;
    let mut displacement = [Some(0.0); 3];
    displacement[axis] = Some(by);
    EssentialCondition {
        name: format!("face at {at} m"),
        extent: Extent::Surface,
        part: Selector::Plane { point: normal * at, normal, tolerance: 1e-9 },
        prescribed: Prescribed::Displacement(displacement),
        amplitude,
        release: None,
    }
}

/// Dynamic relaxation under loads that grow over 1 s in `load_steps` steps.
pub fn relaxation(load_steps: usize, tolerance: f64) -> Motion {
    Motion::Relaxed(Relaxation {
        load_steps,
        tolerance,
        max_steps: 100_000,
        ..Relaxation::default()
    })
}
