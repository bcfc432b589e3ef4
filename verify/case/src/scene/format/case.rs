//! Tables of the whole case, its body and its regions.

use crate::scene::format::choice::choice;
use crate::scene::format::conditions::{
    BodyForceFormat, CavityFormat, InitialVelocityFormat, ObstacleFormat, PrescribeFormat,
    PressureFormat, SpringFormat, TractionFormat,
};
use crate::scene::format::geometry::{SelectorFormat, ShapeFormat};
use crate::scene::format::material::MaterialFormat;
use crate::scene::format::recipe::DiscretisationFormat;
use crate::scene::format::time::{OutputFormat, ProbeFormat, TimeFormat};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One problem of solid mechanics for the meshless solver mtled. Lengths in m,
/// masses in kg, times in s, stresses in Pa, angles in rad.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
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
    /// The slice of a plane-strain problem; left out in three dimensions.
    pub plane: Option<PlaneFormat>,
    pub geometry: GeometryFormat,
    /// Parts of the body, the first that contains a point owns it; may be left
    /// out where there is one material.
    #[serde(default)]
    pub region: Vec<RegionFormat>,
    /// Materials by name.
    pub material: BTreeMap<String, MaterialFormat>,
    pub discretisation: DiscretisationFormat,
    /// Prescribed displacements; none if left out.
    #[serde(default)]
    pub prescribe: Vec<PrescribeFormat>,
    /// Forces per mass on the body or parts of it; none if left out.
    #[serde(default)]
    pub body_force: Vec<BodyForceFormat>,
    /// Dead tractions on parts of the boundary; none if left out.
    #[serde(default)]
    pub traction: Vec<TractionFormat>,
    /// Pressures that follow the deformed surface; none if left out.
    #[serde(default)]
    pub pressure: Vec<PressureFormat>,
    /// Elastic beds of parts of the boundary; none if left out.
    #[serde(default)]
    pub spring: Vec<SpringFormat>,
    /// Cavities whose volume is recorded, and the fluids that fill them; none if left out.
    #[serde(default)]
    pub cavity: Vec<CavityFormat>,
    /// Velocities at t = 0; the first part that contains a node counts; zero if left out.
    #[serde(default)]
    pub initial_velocity: Vec<InitialVelocityFormat>,
    /// Rigid obstacles that nodes may not enter; none if left out.
    #[serde(default)]
    pub obstacle: Vec<ObstacleFormat>,
    pub time: TimeFormat,
    /// Where displacements are recorded; nowhere if left out.
    #[serde(default)]
    pub probe: Vec<ProbeFormat>,
    /// What is written; with the defaults of its keys if left out.
    #[serde(default)]
    pub output: OutputFormat,
}

choice! {
    /// Three dimensions, or a plane-strain slice.
    #[derive(Default)]
    DimensionFormat {
        #[default]
        "3d" Three,
        "plane_strain" PlaneStrain,
    }
}

/// The slice of a plane-strain problem.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneFormat {
    /// Thickness of the slab that volumes, masses and forces belong to [m].
    pub thickness: f64,
    /// Where the cross-section is taken [m].
    pub z: f64,
}

/// The solid that deforms.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GeometryFormat {
    /// Its shape at rest.
    pub shape: ShapeFormat,
}

/// A part of the body made of one material.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionFormat {
    /// Its name in results and for probes.
    pub name: String,
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// Name of a `[material.NAME]` table.
    pub material: String,
}
