//! What a solver is asked: a case with every default spelled out, at one resolution.

use super::conditions::{Contact, Loads, Support, loads, obstacles, supports};
use super::geometry::Shape;
use super::material::{Region, regions};
use super::version::PROTOCOL;
use crate::scene::format::{DimensionFormat, Triple};
use crate::scene::{Case, Diagnostic, ProbeKind, tables};
use mtled::problem::{Motion, defaults};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A job of the solver protocol of mtled: one problem of solid mechanics at one resolution. SI
/// units; keys that end in _m, _s, _pa, _rad … have these. Every key is always there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "Job of the solver protocol")]
pub struct Job {
    /// Version of the protocol, 1.
    pub protocol: u32,
    /// Name of the case.
    pub case: String,
    /// What is solved, in a few sentences.
    pub description: String,
    /// The wanted distance of neighbouring nodes; where the body needs smaller elements
    /// somewhere is left to the solver.
    pub spacing_m: f64,
    /// Number of this resolution, from 0, the coarsest.
    pub level: usize,
    /// Number of resolutions.
    pub levels: usize,
    /// The program is killed after this time on the clock.
    pub time_limit_s: f64,
    /// Threads that it may use.
    pub threads: usize,
    /// The same problem as a case file of mtled (TOML), for programs that read these.
    pub case_file: PathBuf,
    pub problem: Problem,
    /// Where displacements are wanted.
    pub probes: Vec<Probe>,
    /// Instants at which every quantity is wanted; in a static problem the end of loading.
    pub instants_s: Vec<f64>,
    /// Moments of reactions are taken about this point.
    pub moment_about_m: Triple,
}

/// What is solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Problem {
    pub dimension: DimensionFormat,
    /// Of a problem in plane strain: forces, energies and masses belong to a slab of this
    /// thickness, and positions have this z. Null in three dimensions.
    pub plane: Option<Plane>,
    /// The body that deforms.
    pub body: Shape,
    /// Its materials; the first region that contains a point owns it.
    pub regions: Vec<Region>,
    /// Prescribed displacements. Where two prescribe a component, the reaction counts with the
    /// first.
    pub supports: Vec<Support>,
    pub loads: Loads,
    /// Contact with rigid obstacles.
    pub obstacles: Vec<Contact>,
    pub motion: JobMotion,
}

/// The slab of a problem in plane strain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Plane {
    pub thickness_m: f64,
    pub z_m: f64,
}

/// Equilibrium, or motion in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum JobMotion {
    /// The equilibrium under the loads of this time, reached from rest as they grow.
    Static { load_end_s: f64 },
    /// ρ ü + damping ρ u̇ = div P + loads, from rest or the initial velocities.
    Dynamic { end_s: f64, damping_per_s: f64 },
}

/// Where displacements are wanted: positions, or a centre of mass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Probe {
    /// The displacement at each of these reference positions.
    Positions { name: String, positions_m: Vec<Triple> },
    /// The displacement of the centre of mass of a region, one triple.
    CentreOfMass { name: String, region: String },
}

/// At which resolution a job is solved, and in what time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// Distance of neighbouring nodes \[m\].
    pub spacing_m: f64,
    /// Its number, from 0, the coarsest.
    pub level: usize,
    /// Number of resolutions.
    pub levels: usize,
    /// On the clock \[s\].
    pub time_limit_s: f64,
}

impl Job {
    /// A job for a case in whose text names of other files are absolute, and which is stored in
    /// `case_file`.
    pub fn new(
        case: &Case,
        case_file: &Path,
        resolution: Resolution,
        instants_s: &[f64],
    ) -> Result<Job, Diagnostic> {
        let format = tables(case)?;
        let Resolution { spacing_m, level, levels, time_limit_s } = resolution;
        let tolerance_m = defaults::SELECTION_TOLERANCE * spacing_m;
        let plane = format.plane.as_ref();
        let problem = Problem {
            dimension: format.dimension,
            plane: plane.map(|plane| Plane { thickness_m: plane.thickness, z_m: plane.z }),
            body: (&format.geometry.shape).into(),
            regions: regions(&format, case, tolerance_m, instants_s),
            supports: supports(&format, case, tolerance_m, instants_s),
            loads: loads(&format, case, tolerance_m, instants_s),
            obstacles: obstacles(&format, case, instants_s),
            motion: match &case.problem.motion {
                Motion::Dynamic { end, damping, .. } => {
                    JobMotion::Dynamic { end_s: *end, damping_per_s: *damping }
                }
                motion => JobMotion::Static { load_end_s: motion.end() },
            },
        };
        Ok(Job {
            protocol: PROTOCOL,
            case: case.name.clone(),
            description: case.description.clone(),
            spacing_m,
            level,
            levels,
            time_limit_s,
            threads: 1,
            case_file: case_file.to_path_buf(),
            problem,
            probes: case.probes.iter().map(probe).collect(),
            instants_s: instants_s.to_vec(),
            moment_about_m: case.outputs.moment_about.into(),
        })
    }
}

fn probe(probe: &crate::scene::Probe) -> Probe {
    let name = probe.name.clone();
    match &probe.kind {
        ProbeKind::CentreOfMass { region } => Probe::CentreOfMass { name, region: region.clone() },
        kind => {
            let positions_m = kind.positions().into_iter().map(Into::into).collect();
            Probe::Positions { name, positions_m }
        }
    }
}
