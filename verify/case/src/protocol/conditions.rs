//! Prescribed displacements, loads and obstacles in a job.

use super::geometry::{Selection, Shape};
use crate::scene::Case;
use crate::scene::format::{
    BeyondFormat, CaseFormat, CavityFormat, ExtentFormat, FormulaFormat, FrictionFormat,
    ObstacleFormat, PrescribeFormat, SelectorFormat, SideFormat, SpringFormat, Triple, UnitFormat,
    VectorFrameFormat,
};
use mtled::problem::{Amplitude, Obstacle, RigidMotion, RigidWay};
use mtled_io::files::image::is_image;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A prescribed displacement: `motion` times the factor of each instant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Support {
    pub name: String,
    /// Whether it acts on the boundary of the body only or everywhere in the selection.
    pub of: ExtentFormat,
    #[serde(rename = "where")]
    pub part: Selection,
    pub motion: SupportMotion,
    pub history: History,
    /// It acts before this time only; for ever where it is null.
    pub release_s: Option<f64>,
}

/// A displacement at factor 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum SupportMotion {
    /// The same everywhere; a component that is null is free.
    Displacement { x_m: Option<f64>, y_m: Option<f64>, z_m: Option<f64> },
    /// About an axis through a point; the factor multiplies the angle.
    Rotation { point_m: Triple, axis: Triple, angle_rad: f64 },
    /// Formulas of the reference position x, y, z [m] in + - * / ^, parentheses, sqrt, exp, ln,
    /// sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, abs and PI, each times `scale_m`.
    Formula { x: String, y: String, z: String, scale_m: f64 },
    /// At scattered points in a file (CSV, NPY, VTU, or an image of vectors along `frame`); between
    /// them the linear function counts that fits the nearest 16 best. Points of the body that are farther than `reach_m` are an
    /// error or free.
    Data {
        file: PathBuf,
        unit: Option<UnitFormat>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        frame: Option<VectorFrameFormat>,
        field: String,
        reach_m: f64,
        free_beyond: bool,
        scale: f64,
    },
}

/// A factor over time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct History {
    pub amplitude: JobAmplitude,
    /// Its value at each instant of the job.
    pub factors: Vec<f64>,
}

/// The formula of a factor over time t.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum JobAmplitude {
    /// 1 from the start.
    Constant,
    /// From 0 to 1 in a straight line, then 1.
    Linear { duration_s: f64 },
    /// 10s³ − 15s⁴ + 6s⁵ with s = t/duration, then 1.
    Smooth { duration_s: f64 },
    /// Straight lines through rows of time [s] and factor, constant outside.
    Table { rows: Vec<[f64; 2]> },
}

/// Forces and initial velocities.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Loads {
    pub body_forces: Vec<BodyForce>,
    pub tractions: Vec<Traction>,
    pub pressures: Vec<Pressure>,
    /// None if left out.
    #[serde(default)]
    pub springs: Vec<Spring>,
    /// None if left out.
    #[serde(default)]
    pub cavities: Vec<Cavity>,
    pub initial_velocities: Vec<InitialVelocity>,
}

/// A force per mass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BodyForce {
    #[serde(rename = "where")]
    pub part: Selection,
    /// At factor 1.
    pub acceleration_m_per_s2: Option<Triple>,
    /// The same as formulas, where it is not uniform.
    #[serde(default)]
    pub formula: Option<Formula>,
    pub history: History,
}

/// A dead traction on a part of the boundary, per reference area.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Traction {
    pub name: String,
    #[serde(rename = "where")]
    pub part: Selection,
    /// At factor 1.
    pub traction_pa: Option<Triple>,
    /// The same as formulas, where it is not uniform.
    #[serde(default)]
    pub formula: Option<Formula>,
    pub history: History,
}

/// A pressure on the deformed surface along its inward normal, per deformed area.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Pressure {
    pub name: String,
    #[serde(rename = "where")]
    pub part: Selection,
    /// At factor 1, positive where it presses on the body.
    pub pressure_pa: f64,
    pub history: History,
}

