//! Problems that several studies pose: simple bodies with a recipe each.
#![allow(non_snake_case)]

use mtled::algebra::tensor::Vector3;
use mtled::geometry::Shape;
use mtled::geometry::selection::{Extent, Selector};
use mtled::material::{ElasticConstants, Law, Material, NeoHookeanLogJ};
use mtled::problem::{
    Amplitude, BackgroundGrid, Basis, Cloud, Dimension, Enforcement, EssentialCondition,
    GradientStorage, Gradients, InsideRule, Loads, MassRule, Motion, Prescribed, Problem, Recipe,
    Region, Relaxation, RelaxationMass, StepControl, VolumetricProjection, WeightFunction,
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

/// Lattice or jittered nodes, linear basis, 1.26 cells per spacing with
/// volume fractions, even mass split, collocation.
pub fn recipe(spacing: f64, jitter: f64, seed: u64) -> Recipe {
    let cloud = match jitter {
        0.0 => Cloud::Regular { spacing },
        jitter => Cloud::Jittered { spacing, jitter, seed },
    };
    Recipe {
        cloud,
        dilation: 1.8,
        basis: Basis::Linear,
        weight_function: WeightFunction::QuarticSpline,
        grid: grid(spacing / 1.26),
        mass: MassRule::EvenSplit,
        enforcement: Enforcement::Collocation,
        gradients: Gradients::Consistent { tolerance: 1e-12 },
        gradient_storage: GradientStorage::Double,
        volumetric_projection: VolumetricProjection::Patches,
    }
}

/// Cells of one edge \[m\] with one point each and volume fractions.
pub fn grid(cell: f64) -> BackgroundGrid {
    BackgroundGrid {
        cell,
        boundary_cell: None,
        refinements: Vec::new(),
        gauss_points: 1,
        inside: InsideRule::VolumeFraction,
    }
}

/// A free body of one material that is not pushed; static unless changed.
pub fn free_body(dimension: Dimension, body: Shape, material: Material, recipe: Recipe) -> Problem {
    let region = Region { name: "body".into(), part: Selector::All, material };
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

/// Moves all nodes of the block's face `axis` = `at` \[m\] by `by` \[m\] along
/// that axis and holds the other components.
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

/// Dynamic relaxation whose amplitudes run to 1 s.
pub fn relaxation(load_steps: usize, tolerance: f64) -> Motion {
    Motion::Static(Relaxation {
        load_end: 1.0,
        load_steps,
        tolerance,
        max_steps: 100_000,
        step: StepControl::default(),
        mass: RelaxationMass::default(),
    })
}

/// Random numbers that depend on the seed alone: SplitMix64 (Steele, Lea and
/// Flood 2014).
#[derive(Debug, Clone)]
pub struct Random(pub u64);

impl Random {
    /// Uniform in −1 ≤ r < 1.
    pub fn symmetric(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A vector of such numbers; z is 0 in a plane.
    pub fn vector(&mut self, components: usize) -> Vector3 {
        Vector3::from_fn(|k, _| if k < components { self.symmetric() } else { 0.0 })
    }
}
