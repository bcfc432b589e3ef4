//! A study stated in a TOML file.

use super::axis::{Axis, AxisError};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Cases, ranges and clouds of a study; what stands on the command line goes before.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Case files, relative to the plan, or names of carried cases.
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
    #[error("{file} cannot be read: {source}")]
    Unreadable { file: String, source: std::io::Error },
    #[error("{file}:{line}: {reason}")]
    Wrong { file: String, line: usize, reason: String },
    #[error("{file}: ranges: {source}")]
    Range { file: String, source: AxisError },
}

impl Plan {
    /// Reads a plan; its case files are found from its own folder.
    pub fn read(path: &Path) -> Result<Plan, PlanError> {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path)
            .map_err(|source| PlanError::Unreadable { file: file.clone(), source })?;
        let mut plan: Plan = toml::from_str(&text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            let line = text[..at].matches('\n').count() + 1;
            let reason = error.message().replace('\n', ", ");
            PlanError::Wrong { file: file.clone(), line, reason }
        })?;
        let folder = path.parent().unwrap_or(Path::new("."));
        for case in &mut plan.cases {
            let beside = folder.join(case.as_str());
            if beside.exists() {
                *case = beside.display().to_string();
            }
        }
        plan.axes(&file)?;
        Ok(plan)
    }

    /// Its ranges.
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
    fn a_plan_finds_its_cases_beside_itself_and_its_mistakes_have_a_line() {
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
        assert!(error.contains("there is no `dilatoin`"), "{error}");
    }
}