/// Springs between each point of a part of the boundary and where it was, per reference area.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Spring {
    pub name: String,
    #[serde(rename = "where")]
    pub part: Selection,
    /// Along the normal at rest.
    pub normal_pa_per_m: f64,
    /// Along the surface.
    pub tangential_pa_per_m: f64,
}

/// A part of the boundary that encloses a volume.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cavity {
    pub name: String,
    #[serde(rename = "where")]
    pub part: Selection,
    /// A point of the plane of its opening, where it has one.
    pub opening_m: Option<Triple>,
    /// What fills it, where its volume is not only recorded.
    pub fluid: Option<Fluid>,
}

impl Spring {
    fn new(row: &SpringFormat, tolerance_m: f64) -> Spring {
        Spring {
            name: row.name.clone(),
            part: Selection::new(&row.part, tolerance_m),
            normal_pa_per_m: row.normal,
            tangential_pa_per_m: row.tangential,
        }
    }
}

impl Cavity {
    fn new(
        row: &CavityFormat,
        known: &mtled::problem::Cavity,
        tolerance_m: f64,
        instants: &[f64],
    ) -> Cavity {
        Cavity {
            name: row.name.clone(),
            part: Selection::new(&row.part, tolerance_m),
            opening_m: row.opening,
            fluid: known.fluid.as_ref().map(|fluid| Fluid {
                bulk_modulus_pa: fluid.bulk_modulus,
                inflow_m3: fluid.inflow,
                history: History::new(&fluid.amplitude, instants),
            }),
        }
    }
}

/// A fluid whose pressure is its bulk modulus times (V₀ + inflow − V)/V₀.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Fluid {
    pub bulk_modulus_pa: f64,
    /// At factor 1; in a plane to the cavity of the slab.
    pub inflow_m3: f64,
    pub history: History,
}

/// A velocity at t = 0; the first selection that contains a point counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InitialVelocity {
    #[serde(rename = "where")]
    pub part: Selection,
    pub velocity_m_per_s: Option<Triple>,
    /// The same as formulas, where it is not uniform.
    #[serde(default)]
    pub formula: Option<Formula>,
}

/// A vector, SI, as formulas of the reference position x, y, z [m], like those of a displacement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Formula {
    pub x: String,
    pub y: String,
    pub z: String,
    /// Multiplies all of them.
    pub factor: f64,
}

impl Formula {
    fn new(format: &FormulaFormat) -> Formula {
        let [x, y, z] = format.components();
        Formula { x, y, z, factor: format.factor }
    }
}

/// A rigid obstacle that the body may not enter: a shape grown by an offset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Contact {
    pub name: String,
    pub shape: Shape,
    pub offset_m: f64,
    pub side: SideFormat,
    pub friction: FrictionFormat,
    /// Its motions, one after the other in axes that stay; empty where it stands still.
    pub motions: Vec<ContactMotion>,
}

/// A displacement or a rotation of an obstacle times the factor of each instant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ContactMotion {
    pub motion: SupportMotion,
    pub history: History,
}

impl ContactMotion {
    fn new(known: &RigidMotion, instants: &[f64]) -> ContactMotion {
        let motion = match known.way {
            RigidWay::Translation(way) => {
                SupportMotion::Displacement { x_m: Some(way.x), y_m: Some(way.y), z_m: Some(way.z) }
            }
            RigidWay::Rotation { point, axis, angle } => SupportMotion::Rotation {
                point_m: point.into(),
                axis: axis.into(),
                angle_rad: angle,
            },
        };
        ContactMotion { motion, history: History::new(&known.amplitude, instants) }
    }
}

impl History {
    pub(super) fn new(amplitude: &Amplitude, instants: &[f64]) -> History {
        History {
            factors: instants.iter().map(|time| amplitude.at(*time)).collect(),
            amplitude: match amplitude {
                Amplitude::Constant => JobAmplitude::Constant,
                Amplitude::Linear { duration } => JobAmplitude::Linear { duration_s: *duration },
                Amplitude::Smooth { duration } => JobAmplitude::Smooth { duration_s: *duration },
                Amplitude::Table(rows) => {
                    JobAmplitude::Table { rows: rows.iter().map(|&(t, f)| [t, f]).collect() }
                }
            },
        }
    }
}

