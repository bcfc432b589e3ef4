//! The race: the contest with a fixed list of recipes and elements, `reference/race.toml`.

use super::entrant::Entrant;
use super::problem::{NotASpacing, Spacing};
use anyhow::{Context, Result};
use serde::Deserialize;
use std::path::Path;

/// Who races on which problems.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RaceList {
    /// Names of bundled cases.
    pub problems: Vec<String>,
    /// Distances of nodes from coarse to fine, as factors of those of the cases.
    spacings: Vec<String>,
    /// Of a run, on the clock \[s\].
    pub time_limit_s: f64,
    /// The recipes and elements.
    #[serde(rename = "solver")]
    pub racers: Vec<Racer>,
}

/// A recipe of mtled, or an element of another program.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Racer {
    /// In tables.
    name: String,
    /// Values in place of those of the case file, for mtled.
    #[serde(default)]
    set: Vec<String>,
    /// How another program is reached.
    pub adapter: Option<Adapter>,
}

/// An adapter of the package `mtled_reference`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Adapter {
    /// Its module below `mtled_reference.adapters`.
    name: String,
    /// What its Python must be able to import.
    pub imports: String,
    /// The element.
    element: String,
}

impl RaceList {
    /// The bundled list.
    pub fn bundled() -> Result<RaceList> {
        toml_edit::de::from_str(mtled_reference::RACE).context("reference/race.toml")
    }

    /// Distances of nodes from coarse to fine.
    pub fn spacings(&self) -> Result<Vec<Spacing>, NotASpacing> {
        self.spacings.iter().map(|text| text.parse()).collect()
    }
}

impl Racer {
    /// As a program that takes part: this one, or `python` (with its flags) with the package in the
    /// folder `reference`.
    pub fn entrant(&self, own: &Path, python: &[String], reference: &Path) -> Entrant {
        let Some(adapter) = &self.adapter else { return Entrant::own(own, &self.name, &self.set) };
        let module = format!("mtled_reference.adapters.{}", adapter.name);
        let words = ["-m", &module, "--element", &adapter.element, "{job}", "{answer}"];
        let shown = format!("python3 {}", words.join(" "));
        let path = format!("PYTHONPATH={}", reference.display());
        let start = ["env".to_string(), path].into_iter().chain(python.iter().cloned());
        let command = start.chain(words.map(str::to_string)).collect();
        Entrant { name: self.name.clone(), command, shown }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contests::entrant::is_name;
    use mtled_case::bundled::REFERENCES;
    use mtled_case::scene::Override;

    #[test]
    fn who_races_has_a_name_and_problems_with_references() {
        let list = RaceList::bundled().unwrap();
        assert!(list.spacings().unwrap().len() >= 3);
        for problem in &list.problems {
            assert!(REFERENCES.iter().any(|(name, _)| name == problem), "{problem}");
        }
        for racer in &list.racers {
            assert!(is_name(&racer.name), "{}", racer.name);
            assert!(racer.set.iter().all(|set| set.parse::<Override>().is_ok()));
            assert!(racer.adapter.is_none() || racer.set.is_empty());
        }
    }
}
