//! Studies defined in a TOML file.

use super::axis::{Axis, AxisError};
use mtled_case::scene::read_text;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Cases, ranges and clouds of a study; the command line takes precedence.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Case files, relative to the plan, or names of bundled cases.
    #[serde(default)]
    pub cases: Vec<String>,
    /// Clouds per combination.
    pub clouds: Option<usize>,
    /// By the name of the knob: `dilation = "1.4..2.6:0.2"`, `basis = "linear"`.
    #[serde(default)]
    pub ranges: BTreeMap<String, String>,
}

/// What is wrong with a plan.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The file cannot be read.
    #[error("{file} cannot be read: {source}")]
    Unreadable {
        /// Path of the file.
        file: String,
        /// What went wrong.
        source: std::io::Error,
    },
    /// It is not a plan.
    #[error("{file}:{line}: {reason}")]
    Invalid {
        /// Path of the file.
        file: String,
        /// Line of the mistake, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A range cannot be understood.
    #[error("{file}: ranges: {source}")]
    Range {
        /// Path of the file.
        file: String,
        /// What went wrong.
        source: AxisError,
    },
}

impl Plan {
    /// Reads a plan; paths of cases are relative to its folder.
    pub fn read(path: &Path) -> Result<Plan, PlanError> {
        let file = path.display().to_string();
        let text = read_text(path)
            .map_err(|source| PlanError::Unreadable { file: file.clone(), source })?;
        let mut plan: Plan = toml_edit::de::from_str(&text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            let line = text[..at].matches('\n').count() + 1;
            let reason = error.message().replace('\n', ", ");
            PlanError::Invalid { file: file.clone(), line, reason }
        })?;
        let folder = path.parent().unwrap_or(Path::new("."));
        for case in &mut plan.cases {
            let path = folder.join(case.as_str());
            if path.exists() {
                *case = path.display().to_string();
            }
        }
        plan.axes(&file)?;
        Ok(plan)
    }

    /// Its ranges; errors name `file`.
    pub fn axes(&self, file: &str) -> Result<Vec<Axis>, PlanError> {
        let axis = |(name, text): (&String, &String)| {
            Axis::named(name, text)
                .map_err(|source| PlanError::Range { file: file.to_string(), source })
        };
        self.ranges.iter().map(axis).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_finds_cases_in_its_folder_and_mistakes_are_located() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("plan.toml");
        std::fs::write(folder.path().join("mine.toml"), "").unwrap();
        let text = "cases = [\"mine.toml\", \"cook_membrane\"]\nclouds = 2\n[ranges]\ndilation = \"1.4,1.8\"\n";
        std::fs::write(&file, text).unwrap();
        let plan = Plan::read(&file).unwrap();
        assert!(plan.cases[0].ends_with("mine.toml") && plan.cases[0].len() > 9);
        assert_eq!(plan.cases[1], "cook_membrane");
        assert_eq!(plan.axes("").unwrap()[0].levels.len(), 2);
        std::fs::write(&file, "cases = []\nclouts = 2\n").unwrap();
        let error = Plan::read(&file).unwrap_err().to_string();
        assert!(error.contains("plan.toml:2") && error.contains("clouts"), "{error}");
        std::fs::write(&file, "[ranges]\ndilatoin = \"1\"\n").unwrap();
        let error = Plan::read(&file).unwrap_err().to_string();
        assert!(error.contains("there is no setting `dilatoin`"), "{error}");
    }
}
