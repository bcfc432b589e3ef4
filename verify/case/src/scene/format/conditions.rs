//! Prescribed displacements, loads and obstacles.

use crate::scene::format::choice::choice;
use crate::scene::format::geometry::{SelectorFormat, ShapeFormat, Triple, UnitFormat};
use mtled::geometry::Extent;
use mtled::problem::{Friction, ObstacleSide};
use mtled_io::files::image::VectorFrame;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A prescribed displacement: one of `displacement`, `rotation`, `formula` and `data`.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PrescribeFormat {
    /// Its name in results.
    pub name: String,
    /// Whether nodes are taken from the boundary only or from everywhere.
    pub of: ExtentFormat,
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// The same displacement everywhere; left out where another kind is given.
    pub displacement: Option<DisplacementFormat>,
    /// A rotation; left out where another kind is given.
    pub rotation: Option<RotationFormat>,
    /// A function of the position; left out where another kind is given.
    pub formula: Option<FormulaFormat>,
    /// Displacements from a file; left out where another kind is given.
    pub data: Option<DataFormat>,
    #[serde(default)]
    pub amplitude: AmplitudeFormat,
    /// Enforced before this time [s]; for ever if left out.
    pub release: Option<f64>,
}

choice! {
    /// Candidates of a selection.
    ExtentFormat for Extent {
        /// Nodes on the boundary of the body only.
        "surface" Surface,
        /// Every node of the body. Where all components are prescribed for ever and a ball of one
        /// spacing fits in, what is held ends at its border and does not deform: its motion costs no
        /// strain energy, and its weight stays in the reaction.
        "volume" Volume,
    }
}

/// A displacement at amplitude 1 [m]; a component that is left out is free.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DisplacementFormat {
    /// Component along x [m]; free if left out.
    pub x: Option<f64>,
    /// Component along y [m]; free if left out.
    pub y: Option<f64>,
    /// Component along z [m]; free if left out.
    pub z: Option<f64>,
}

/// A rotation about an axis; the amplitude multiplies the angle.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotationFormat {
    /// A point on the axis [m].
    pub point: Triple,
    /// Direction of the axis, of any length [–].
    pub axis: Triple,
    /// Angle at amplitude 1 [rad].
    pub angle: f64,
}

/// A vector as formulas of the reference position x, y, z [m], such
/// as "0.02*sin(PI*x/0.1)": + - * / ^, parentheses, sqrt, exp, ln, sin, cos, tan, asin, acos,
/// atan, sinh, cosh, tanh, abs, PI.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FormulaFormat {
    /// Component along x [m, m/s, m/s², Pa or –].
    pub x: String,
    /// Component along y [m, m/s, m/s², Pa or –].
    pub y: String,
    /// Component along z [m, m/s, m/s², Pa or –]; left out in plane strain only.
    pub z: Option<String>,
    /// Multiplies all of them [–].
    #[serde(default = "one")]
    pub factor: f64,
}

/// Displacements at amplitude 1 at scattered points, such as measured ones, or directions. Between
/// them the linear function counts that fits the nearest 16 best.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DataFormat {
    /// CSV with a header x, y, z, ux, uy, uz; NPY of shape (n, 6) in this order; VTU; or an image
    /// of vectors, NRRD with the components first or NIfTI with the components last, whose world is
    /// R, A, S.
    pub file: PathBuf,
    /// Unit of positions and displacements in the file; m if left out, in images what they state.
    pub unit: Option<UnitFormat>,
    /// What the vectors of an image are measured along; needed for NIfTI, which does not say it. If
    /// left out, what an NRRD file states: its measurement frame, or its space without one.
    pub frame: Option<VectorFrameFormat>,
    /// Name of the point data of a VTU file; "displacement" if left out.
    pub field: Option<String>,
    /// Largest distance of a node from the nearest point [m].
    pub reach: f64,
    /// What happens to selected nodes that are farther.
    #[serde(default)]
    pub beyond: BeyondFormat,
    /// Multiplies the displacements [–].
    #[serde(default = "one")]
    pub factor: f64,
}

fn one() -> f64 {
    1.0
}

impl DataFormat {
    /// Name of the point data of a VTU file.
    pub(crate) fn field_name(&self) -> &str {
        self.field.as_deref().unwrap_or("displacement")
    }
}

choice! {
    /// What the components of vectors in an image are measured along.
    VectorFrameFormat for VectorFrame {
        /// Right, anterior, superior.
        "ras" Ras,
        /// Left, posterior, superior, as ITK, ANTs and 3D Slicer write displacements.
        "lps" Lps,
        /// The voxels, as FSL's dtifit writes directions: the first index runs to the left.
        "fsl" Fsl,
    }
}

choice! {
    /// What happens to nodes that are too far from all data.
    #[derive(Default)]
    BeyondFormat {
        /// They are an error.
        #[default]
        "error" Error,
        /// They are not prescribed.
        "free" Free,
    }
}

/// A factor over time; constant if left out.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum AmplitudeFormat {
    /// 1 from the start.
    #[default]
    Constant,
    /// From 0 to 1 in a straight line, then 1.
    Linear {
        /// Time from 0 to 1 [s].
        duration: f64,
    },
    /// 10s³ − 15s⁴ + 6s⁵ with s = t/duration, then 1.
    Smooth {
        /// Time from 0 to 1 [s].
        duration: f64,
    },
    /// Straight lines through rows of time [s] and factor, constant outside.
    Table(Vec<(f64, f64)>),
}