impl SupportMotion {
    fn new(row: &PrescribeFormat) -> Option<SupportMotion> {
        if let Some(free) = &row.displacement {
            return Some(SupportMotion::Displacement { x_m: free.x, y_m: free.y, z_m: free.z });
        }
        if let Some(rotation) = &row.rotation {
            let (point_m, axis) = (rotation.point, rotation.axis);
            return Some(SupportMotion::Rotation { point_m, axis, angle_rad: rotation.angle });
        }
        if let Some(formula) = &row.formula {
            let [x, y, z] = formula.components();
            return Some(SupportMotion::Formula { x, y, z, scale_m: formula.factor });
        }
        row.data.as_ref().map(|data| SupportMotion::Data {
            file: data.file.clone(),
            unit: data.unit.or((!is_image(&data.file)).then_some(UnitFormat::Metre)),
            frame: data.frame,
            field: data.field_name().to_string(),
            reach_m: data.reach,
            free_beyond: data.beyond == BeyondFormat::Free,
            scale: data.factor,
        })
    }
}

/// The supports of a sound case; `tolerance_m` is that of selections that state none.
pub fn supports(
    format: &CaseFormat,
    case: &Case,
    tolerance_m: f64,
    instants: &[f64],
) -> Vec<Support> {
    let pairs = format.prescribe.iter().zip(&case.problem.conditions);
    let support = |(row, known): (&PrescribeFormat, &mtled::problem::EssentialCondition)| {
        Some(Support {
            name: row.name.clone(),
            of: row.of,
            part: Selection::new(&row.part, tolerance_m),
            motion: SupportMotion::new(row)?,
            history: History::new(&known.amplitude, instants),
            release_s: row.release,
        })
    };
    pairs.filter_map(support).collect()
}

/// The loads of a sound case.
pub fn loads(format: &CaseFormat, case: &Case, tolerance_m: f64, instants: &[f64]) -> Loads {
    let known = &case.problem.loads;
    let part = |format: &SelectorFormat| Selection::new(format, tolerance_m);
    let history = |amplitude: &Amplitude| History::new(amplitude, instants);
    let body_forces = format.body_force.iter().zip(&known.body_forces);
    let tractions = format.traction.iter().zip(&known.tractions);
    let pressures = format.pressure.iter().zip(&known.pressures);
    Loads {
        body_forces: body_forces
            .map(|(row, known)| BodyForce {
                part: row.part.as_ref().map_or(Selection::All, part),
                acceleration_m_per_s2: row.acceleration,
                formula: row.formula.as_ref().map(Formula::new),
                history: history(&known.amplitude),
            })
            .collect(),
        tractions: tractions
            .map(|(row, known)| Traction {
                name: row.name.clone(),
                part: part(&row.part),
                traction_pa: row.traction,
                formula: row.formula.as_ref().map(Formula::new),
                history: history(&known.amplitude),
            })
            .collect(),
        pressures: pressures
            .map(|(row, known)| Pressure {
                name: row.name.clone(),
                part: part(&row.part),
                pressure_pa: row.pressure,
                history: history(&known.amplitude),
            })
            .collect(),
        springs: format.spring.iter().map(|row| Spring::new(row, tolerance_m)).collect(),
        cavities: (format.cavity.iter().zip(&known.cavities))
            .map(|(row, known)| Cavity::new(row, known, tolerance_m, instants))
            .collect(),
        initial_velocities: (format.initial_velocity.iter())
            .map(|row| InitialVelocity {
                part: part(&row.part),
                velocity_m_per_s: row.velocity,
                formula: row.formula.as_ref().map(Formula::new),
            })
            .collect(),
    }
}

/// The obstacles of a sound case.
pub fn obstacles(format: &CaseFormat, case: &Case, instants: &[f64]) -> Vec<Contact> {
    let pairs = format.obstacle.iter().zip(&case.problem.obstacles);
    let contact = |(row, known): (&ObstacleFormat, &Obstacle)| Contact {
        name: row.name.clone(),
        shape: (&row.shape).into(),
        offset_m: row.offset,
        side: row.side,
        friction: row.friction,
        motions: (known.motions.iter())
            .map(|motion| ContactMotion::new(motion, instants))
            .collect(),
    };
    pairs.map(contact).collect()
}
