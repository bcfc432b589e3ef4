//! The case file as it is written: TOML tables as plain structs, SI units.
//! Their doc comments are the descriptions of the JSON Schema.

pub mod geometry;
pub mod recipe;

use crate::scene::format::geometry::{SelectorFormat, ShapeFormat};
use crate::scene::format::recipe::DiscretisationFormat;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A vector in space: three numbers.
pub type Triple = [f64; 3];

/// One problem of solid mechanics for the meshless solver mtled. Lengths in m,
/// masses in kg, times in s, stresses in Pa, angles in rad.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "mtled case")]
pub struct CaseFormat {
    /// One line that names the problem.
    pub title: String,
    /// What is solved and why, in a few sentences.
    #[serde(default)]
    pub description: String,
    /// Where the problem and its reference values come from.
    #[serde(default)]
    pub source: String,
    #[serde(default)]
    pub dimension: DimensionFormat,
    /// The slice of a plane-strain problem; absent in three dimensions.
    pub plane: Option<PlaneFormat>,
    pub geometry: GeometryFormat,
    /// Parts of the body, the first that contains a point owns it. May be left
    /// out where there is one material.
    #[serde(default)]
    pub region: Vec<RegionFormat>,
    /// Materials by name.
    pub material: BTreeMap<String, MaterialFormat>,
    pub discretisation: DiscretisationFormat,
    /// Prescribed displacements.
    #[serde(default)]
    pub prescribe: Vec<PrescribeFormat>,
    /// Forces per mass on the whole body.
    #[serde(default)]
    pub body_force: Vec<BodyForceFormat>,
    /// Dead tractions on parts of the boundary.
    #[serde(default)]
    pub traction: Vec<TractionFormat>,
    /// Velocities at t = 0; the first part that contains a node counts.
    #[serde(default)]
    pub initial_velocity: Vec<InitialVelocityFormat>,
    /// Rigid obstacles that nodes may not enter.
    #[serde(default)]
    pub obstacle: Vec<ObstacleFormat>,
    pub time: TimeFormat,
    /// Where displacements are recorded.
    #[serde(default)]
    pub probe: Vec<ProbeFormat>,
    #[serde(default)]
    pub output: OutputFormat,
}

/// Three dimensions, or a plane-strain slice.
#[derive(Debug, Default, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
pub enum DimensionFormat {
    #[default]
    #[serde(rename = "3d")]
    Three,
    #[serde(rename = "plane_strain")]
    PlaneStrain,
}

/// The slice of a plane-strain problem.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneFormat {
    /// Thickness of the slab that volumes, masses and forces belong to [m].
    pub thickness: f64,
    /// Where the cross-section is taken [m].
    pub z: f64,
}

/// The solid that deforms.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GeometryFormat {
    pub shape: ShapeFormat,
}

/// A part of the body made of one material.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionFormat {
    pub name: String,
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// Name of a `[material.NAME]` table.
    pub material: String,
}

/// A constitutive law with its parameters: exactly one pair of elastic
/// constants, or A, B and poisson_ratio for mooney_rivlin.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialFormat {
    pub law: LawFormat,
    /// Per reference volume [kg/m³].
    pub density: f64,
    /// E [Pa], with poisson_ratio.
    pub young_modulus: Option<f64>,
    /// ν [–], -1 < ν < 0.5.
    pub poisson_ratio: Option<f64>,
    /// First Lamé modulus λ [Pa], with shear_modulus.
    pub lame_modulus: Option<f64>,
    /// μ [Pa], with lame_modulus or bulk_modulus.
    pub shear_modulus: Option<f64>,
    /// K [Pa], with shear_modulus.
    pub bulk_modulus: Option<f64>,
    /// Mooney-Rivlin A [Pa].
    #[serde(rename = "A")]
    pub a: Option<f64>,
    /// Mooney-Rivlin B [Pa].
    #[serde(rename = "B")]
    pub b: Option<f64>,
    /// Volumetric energy of neo_hookean_isochoric; quadratic if left out.
    pub volumetric: Option<VolumetricFormat>,
}

/// A constitutive law.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LawFormat {
    /// ψ = A(I−3) + B(II−3) + C(III⁻²−1) + D(III−1)².
    MooneyRivlin,
    /// ψ = μ/2 (I₁−3) − μ ln J + λ/2 (ln J)².
    NeoHookeanLogJ,
    /// ψ = μ/2 (J^(−2/3) I₁ − 3) + U(J).
    NeoHookeanIsochoric,
    /// ψ = λ/2 (tr E)² + μ E:E.
    StVenantKirchhoff,
    /// ψ = λ/2 (tr ε)² + μ ε:ε, small displacements only.
    LinearElastic,
}

/// Volumetric energy U(J) of neo_hookean_isochoric.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum VolumetricFormat {
    /// U = K/2 (J−1)².
    Quadratic,
    /// U = K/4 (J² − 1 − 2 ln J).
    SimoTaylor,
}

/// A prescribed displacement: `displacement` or `rotation`, not both.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PrescribeFormat {
    pub name: String,
    /// Whether nodes are taken from the boundary only or from everywhere.
    pub of: ExtentFormat,
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    pub displacement: Option<DisplacementFormat>,
    pub rotation: Option<RotationFormat>,
    #[serde(default)]
    pub amplitude: AmplitudeFormat,
    /// Enforced before this time [s]; for ever if left out.
    pub release: Option<f64>,
}

