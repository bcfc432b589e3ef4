//! Counts by target and their table.

use crate::finding::{Kind, Outcome};
use crate::station::Trial;
use crate::target::Target;
use serde::Serialize;
use std::collections::BTreeMap;

/// Counts of one target.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Tally {
    /// Inputs tried.
    pub inputs: usize,
    /// Time on the clock, all jobs \[s\].
    pub seconds: f64,
    /// Inputs by outcome.
    pub outcomes: BTreeMap<Outcome, usize>,
    /// Inputs with findings, by kind.
    pub findings: BTreeMap<Kind, usize>,
    /// Largest memory of a child \[byte\].
    pub largest_bytes: u64,
    /// Longest call \[s\].
    pub longest_seconds: f64,
}

impl Tally {
    /// Counts one input.
    pub(crate) fn count(&mut self, trial: &Trial, seconds: f64) {
        self.inputs += 1;
        self.seconds += seconds;
        if let Some(outcome) = trial.outcome {
            *self.outcomes.entry(outcome).or_default() += 1;
        }
        for finding in &trial.findings {
            *self.findings.entry(finding.kind).or_default() += 1;
        }
        self.largest_bytes = self.largest_bytes.max(trial.peak);
        self.longest_seconds = self.longest_seconds.max(trial.seconds);
    }

    fn add(&mut self, other: &Tally) {
        self.inputs += other.inputs;
        self.seconds += other.seconds;
        for (outcome, count) in &other.outcomes {
            *self.outcomes.entry(*outcome).or_default() += count;
        }
        for (kind, count) in &other.findings {
            *self.findings.entry(*kind).or_default() += count;
        }
        self.largest_bytes = self.largest_bytes.max(other.largest_bytes);
        self.longest_seconds = self.longest_seconds.max(other.longest_seconds);
    }

    fn row(&self, name: &str) -> String {
        let count = |outcome| self.outcomes.get(&outcome).copied().unwrap_or(0);
        let findings: Vec<String> =
            self.findings.iter().map(|(kind, count)| format!("{count} {}", kind.name())).collect();
        let findings = if findings.is_empty() { "0".into() } else { findings.join(", ") };
        format!(
            "| {name} | {} | {:.0} | {} | {} | {} | {} | {} | {} | {findings} | {:.0} | {:.2} |\n",
            self.inputs,
            self.inputs as f64 / self.seconds.max(1e-9),
            count(Outcome::Succeeded),
            count(Outcome::Doubtful),
            count(Outcome::Refused),
            count(Outcome::Diverged),
            count(Outcome::Stopped),
            count(Outcome::LeftOut),
            self.largest_bytes as f64 / 1e6,
            self.longest_seconds
        )
    }
}

/// All counts as a Markdown table.
pub fn markdown(tallies: &BTreeMap<Target, Tally>) -> String {
    let mut text = "| target | inputs | per s | succeeded | doubtful | refused | diverged | stopped | left out | findings \
                    | most memory, MB | longest, s |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|---|--:|--:|\n"
        .to_string();
    let mut all = Tally::default();
    for (target, tally) in tallies {
        text += &tally.row(target.name());
        all.add(tally);
    }
    text + &all.row("all")
}

/// All counts as JSON.
pub fn json(tallies: &BTreeMap<Target, Tally>) -> serde_json::Value {
    let rows = tallies.iter().map(|(target, tally)| {
        (target.name().to_string(), serde_json::to_value(tally).unwrap_or_default())
    });
    serde_json::Value::Object(rows.collect())
}
