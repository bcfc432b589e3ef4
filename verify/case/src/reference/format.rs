//! A reference file as it is written: `reference/data/<case>.json`.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the layout that is read here.
pub(crate) const SCHEMA_VERSION: u32 = 1;

/// Finite-element solutions of one case.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ReferenceFile {
    /// Version of the layout.
    pub schema_version: u32,
    /// Name of the case.
    pub case: String,
    /// Fingerprint of the problem that was solved
    /// ([`crate::scene::problem_hash`]).
    pub problem_hash: String,
    /// Instants of the values \[s\]; the end of loading alone for a static case.
    pub times_s: Vec<f64>,
    /// One per code.
    pub solutions: Vec<Solution>,
}

/// The solution of one code.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Solution {
    /// `fenicsx` or `scikit-fem`.
    pub code: String,
    /// Of the code.
    pub version: String,
    /// YYYY-MM-DD.
    pub date: String,
    /// Unknown fields and treatment of incompressibility.
    pub formulation: String,
    /// Kind of element.
    pub element: String,
    /// Kind of mesh.
    pub mesh_family: String,
    /// Of the nonlinear and linear equations.
    pub solver: String,
    /// Of dynamic cases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_scheme: Option<String>,
    /// Versions of other packages.
    pub packages: BTreeMap<String, String>,
    /// From coarse to fine.
    pub meshes: Vec<Mesh>,
}

/// One mesh with its cost and its raw values.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Mesh {
    /// Size of the elements \[m\].
    pub size_m: f64,
    /// Number of elements.
    pub elements: u64,
    /// Number of unknowns.
    pub unknowns: u64,
    /// CPU time of this mesh, one thread \[s\].
    pub cpu_s: f64,
    /// Peak memory \[bytes\].
    pub peak_memory_bytes: u64,
    /// Time step of dynamic cases \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_step_s: Option<f64>,
    /// Of static cases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_steps: Option<u64>,
    /// Of all load steps.
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
    pub(crate) fn instants(&self) -> Vec<&[f64]> {
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