/// Candidates of a selection.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExtentFormat {
    /// Nodes on the boundary of the body only.
    Surface,
    /// Every node of the body.
    Volume,
}

/// A displacement at amplitude 1 [m]; a component that is left out is free.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DisplacementFormat {
    pub x: Option<f64>,
    pub y: Option<f64>,
    pub z: Option<f64>,
}

/// A rotation about an axis; the amplitude multiplies the angle.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotationFormat {
    /// A point on the axis [m].
    pub point: Triple,
    /// Direction of the axis, of any length.
    pub axis: Triple,
    /// Angle at amplitude 1 [rad].
    pub angle: f64,
}

/// A factor over time; constant if left out.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum AmplitudeFormat {
    /// 1 from the start.
    #[default]
    Constant,
    /// From 0 to 1 in a straight line, then 1.
    Linear {
        /// [s]
        duration: f64,
    },
    /// 10s³ − 15s⁴ + 6s⁵ with s = t/duration, then 1.
    Smooth {
        /// [s]
        duration: f64,
    },
    /// Straight lines through rows of time [s] and factor, constant outside.
    Table(Vec<(f64, f64)>),
}

/// A force per mass on the whole body.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyForceFormat {
    /// [m/s²]
    pub acceleration: Triple,
    #[serde(default)]
    pub amplitude: AmplitudeFormat,
}

/// A traction of fixed direction on a part of the boundary.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TractionFormat {
    pub name: String,
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// Force per reference area [Pa].
    pub traction: Triple,
    #[serde(default)]
    pub amplitude: AmplitudeFormat,
}

/// A velocity at t = 0.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InitialVelocityFormat {
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// [m/s]
    pub velocity: Triple,
}

/// A rigid obstacle.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObstacleFormat {
    pub name: String,
    pub shape: ShapeFormat,
    /// The shape is grown by this much first [m].
    #[serde(default)]
    pub offset: f64,
    #[serde(default)]
    pub side: SideFormat,
    #[serde(default)]
    pub friction: FrictionFormat,
}

/// Where the body lives.
#[derive(Debug, Default, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SideFormat {
    /// The shape is solid, the body stays outside.
    #[default]
    Outside,
    /// The shape is a cavity, the body stays inside.
    Inside,
}

/// What happens along the surface of an obstacle.
#[derive(Debug, Default, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FrictionFormat {
    /// Nodes slide freely.
    #[default]
    Frictionless,
    /// Nodes that touch do not slide.
    NoSlip,
}

/// How the body moves. `end`, `damping` and `mass_scaling` belong to method "dynamic";
/// `solver`, `load_end`, `load_steps`, `tolerance` and `max_steps` to "static".
/// Newton's method takes `load_end` and `tolerance` only.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimeFormat {
    pub method: MethodFormat,
    /// How a static solution is found; by relaxation if left out.
    pub solver: Option<SolverFormat>,
    /// Simulated time of a dynamic run [s].
    pub end: Option<f64>,
    /// Mass-proportional damping [1/s]; 0 if left out.
    pub damping: Option<f64>,
    /// Step over the critical step [–], in (0, 1]; 0.94 if left out, 0.8 for
    /// motion without damping.
    pub safety_factor: Option<f64>,
    /// The critical step is found again after this many steps at the latest.
    pub reevaluate_every: Option<usize>,
    /// Factor by which heavier nodes lengthen the critical step of a slow
    /// dynamic run [–]; refused if it takes more than 10 % of the body's mass.
    pub mass_scaling: Option<f64>,
    /// A step to be used instead [s]; refused if it is not stable.
    pub fixed_step: Option<f64>,
    /// Amplitudes run up to this time [s] in a static run; 1 if left out.
    pub load_end: Option<f64>,
    /// Steps over which the load is applied.
    pub load_steps: Option<usize>,
    /// Wanted relative error of the largest displacement [–], 1e-4 if left
    /// out; of solver "newton" the largest unbalanced nodal force over the
    /// largest nodal force, 1e-10 if left out.
    pub tolerance: Option<f64>,
    /// A static run that needs more steps has failed.
    pub max_steps: Option<usize>,
}

/// Central differences in time, or a static solution.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MethodFormat {
    Dynamic,
    Static,
}

/// The way to a static solution.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SolverFormat {
    /// Damped explicit motion until it rests; with contact too.
    Relaxation,
    /// Newton's method with conjugate gradients, to round-off; no contact.
    Newton,
}

/// Where displacements are recorded: one of `point`, `lattice`,
/// `centre_of_mass`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProbeFormat {
    pub name: String,
    /// A reference position [m].
    pub point: Option<Triple>,
    pub lattice: Option<LatticeFormat>,
    /// Name of a region.
    pub centre_of_mass: Option<String>,
}

/// Equally spaced reference positions, ends included.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LatticeFormat {
    /// [m]
    pub min: Triple,
    /// [m]
    pub max: Triple,
    /// Positions along x, y and z.
    pub counts: [usize; 3],
}

/// What is written.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputFormat {
    /// Number of VTU frames; 20 if left out. A static run that ends early has
    /// fewer, and solver "newton" one for each part of the load.
    pub frames: Option<usize>,
    /// Number of samples of histories; 200 if left out.
    pub history: Option<usize>,
    /// Moments of reactions are taken about this point [m]; the origin if left out.
    pub moment_about: Option<Triple>,
}
