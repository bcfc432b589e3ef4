//! What a solver is asked: a case at one resolution, in the words of case files.

use super::material::{InNumbers, materials};
use super::version::PROTOCOL;
use crate::scene::format::{CaseFormat, RegionFormat, SelectorFormat, Triple};
use crate::scene::{Case, Diagnostic, ProbeKind, tables};
use mtled::problem::{Amplitude, Loads, Problem, defaults};
use schemars::JsonSchema;
use serde::ser::Error;
use serde::{Deserialize, Serialize, Serializer};
use serde_json::Value;
use std::collections::BTreeMap;

/// A job of the solver protocol of mtled: one problem of solid mechanics at one resolution, SI
/// units throughout; keys that end in _m, _s, _pa … have these.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "Job of the solver protocol")]
pub struct Job {
    /// Version of the protocol, 1.
    pub protocol: u32,
    /// Name of the case.
    pub case: String,
    /// The requested distance of neighbouring nodes; where the body needs smaller elements
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
    /// The case: the tables of a case file, with absolute names of other files and at least one
    /// region. `discretisation` is the recipe of mtled, which other programs leave alone.
    #[serde(serialize_with = "without_nulls")]
    pub problem: CaseFormat,
    /// Tolerance of selections that state none.
    pub selection_tolerance_m: f64,
    /// The materials in numbers, by their names in `problem.material`.
    pub materials: BTreeMap<String, InNumbers>,
    /// Factors over time.
    pub factors: Factors,
    /// Where displacements are requested.
    pub probes: Vec<Probe>,
    /// Instants at which every quantity is requested; in a static problem the end of loading.
    pub instants_s: Vec<f64>,
    /// Moments of reactions are taken about this point.
    pub moment_about_m: Triple,
}

/// The factor of each row of a table of `problem` at each instant of the job.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub struct Factors {
    pub prescribe: Vec<Vec<f64>>,
    pub body_force: Vec<Vec<f64>>,
    pub traction: Vec<Vec<f64>>,
    pub pressure: Vec<Vec<f64>>,
}

impl Factors {
    fn new(problem: &Problem, instants_s: &[f64]) -> Factors {
        let at = |amplitude: &Amplitude| instants_s.iter().map(|&t| amplitude.at(t)).collect();
        let Loads { body_forces, tractions, pressures, .. } = &problem.loads;
        Factors {
            prescribe: problem.conditions.iter().map(|row| at(&row.amplitude)).collect(),
            body_force: body_forces.iter().map(|row| at(&row.amplitude)).collect(),
            traction: tractions.iter().map(|row| at(&row.amplitude)).collect(),
            pressure: pressures.iter().map(|row| at(&row.amplitude)).collect(),
        }
    }
}

/// As a case file has it: what is left out has no key.
fn without_nulls<S: Serializer>(problem: &CaseFormat, writer: S) -> Result<S::Ok, S::Error> {
    let mut value = serde_json::to_value(problem).map_err(S::Error::custom)?;
    drop_nulls(&mut value);
    value.serialize(writer)
}

fn drop_nulls(value: &mut Value) {
    match value {
        Value::Object(table) => {
            table.retain(|_, inner| !inner.is_null());
            table.values_mut().for_each(drop_nulls);
        }
        Value::Array(rows) => rows.iter_mut().for_each(drop_nulls),
        _ => {}
    }
}

/// Where displacements are requested: positions, or a centre of mass.
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
    /// A job for a case in whose text names of other files are absolute.
    pub fn new(case: &Case, at: Resolution, instants_s: &[f64]) -> Result<Job, Diagnostic> {
        let Resolution { spacing_m, level, levels, time_limit_s } = at;
        let mut problem = tables(case)?;
        if problem.region.is_empty() {
            let known = case.problem.regions.iter().map(|region| region.name.clone());
            problem.region = (known.zip(problem.material.keys().cloned()))
                .map(|(name, material)| RegionFormat { name, part: SelectorFormat::All, material })
                .collect();
        }
        Ok(Job {
            protocol: PROTOCOL,
            case: case.name.clone(),
            spacing_m,
            level,
            levels,
            time_limit_s,
            threads: 1,
            selection_tolerance_m: defaults::SELECTION_TOLERANCE * spacing_m,
            materials: materials(&problem, case),
            factors: Factors::new(&case.problem, instants_s),
            problem,
            probes: case.probes.iter().map(probe).collect(),
            instants_s: instants_s.to_vec(),
            moment_about_m: case.outputs.moment_about.into(),
        })
    }

    /// Its problem as the text of a case file.
    pub fn case_text(&self) -> Result<String, toml_edit::ser::Error> {
        toml_edit::ser::to_string_pretty(&self.problem)
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
