//! What is stored of a run.

use super::task::Job;
use mtled_case::reference::Quantity;
use mtled_case::scene::{Knob, Override, Setting};
use mtled_run::run::Work;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the layout of a record.
pub(crate) const SCHEMA_VERSION: u32 = 1;

/// Numbers by name, in SI units; the unit ends the name.
pub(crate) type Figures = BTreeMap<String, f64>;

/// One run. Only `timings` may differ from one time to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Version of the layout that the program wrote.
    pub schema_version: u32,
    /// Hash of everything that decides the result, in hexadecimal.
    pub key: String,
    /// Kind of run.
    pub job: Job,
    /// Name of the case.
    pub case: String,
    /// [`super::solver_identity`] of the program that ran it.
    pub solver: String,
    /// Values under keys of the case file in place of its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub overrides: Vec<Override>,
    /// Changes to the recipe of the case.
    pub settings: Vec<Setting>,
    /// Instants of the values \[s\].
    pub times_s: Vec<f64>,
    /// Result or failure.
    pub outcome: RunOutcome,
    /// CPU times, where and when.
    pub timings: Timings,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunOutcome {
    /// It reached its end.
    Done {
        /// Single numbers.
        figures: Figures,
        /// Names and kinds of the values; a record of an earlier version has none.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        quantities: Vec<Quantity>,
        /// \[quantity of the case\]\[instant and component\].
        values: Vec<Vec<f64>>,
        /// Operation counts of a simulation.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        work: Option<Work>,
        /// Warnings of the set-up and of the run.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        warnings: Vec<String>,
    },
    /// It ended with an error.
    Failed {
        /// How far it came.
        stage: Stage,
        /// The error message.
        reason: String,
    },
}

/// Where a run failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Before the first step.
    Refused,
    /// During the simulation.
    #[serde(rename = "marching")]
    Running,
}

/// What a run took on one thread.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Timings {
    /// Of the set-up \[CPU s\].
    pub set_up_cpu_s: f64,
    /// Of the simulation \[CPU s\].
    #[serde(rename = "march_cpu_s")]
    pub solve_cpu_s: f64,
    /// Name of the processor.
    pub processor: String,
    /// YYYY-MM-DD.
    pub date: String,
}

impl RunRecord {
    /// A figure by its name.
    pub(crate) fn figure(&self, name: &str) -> Option<f64> {
        match &self.outcome {
            RunOutcome::Done { figures, .. } => figures.get(name).copied(),
            RunOutcome::Failed { .. } => None,
        }
    }

    /// \[quantity of the case\]\[instant and component\], unless the run failed.
    pub fn values(&self) -> Option<&[Vec<f64>]> {
        match &self.outcome {
            RunOutcome::Done { values, .. } => Some(values),
            RunOutcome::Failed { .. } => None,
        }
    }

    /// Operation counts of a simulation that reached its end.
    pub(crate) fn work(&self) -> Option<&Work> {
        match &self.outcome {
            RunOutcome::Done { work, .. } => work.as_ref(),
            RunOutcome::Failed { .. } => None,
        }
    }

    /// The error message of a run that failed.
    pub(crate) fn failure(&self) -> Option<&str> {
        match &self.outcome {
            RunOutcome::Done { .. } => None,
            RunOutcome::Failed { reason, .. } => Some(reason),
        }
    }

    /// Set-up and simulation \[CPU s\].
    pub fn cpu_s(&self) -> f64 {
        self.timings.set_up_cpu_s + self.timings.solve_cpu_s
    }

    /// CPU time of the simulation per quadrature point and neighbour \[ns\].
    pub(crate) fn nanoseconds_per_visit(&self) -> Option<f64> {
        Some(1e9 * self.timings.solve_cpu_s / self.work()?.neighbour_visits as f64)
    }

    /// The change of a knob; the last one counts.
    pub(crate) fn setting(&self, knob: Knob) -> Option<&Setting> {
        self.settings.iter().rev().find(|setting| setting.knob == knob)
    }
}