/// A force per mass on the body.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyForceFormat {
    /// The part that it acts on, such as what lies above a fluid; everything if left out.
    #[serde(rename = "where")]
    pub part: Option<SelectorFormat>,
    /// Force per mass [m/s²]; left out where a formula is given.
    pub acceleration: Option<Triple>,
    /// The same as a function of the position [m/s²]; left out where it is uniform.
    pub formula: Option<FormulaFormat>,
    #[serde(default)]
    pub amplitude: AmplitudeFormat,
}

/// A traction of fixed direction on a part of the boundary.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TractionFormat {
    /// Its name in results.
    pub name: String,
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// Force per reference area [Pa]; left out where a formula is given.
    pub traction: Option<Triple>,
    /// The same as a function of the position [Pa]; left out where it is uniform.
    pub formula: Option<FormulaFormat>,
    #[serde(default)]
    pub amplitude: AmplitudeFormat,
}

/// A pressure on the deformed surface: along its inward normal, whatever way it turns.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressureFormat {
    /// Its name in results.
    pub name: String,
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// Force per deformed area [Pa], positive where it presses on the body.
    pub pressure: f64,
    #[serde(default)]
    pub amplitude: AmplitudeFormat,
}

/// Springs all over a part of the boundary, between each point and where it was: an elastic bed,
/// such as the tissue around an organ. One of the two stiffnesses is above 0.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpringFormat {
    /// Its name in results.
    pub name: String,
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// Force per reference area and displacement along the normal at rest [Pa/m].
    #[serde(default)]
    pub normal: f64,
    /// The same along the surface [Pa/m].
    #[serde(default)]
    pub tangential: f64,
}

/// A part of the boundary that encloses a volume, which is recorded, and what fills it.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CavityFormat {
    /// Its name in results.
    pub name: String,
    /// All of its surface, or all of it but an opening.
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// A point of the plane of its opening [m], near the rim, which stays in that plane, or of all the
    /// planes of symmetry that cut it; left out where the surface is closed. Nothing tells whether it lies
    /// in that plane: elsewhere it gives another volume.
    pub opening: Option<Triple>,
    /// A fluid that fills it; left out where its volume is only recorded.
    pub fluid: Option<FluidFormat>,
}

/// A fluid whose pressure is its bulk modulus times what it lacks in room over the volume of the cavity at
/// rest, (V₀ + inflow − V)/V₀. With an inflow a volume is prescribed, and the pressure is the answer.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FluidFormat {
    /// Bulk modulus [Pa]; 2.18e9, that of water, if left out. A motion takes steps that are the
    /// smaller the larger it is.
    #[serde(default = "water")]
    pub bulk_modulus: f64,
    /// Volume that is added [m³], in a plane to the cavity of the slab; negative where it is drawn off, none if
    /// left out.
    #[serde(default)]
    pub inflow: f64,
    #[serde(default)]
    pub amplitude: AmplitudeFormat,
}

fn water() -> f64 {
    mtled::problem::Fluid::WATER
}

/// A velocity at t = 0.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InitialVelocityFormat {
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// Its components [m/s]; left out where a formula is given.
    pub velocity: Option<Triple>,
    /// The same as a function of the position [m/s]; left out where it is uniform.
    pub formula: Option<FormulaFormat>,
}

/// A rigid obstacle.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObstacleFormat {
    /// Its name in results.
    pub name: String,
    /// The obstacle or, with side = "inside", the cavity.
    pub shape: ShapeFormat,
    /// The shape is grown by this much first [m].
    #[serde(default)]
    pub offset: f64,
    #[serde(default)]
    pub side: SideFormat,
    #[serde(default)]
    pub friction: FrictionFormat,
    /// How it moves, one motion after the other in axes that stay; left out where it stands still.
    #[serde(default)]
    pub motion: Vec<RigidMotionFormat>,
}

/// A motion of an obstacle: a displacement or a rotation.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RigidMotionFormat {
    /// Its way at amplitude 1 [m]; left out where a rotation is given.
    pub displacement: Option<Triple>,
    /// A rotation; left out where a displacement is given.
    pub rotation: Option<RotationFormat>,
    #[serde(default)]
    pub amplitude: AmplitudeFormat,
}

choice! {
    /// Where the body lives.
    #[derive(Default)]
    SideFormat for ObstacleSide {
        /// The shape is solid, the body stays outside.
        #[default]
        "outside" Outside,
        /// The shape is a cavity, the body stays inside.
        "inside" Inside,
    }
}

/// What happens along the surface of an obstacle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum FrictionFormat {
    /// Nodes slide freely.
    #[default]
    Frictionless,
    /// Nodes that touch do not slide.
    NoSlip,
    /// Coulomb's law: what acts along the surface is at most this coefficient [–] times what pushes.
    Coulomb(f64),
}

impl From<FrictionFormat> for Friction {
    fn from(format: FrictionFormat) -> Friction {
        match format {
            FrictionFormat::Frictionless => Friction::Frictionless,
            FrictionFormat::NoSlip => Friction::NoSlip,
            FrictionFormat::Coulomb(coefficient) => Friction::Coulomb(coefficient),
        }
    }
}
