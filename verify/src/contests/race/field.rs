//! A race, and all runs of one of its problems.

use super::challenge::Challenge;
use super::finite_elements::Interpreter;
use super::race_run::{Code, RaceRun};
use crate::accuracy::{Cost, cost_at};

/// What to run.
#[derive(Debug)]
pub struct RaceSettings {
    /// The problems.
    pub challenges: Vec<Challenge>,
    /// Repetitions of every run, of which medians are shown.
    pub repetitions: usize,
    /// The finite-element codes that are installed.
    pub interpreters: Vec<Interpreter>,
}

/// All runs of a challenge, of all codes.
#[derive(Debug)]
pub struct Field {
    pub challenge: Challenge,
    pub runs: Vec<RaceRun>,
    /// Error bar of the solution that errors are measured against, in their unit.
    pub uncertainty: f64,
}

/// A cost of a run.
pub type CostOf = fn(&RaceRun) -> f64;

/// A family with its runs from coarse to fine.
pub type FamilyRuns<'a> = (&'a str, Vec<&'a RaceRun>);

/// Peak memory of a run \[MB\].
pub fn megabytes(run: &RaceRun) -> f64 {
    run.peak_memory_bytes as f64 / 1e6
}

/// The cost of a family at an error.
pub fn cost_of(runs: &[&RaceRun], error: f64, cost: CostOf) -> Option<Cost> {
    let points: Vec<(f64, f64)> = runs.iter().map(|run| (run.error, cost(run))).collect();
    cost_at(&points, error)
}

impl Field {
    /// Runs of a code by family, in the order in which they were run.
    pub fn families(&self, code: Code) -> Vec<FamilyRuns<'_>> {
        let mut families: Vec<FamilyRuns> = Vec::new();
        for run in self.runs.iter().filter(|run| run.code == code) {
            match families.iter_mut().find(|(name, _)| *name == run.family) {
                Some((_, runs)) => runs.push(run),
                None => families.push((&run.family, vec![run])),
            }
        }
        families
    }

    /// Whether the runs of a code are stored ones.
    pub fn stored(&self, code: Code) -> bool {
        self.runs.iter().any(|run| run.code == code && run.stored)
    }

    /// Name of a code in tables.
    pub fn title(&self, code: Code) -> String {
        let mark = if self.stored(code) { " (stored)" } else { "" };
        format!("{}{mark}", code.title())
    }

    /// The family of a code with the smallest CPU time at an error.
    pub fn cheapest(&self, code: Code, error: f64) -> Option<(&str, Cost)> {
        let costs = self
            .families(code)
            .into_iter()
            .filter_map(|(name, runs)| Some((name, cost_of(&runs, error, |run| run.cpu_s)?)));
        costs.min_by(|a, b| a.1.value.total_cmp(&b.1.value))
    }
}
