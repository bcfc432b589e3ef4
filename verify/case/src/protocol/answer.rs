//! What a solver replies: values at the probes and supports, or why it does not solve the job.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The answer to a job. Every list has one entry per instant of the job, in order. Vectors have
/// three components, in plane strain too. JSON has no NaN and no infinity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Answer of the solver protocol")]
pub struct Answer {
    /// Version of the protocol, 1.
    pub protocol: u32,
    pub solver: SolverName,
    /// Displacements by probe, every probe of the job: lists by instant, position and component.
    pub displacements_m: BTreeMap<String, Vec<Vec<[f64; 3]>>>,
    /// Forces that supports exert on the body, by support, lists by instant and component;
    /// supports that the solver does not know are left out.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub reactions_n: BTreeMap<String, Vec<[f64; 3]>>,
    /// Moments of these forces at displaced positions about `moment_about_m` of the job.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub moments_nm: BTreeMap<String, Vec<[f64; 3]>>,
    /// ∫ ψ dV of the whole body, by instant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strain_energy_j: Option<Vec<f64>>,
    /// ∫ ρ v²/2 dV of the whole body, by instant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kinetic_energy_j: Option<Vec<f64>>,
    /// Scalar unknowns of the system that was solved, without prescribed components, at least 1.
    pub unknowns: u64,
    /// Processor time that the program believes to have taken since its start, all threads and
    /// children. It is measured too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu_s: Option<f64>,
    /// Of that, what the solution has not taken and a longer program would take once: the start of
    /// an interpreter, imports, generation of code, attempts that failed, writing the answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub apart_cpu_s: Option<f64>,
    /// Largest resident memory that the program believes to have taken. It is measured too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_memory_bytes: Option<u64>,
    /// One line about how it was solved, such as the element.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub method: Option<String>,
}

/// Who answers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SolverName {
    pub name: String,
    pub version: String,
}

/// The reply of a solver that does not solve a job.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Refusal of the solver protocol")]
pub struct Refusal {
    /// Version of the protocol, 1.
    pub protocol: u32,
    pub solver: SolverName,
    pub refused: Refused,
}

/// Why a job is not solved.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Refused {
    pub reason: RefusalReason,
    /// What it is about, such as "contact".
    pub what: String,
}

/// Kinds of refusals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RefusalReason {
    /// The program does not solve problems with this.
    Unsupported,
    /// The problem is solved, but not at this resolution.
    Resolution,
    /// The solution did not converge.
    NotConverged,
}

impl RefusalReason {
    /// In tables.
    pub fn label(self) -> &'static str {
        match self {
            RefusalReason::Unsupported => "not supported",
            RefusalReason::Resolution => "not at this resolution",
            RefusalReason::NotConverged => "not converged",
        }
    }
}

/// What a program writes.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "Reply of the solver protocol")]
pub enum Reply {
    /// Values.
    Answer(Answer),
    /// None, with the reason.
    Refusal(Refusal),
}
