//! What is to be run.

use crate::bundled::{CASES, unpack};
use crate::scene::{Case, EditError, Setting, edited, one_error, parse_case};
use anyhow::{Context, Result, anyhow};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What is done with a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Job {
    /// Solved to its end.
    Solve,
    /// Discretised and looked at.
    Consistency,
    /// Its body and recipe under an affine field.
    Patch,
    /// Its critical step by bounds, by Lanczos and by trial.
    TimeStep,
}

/// A case file before any change.
#[derive(Debug, Clone)]
pub struct Source {
    /// Stem of the file name.
    pub name: String,
    pub file: PathBuf,
    pub case: Case,
}

impl Source {
    /// A case file, or else a carried case by its name, which is unpacked into
    /// `folder`. The error holds the mistakes, a line each.
    pub fn find(name: &str, folder: &Path) -> Result<Arc<Source>> {
        let path = PathBuf::from(name);
        let carried = CASES.iter().any(|(carried, _)| *carried == name);
        let file = match (path.exists(), carried) {
            (true, _) => path,
            (false, true) => unpack(folder)?.join(format!("{name}.toml")),
            (false, false) => {
                return Err(anyhow!(
                    "there is no case file {name}, nor a carried case of that name \
                     (`mtled case list` names them)"
                ));
            }
        };
        let text = std::fs::read_to_string(&file)
            .with_context(|| format!("cannot read {}", file.display()))?;
        let case = parse(&text, &file)?;
        Ok(Arc::new(Source { name: case.name.clone(), file, case }))
    }

    /// The case with other settings; the error names the settings.
    pub fn with(&self, settings: &[Setting]) -> Result<Case> {
        parse(&self.text_with(settings)?, &self.file)
    }

    /// Its text with other settings, comments kept.
    pub fn text_with(&self, settings: &[Setting]) -> Result<String, EditError> {
        edited(self.case.text(), settings)
    }
}

fn parse(text: &str, file: &Path) -> Result<Case> {
    let folder = file.parent().unwrap_or(Path::new("."));
    parse_case(text, &file.display().to_string(), folder).map_err(one_error)
}

/// One run.
#[derive(Debug, Clone)]
pub struct Task {
    pub job: Job,
    pub source: Arc<Source>,
    pub settings: Vec<Setting>,
    /// Instants of the values of a dynamic run \[s\].
    pub times: Vec<f64>,
}

impl Task {
    /// What decides the result, in hexadecimal.
    pub fn key(&self) -> Result<String> {
        let mut hash = Sha256::new();
        // The hash of the case covers the files that it refers to.
        for part in
            [solver_identity(), &self.source.case.hash, &self.source.text_with(&self.settings)?]
        {
            hash.update(part.len().to_le_bytes());
            hash.update(part);
        }
        hash.update(serde_json::to_string(&self.job)?);
        self.times.iter().for_each(|time| hash.update(time.to_bits().to_le_bytes()));
        Ok(hash.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect())
    }

    /// The settings in words.
    pub fn words(&self) -> String {
        let words: Vec<String> = self.settings.iter().map(Setting::to_string).collect();
        format!("{} ({})", self.source.name, words.join(", "))
    }
}

/// Version of the solver, with a fingerprint of its sources and of what reads
/// cases and makes records.
pub fn solver_identity() -> &'static str {
    concat!(env!("CARGO_PKG_VERSION"), "+", env!("MTLED_SOURCES"))
}
