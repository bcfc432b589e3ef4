//! Cases and the runs that are made of them.

use anyhow::{Context, Result, bail};
use mtled_case::bundled::{CASES, no_such_case, unpack};
use mtled_case::scene::{
    Case, EditError, Override, Setting, edited, one_error, parse_case, parse_overridden, read_text,
};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Number of hexadecimal digits in the key of a record.
pub(super) const KEY_DIGITS: usize = 32;

/// Kind of run.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub enum Job {
    /// A simulation to its end.
    Solve,
    /// The discretisation alone.
    Consistency,
    /// The affine patch test with its body and recipe.
    Patch,
    /// The critical time step by the per-point bound, by Lanczos and by trial.
    TimeStep,
}

/// A case file before any change.
#[derive(Debug, Clone)]
pub struct Source {
    /// Stem of the file name.
    pub name: String,
    /// Its path.
    pub file: PathBuf,
    /// Its content.
    pub case: Case,
}

impl Job {
    /// As it is written on the command line and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Job::Solve => "solve",
            Job::Consistency => "consistency",
            Job::Patch => "patch",
            Job::TimeStep => "time_step",
        }
    }
}

impl Source {
    /// A case file, or a bundled case by its name, which is unpacked into `folder`, with other
    /// values under some keys. The error lists the mistakes, one per line.
    pub fn find(name: &str, folder: &Path, overrides: &[Override]) -> Result<Arc<Source>> {
        let path = PathBuf::from(name);
        let bundled = CASES.iter().any(|(bundled, _)| *bundled == name);
        // A folder of that name is no case.
        let (file, shown) = match (path.exists() && !(bundled && path.is_dir()), bundled) {
            (true, _) => (path, name.to_string()),
            (false, true) => {
                let shown = format!("{name}.toml");
                (unpack(folder)?.join(&shown), shown)
            }
            (false, false) => bail!("{name} cannot be read: {}", no_such_case(name)),
        };
        let text = read_text(&file).with_context(|| format!("cannot read {}", file.display()))?;
        let base = file.parent().unwrap_or(Path::new("."));
        let case = parse_overridden(&text, &shown, base, overrides);
        let case = case.map_err(one_error)?;
        Ok(Arc::new(Source { name: case.name.clone(), file, case }))
    }

    /// The case with other settings.
    pub(crate) fn with(&self, settings: &[Setting]) -> Result<Case> {
        parse(&self.text_with(settings)?, &self.file)
    }

    /// Its text with other settings; comments are kept.
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
    /// Kind of run.
    pub job: Job,
    /// The case before changes.
    pub source: Arc<Source>,
    /// Changes to its recipe.
    pub settings: Vec<Setting>,
    /// Instants of the values of a dynamic run \[s\].
    pub times: Vec<f64>,
}

impl Task {
    /// Hash of everything that decides the result, in hexadecimal.
    pub(crate) fn key(&self) -> Result<String> {
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
        Ok(hash.finalize().iter().take(KEY_DIGITS / 2).map(|byte| format!("{byte:02x}")).collect())
    }

    /// Case and settings.
    pub(crate) fn label(&self) -> String {
        let settings: Vec<String> = self.settings.iter().map(Setting::to_string).collect();
        format!("{} ({})", self.source.name, settings.join(", "))
    }
}

/// Version of the solver, with a fingerprint of the sources that decide results: the
/// solver, and what reads cases and makes records.
pub fn solver_identity() -> &'static str {
    concat!(env!("CARGO_PKG_VERSION"), "+", env!("MTLED_SOURCES"))
}
