//! Bodies, materials and conditions of the hard cases.
#![allow(non_snake_case)]

use mtled::algebra::random::Random;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::nodes::node_cloud;
use mtled::geometry::{Extent, Selector, Shape};
use mtled::material::{
    ElasticConstants, Law, Material, MooneyRivlin, NeoHookeanIsochoric, VolumetricTerm,
};
use mtled::problem::{
    Amplitude, Cloud, Dimension, EssentialCondition, Motion, Prescribed, Problem, Recipe,
};
use mtled_run::specimens::simple::{SIZE, free_body, recipe, relaxation};

/// Angle by which outlines are rotated about the vertical, so that no cell of the background grid fits
/// \[rad\].
pub(crate) const TURN: f64 = 0.35;
/// Jitter of all clouds \[spacing\].
const JITTER: f64 = 0.3;
/// Amplitude of all prescribed motion.
pub(crate) const SMOOTH: Amplitude = Amplitude::Smooth { duration: 1.0 };

/// A point of the x–y plane rotated about the origin \[m\].
pub(crate) fn turn(p: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = TURN.sin_cos();
    [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1]]
}

/// The rotated square of edge `width` \[m\] about the origin.
pub(crate) fn square(width: f64) -> [[f64; 2]; 4] {
    let a = 0.5 * width;
    [[-a, -a], [a, -a], [a, a], [-a, a]].map(turn)
}

/// A rotated square prism on the plane z = 0, `height` \[m\] high.
pub(crate) fn prism(width: f64, height: f64) -> Shape {
    Shape::Polygon { points: square(width).to_vec().into(), z: (0.0, height) }
}

/// Brain tissue of Horton 2007: Mooney–Rivlin, A = 1052 Pa, B = 0, ν = 0.49.
pub(crate) fn rubber() -> anyhow::Result<Material> {
    let law = Law::MooneyRivlin(MooneyRivlin::new(1052.0, 0.0, 0.49)?);
    Ok(Material { density: 1000.0, law })
}

/// Isochoric neo-Hookean law of Young's modulus E \[Pa\], ν = 0.49, 1000 kg/m³.
pub(crate) fn nearly_incompressible(young_modulus: f64) -> anyhow::Result<Material> {
    let constants = ElasticConstants::from_young_poisson(young_modulus, 0.49)?;
    let law = NeoHookeanIsochoric::new(constants, VolumetricTerm::SimoTaylor);
    Ok(Material { density: 1000.0, law: Law::NeoHookeanIsochoric(law) })
}

/// The recipe of the hard cases: jittered nodes, gradients consistent to round-off.
pub(crate) fn hard_recipe(spacing: f64, seed: u64) -> Recipe {
    recipe(spacing, JITTER, seed)
}

/// The rotated cube of one material, unconstrained.
pub(crate) fn cube(material: Material, spacing: f64) -> Problem {
    free_body(Dimension::Three, prism(SIZE, SIZE), material, hard_recipe(spacing, 5))
}

/// Prescribes components of the displacement \[m\] of the face z = `at` \[m\].
pub(crate) fn face(
    at: f64,
    displacement: [Option<f64>; 3],
    amplitude: Amplitude,
) -> EssentialCondition {
    prescribed(at, Prescribed::Displacement(displacement), amplitude)
}

/// Prescribes the motion of the face z = `at` \[m\].
pub(crate) fn prescribed(
    at: f64,
    prescribed: Prescribed,
    amplitude: Amplitude,
) -> EssentialCondition {
    let plane =
        Selector::Plane { point: Vector3::z() * at, normal: Vector3::z(), tolerance: 1e-6 * SIZE };
    EssentialCondition {
        name: format!("face at {at} m"),
        extent: Extent::Surface,
        part: plane,
        prescribed,
        amplitude,
        release: None,
    }
}

/// Both ends of a body of `height` \[m\] on rollers, the upper one moved by
/// `by` \[m\].
pub(crate) fn on_rollers(height: f64, by: f64) -> Vec<EssentialCondition> {
    let bottom = face(0.0, [None, None, Some(0.0)], Amplitude::Constant);
    vec![bottom, face(height, [None, None, Some(by)], SMOOTH)]
}

/// Both ends bonded, the upper one moved by `by` \[m\].
pub(crate) fn bonded(height: f64, by: f64) -> Vec<EssentialCondition> {
    let bottom = face(0.0, [Some(0.0); 3], Amplitude::Constant);
    vec![bottom, face(height, [Some(0.0), Some(0.0), Some(by)], SMOOTH)]
}

/// Dynamic relaxation to a tolerance \[–\], the load in `load_steps` steps.
pub(crate) fn relax(tolerance: f64, load_steps: usize) -> Motion {
    let mut motion = relaxation(load_steps, tolerance);
    if let Some(settings) = motion.relaxation_mut() {
        settings.max_steps = 50_000;
    }
    motion
}

/// As [`relax`], with load steps for an elongation by a fraction of the height.
pub(crate) fn relax_elongation(tolerance: f64, fraction: f64) -> Motion {
    let load_steps = match fraction.abs() {
        small if small <= 0.2 => 600,
        large if large <= 0.5 => 1000,
        _ => 2000,
    };
    relax(tolerance, load_steps)
}

/// Removes a fraction of the nodes of a problem at random, but not the corners of the prism: without
/// them the conditions would end before the faces do.
pub(crate) fn remove_nodes(problem: &mut Problem, fraction: f64, seed: u64) -> anyhow::Result<()> {
    let cloud = node_cloud(&problem.body, &problem.recipe.cloud, &problem.dimension)?;
    let mut random = Random(seed);
    let is_corner = |X: &Vector3| {
        let beside = |p: [f64; 2]| (X.x - p[0]).hypot(X.y - p[1]) < 1e-6 * SIZE;
        square(SIZE).into_iter().any(beside) && (X.z == 0.0 || X.z == SIZE)
    };
    let kept = |X: &Vector3| 0.5 * (random.symmetric() + 1.0) >= fraction || is_corner(X);
    let nodes = cloud.positions.into_iter().filter(kept).collect();
    problem.recipe.cloud = Cloud::Given { nodes };
    Ok(())
}
