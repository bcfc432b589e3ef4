//! A study and a run of many studies.

use super::check::Check;
use super::comparison::Comparison;
use super::figure::Figure;
use super::nan_as_null;
use super::table::Table;
use serde::{Deserialize, Serialize};

/// One study: a claim with its checks, tables and figures.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Study {
    /// First part of the ids of its checks.
    pub id: String,
    /// Heading.
    pub title: String,
    /// What is claimed, in one or two sentences.
    pub claim: String,
    /// The command that reproduces it.
    pub command: String,
    /// Judged figures; a file keeps them in a list of their own.
    #[serde(default)]
    pub checks: Vec<Check>,
    /// Figures to read.
    pub tables: Vec<Table>,
    /// Plots and drawings.
    pub figures: Vec<Figure>,
    /// How many of its figures, from the first, lead the page; the very first of all studies is
    /// beside the result.
    #[serde(default)]
    pub leading: usize,
    /// Findings that are not gated, a paragraph each.
    pub notes: Vec<String>,
    /// Questions that it could not decide, each with the reason and what would decide it.
    #[serde(default)]
    pub undecided: Vec<String>,
    /// Why it could not run; a skip is not a pass.
    pub failure: Option<String>,
    /// \[s\]
    #[serde(deserialize_with = "nan_as_null::number")]
    pub wall_seconds: f64,
}

/// A run of many studies.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Report {
    /// Version of the file format.
    pub schema_version: u32,
    /// Name of the set of studies.
    pub suite: String,
    /// Which code ran where.
    pub provenance: Provenance,
    /// In the order in which they ran.
    pub studies: Vec<Study>,
    /// \[s\]
    #[serde(deserialize_with = "nan_as_null::number")]
    pub wall_seconds: f64,
    /// With a baseline, where one was given.
    pub comparison: Option<Comparison>,
}

/// Which code ran where.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Provenance {
    /// Of the program.
    pub version: String,
    /// Of the sources.
    pub commit: String,
    /// Name and version of the compiler.
    pub compiler: String,
    /// Name of the processor.
    pub processor: String,
    /// Instruction sets that were used.
    pub processor_features: String,
    /// Number of threads.
    pub threads: usize,
    /// Year, month and day.
    pub date: String,
}

impl Report {
    /// All checks of all studies.
    pub(crate) fn checks(&self) -> impl Iterator<Item = &Check> {
        self.studies.iter().flat_map(|study| &study.checks)
    }
}
