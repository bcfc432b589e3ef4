//! A reference file as it is written: `reference/data/<case>.json`.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the layout that is read here.
pub const SCHEMA_VERSION: u32 = 1;

/// What finite-element codes found for one case.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ReferenceFile {
    pub schema_version: u32,
    pub case: String,
    /// Fingerprint of the problem that was solved
    /// ([`crate::scene::problem_hash`]).
    pub problem_hash: String,
    /// Instants of the values \[s\]; the end of loading alone for a static case.
    pub times_s: Vec<f64>,
    /// One per code.
    pub solutions: Vec<Solution>,
}

/// What one code found, and how.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Solution {
    /// `fenicsx` or `scikit-fem`.
    pub code: String,
    pub version: String,
    /// YYYY-MM-DD.
    pub date: String,
    pub formulation: String,
    pub element: String,
    pub mesh_family: String,
    pub solver: String,
    /// Of dynamic cases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_scheme: Option<String>,
    /// Versions of what it ran on.
    pub packages: BTreeMap<String, String>,
    /// From coarse to fine.
    pub meshes: Vec<Mesh>,
}

/// One mesh with its cost and its raw values.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Mesh {
    /// Size of the elements \[m\].
    pub size_m: f64,
    pub elements: u64,
    pub unknowns: u64,
    /// CPU time of this mesh, one thread \[s\].
    pub cpu_s: f64,
    pub peak_memory_bytes: u64,
    /// Of dynamic cases \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_step_s: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_steps: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub newton_iterations: Option<u64>,
    /// By the name of the quantity.
    pub values: BTreeMap<String, Values>,
}

/// The numbers of one quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Values {
    /// A flat list per instant.
    History(Vec<Vec<f64>>),
    /// Constant in time.
    Once(Vec<f64>),
}

impl Values {
    /// The lists by instant; one where nothing changes in time.
    pub fn instants(&self) -> Vec<&[f64]> {
        match self {
            Values::History(lists) => lists.iter().map(Vec::as_slice).collect(),
            Values::Once(list) => vec![list],
        }
    }

    /// All numbers, instant by instant.
    pub fn flat(&self) -> Vec<f64> {
        self.instants().concat()
    }
}
