//! How a run stands beside an earlier one.

use super::lost;
use serde::{Deserialize, Serialize};

/// What became of a check, in the order in which a reader wants to know.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Beyond its band on the wrong side, or its bound was loosened.
    Worse,
    /// Known before, not measured now.
    Missing,
    New,
    /// Beyond its band on the right side.
    Improved,
    Same,
}

/// What the width of a band comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BandSource {
    /// Round-off: up to the bound of a theorem, or half the digits of a figure
    /// that no cloud moves.
    Theory,
    /// The error bar of the reference.
    Reference,
    /// Runs of the same code over other clouds.
    Scatter,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    Linear,
    /// Natural logarithms, for figures that are positive on every cloud.
    Logarithmic,
}

/// How a figure scatters over clouds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    pub scale: Scale,
    /// Standard deviation on that scale.
    pub deviation: f64,
    pub samples: usize,
}

/// Values that count as the same.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Band {
    pub low: f64,
    pub high: f64,
    pub source: BandSource,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spread: Option<Spread>,
}

/// One check before and now.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Change {
    pub id: String,
    pub quantity: String,
    pub unit: String,
    pub verdict: Verdict,
    /// NaN where there was none.
    #[serde(deserialize_with = "lost::number")]
    pub before: f64,
    /// NaN where there is none.
    #[serde(deserialize_with = "lost::number")]
    pub now: f64,
    pub band: Option<Band>,
    /// What else is to be said, such as a bound that was loosened.
    pub remark: Option<String>,
}

/// A run beside an earlier one, the worst first.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Comparison {
    /// What the run is compared with, in words.
    pub with: String,
    pub changes: Vec<Change>,
}

impl Comparison {
    pub fn count(&self, verdict: Verdict) -> usize {
        self.of(verdict).count()
    }

    pub fn of(&self, verdict: Verdict) -> impl Iterator<Item = &Change> {
        self.changes.iter().filter(move |change| change.verdict == verdict)
    }

    /// Whether nothing got worse and nothing is missing.
    pub fn holds(&self) -> bool {
        self.count(Verdict::Worse) + self.count(Verdict::Missing) == 0
    }
}
