//! What is kept of a run.

use super::task::Job;
use crate::run::Work;
use crate::scene::Setting;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the layout of a record.
pub const SCHEMA_VERSION: u32 = 1;

/// One run; all that may differ from one time to the next stands under `timings`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    pub schema_version: u32,
    pub key: String,
    pub job: Job,
    pub case: String,
    pub solver: String,
    pub settings: Vec<Setting>,
    /// Instants of the values \[s\].
    pub times_s: Vec<f64>,
    pub outcome: Outcome,
    pub timings: Timings,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    Done {
        /// By name, SI, the unit at the end of the name.
        figures: BTreeMap<String, f64>,
        /// The quantities of the case, each instant by instant.
        values: Vec<Vec<f64>>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        work: Option<Work>,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        warnings: Vec<String>,
    },
    Failed {
        stage: Stage,
        reason: String,
    },
}

/// Where a run failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Before the first step.
    Refused,
    /// On the way.
    Marching,
}

/// What a run took.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Timings {
    /// One thread \[s\].
    pub set_up_cpu_s: f64,
    /// One thread \[s\].
    pub march_cpu_s: f64,
    pub processor: String,
    pub date: String,
}

impl Record {
    /// A figure by its name.
    pub fn figure(&self, name: &str) -> Option<f64> {
        match &self.outcome {
            Outcome::Done { figures, .. } => figures.get(name).copied(),
            Outcome::Failed { .. } => None,
        }
    }

    /// The quantities of the case, unless the run failed.
    pub fn values(&self) -> Option<&[Vec<f64>]> {
        match &self.outcome {
            Outcome::Done { values, .. } => Some(values),
            Outcome::Failed { .. } => None,
        }
    }

    pub fn work(&self) -> Option<&Work> {
        match &self.outcome {
            Outcome::Done { work, .. } => work.as_ref(),
            Outcome::Failed { .. } => None,
        }
    }

    /// Why it failed, if it did.
    pub fn failure(&self) -> Option<&str> {
        match &self.outcome {
            Outcome::Done { .. } => None,
            Outcome::Failed { reason, .. } => Some(reason),
        }
    }

    /// Set-up and march \[CPU s\].
    pub fn cpu_s(&self) -> f64 {
        self.timings.set_up_cpu_s + self.timings.march_cpu_s
    }

    /// The level of a knob that was set, in words.
    pub fn level(&self, knob: crate::scene::Knob) -> Option<String> {
        let setting = self.settings.iter().rev().find(|setting| setting.knob == knob)?;
        Some(setting.level.to_string())
    }
}
