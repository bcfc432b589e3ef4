//! The committed figures, one check per line so that a diff can be read.

use crate::input::read_text;
use crate::study::{Band, Bound, Kind};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Version of the file that this program writes and reads.
pub(crate) const SCHEMA_VERSION: u32 = 1;

/// Accepted figures, with the reasons for accepting them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Baseline {
    /// Version of the file format.
    pub schema_version: u32,
    /// Name of the set of studies.
    pub suite: String,
    /// Chance that a run of unchanged code over other clouds fails \[–\].
    pub false_alarms: f64,
    /// Oldest first.
    pub history: Vec<Entry>,
    /// In the order of their ids.
    pub checks: Vec<Stored>,
}

/// Why the baseline was written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Of the run.
    pub date: String,
    /// Of the sources.
    pub commit: String,
    /// Name of the processor.
    pub processor: String,
    /// Why the figures may change.
    pub reason: String,
    /// Counts such as `3 worse, 1 new`.
    pub changes: String,
}

/// The accepted figure of one check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stored {
    /// Of the check.
    pub id: String,
    /// In `unit`.
    pub value: f64,
    /// SI, or `1` for a pure number.
    pub unit: String,
    /// Where the bound comes from.
    pub kind: Kind,
    /// What the value must satisfy.
    pub bound: Bound,
    /// Values that count as the same.
    pub band: Band,
}

/// Why a run cannot be compared or accepted.
#[derive(Debug, Error)]
#[allow(missing_docs)] // The messages say it.
pub enum GateError {
    #[error(
        "there is no baseline {}: write one with `mtled verify --update-baseline --reason …`", path.display()
    )]
    Absent { path: PathBuf },
    #[error("cannot read the baseline {}: {source}", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{} is not a baseline: {source}", path.display())]
    Malformed { path: PathBuf, source: serde_json::Error },
    #[error(
        "the baseline {} has schema version {found}, this program reads {SCHEMA_VERSION}: write it anew \
         with --update-baseline", path.display()
    )]
    Version { path: PathBuf, found: u64 },
    #[error(
        "the baseline is of the suite {baseline}, the run of the suite {run}: run `mtled verify --suite \
         {baseline}` or name another file"
    )]
    Suite { baseline: String, run: String },
    #[error("a baseline is written with a reason for whoever reads its diff: --reason is empty")]
    NoReason,
    #[error(
        "the run breaks its own bounds ({failed} checks failed, {broken} studies could not run): \
         only a run that passes becomes a baseline"
    )]
    RunFails { failed: usize, broken: usize },
    #[error("scatter needs results of at least two clouds, there is {0}")]
    TooFewClouds(usize),
}

/// Reads a baseline.
pub fn read_baseline(path: &Path) -> Result<Baseline, GateError> {
    let at = || path.to_path_buf();
    let text = read_text(path).map_err(|source| match source.kind() {
        std::io::ErrorKind::NotFound => GateError::Absent { path: at() },
        _ => GateError::Unreadable { path: at(), source },
    })?;
    let malformed = |source| GateError::Malformed { path: at(), source };
    #[derive(Deserialize)]
    struct Head {
        schema_version: u64,
    }
    let head: Head = serde_json::from_str(&text).map_err(malformed)?;
    if head.schema_version != u64::from(SCHEMA_VERSION) {
        return Err(GateError::Version { path: at(), found: head.schema_version });
    }
    serde_json::from_str(&text).map_err(malformed)
}

impl Baseline {
    /// Refuses to judge a run of another suite.
    pub fn check_suite(&self, run: &str) -> Result<(), GateError> {
        let (baseline, run) = (self.suite.clone(), run.to_string());
        if baseline == run { Ok(()) } else { Err(GateError::Suite { baseline, run }) }
    }

    /// The accepted figure of a check.
    pub fn check(&self, id: &str) -> Option<&Stored> {
        let found = self.checks.binary_search_by(|stored| stored.id.as_str().cmp(id)).ok()?;
        Some(&self.checks[found])
    }

    /// Text of the file, with an entry of the history or a check per line.
    pub fn to_json(&self) -> String {
        let suite = line(&self.suite);
        let history: Vec<String> = self.history.iter().map(line).collect();
        let checks: Vec<String> = self.checks.iter().map(line).collect();
        let list = |lines: Vec<String>| {
            if lines.is_empty() {
                "[]".to_string()
            } else {
                format!("[\n    {}\n  ]", lines.join(",\n    "))
            }
        };
        format!(
            "{{\n  \"schema_version\": {},\n  \"suite\": {suite},\n  \"false_alarms\": {},\n  \
             \"history\": {},\n  \"checks\": {}\n}}\n",
            self.schema_version,
            self.false_alarms,
            list(history),
            list(checks)
        )
    }
}

fn line<T: Serialize>(item: &T) -> String {
    serde_json::to_string(item).expect("plain data with string keys always serialises")
}
