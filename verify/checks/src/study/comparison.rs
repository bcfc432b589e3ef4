//! A run compared with an earlier one.

use super::nan_as_null;
use serde::{Deserialize, Serialize};

/// What became of a check, the most urgent first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Beyond its band on the wrong side, or its bound was loosened.
    Worse,
    /// Known before, not measured now.
    Missing,
    /// Not known before.
    New,
    /// Beyond its band on the right side.
    Improved,
    /// Inside its band.
    Same,
}

impl Verdict {
    /// Every verdict, the most urgent first.
    pub(crate) const ALL: [Verdict; 5] =
        [Verdict::Worse, Verdict::Missing, Verdict::New, Verdict::Improved, Verdict::Same];

    /// Its name in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Verdict::Worse => "worse",
            Verdict::Missing => "missing",
            Verdict::New => "new",
            Verdict::Improved => "improved",
            Verdict::Same => "same",
        }
    }
}

/// What the width of a band comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BandSource {
    /// Round-off: up to the bound of a theorem, or half the digits of a figure
    /// without scatter.
    Theory,
    /// The error bar of the reference.
    Reference,
    /// Runs of the same code over other random inputs, such as node clouds.
    Scatter,
}

/// Scale on which a figure scatters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// The figures themselves.
    Linear,
    /// Natural logarithms, for figures that are always positive.
    Logarithmic,
}

/// How a figure scatters over runs of the same code.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scatter {
    /// Scale of the deviation.
    pub scale: Scale,
    /// Standard deviation on that scale.
    pub deviation: f64,
    /// Number of runs.
    pub samples: usize,
}

/// Values that count as the same.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// Lower end, in the unit of the check.
    pub low: f64,
    /// Upper end, in the unit of the check.
    pub high: f64,
    /// What its width comes from.
    pub source: BandSource,
    /// Of the figure, where it is known.
    #[serde(default, alias = "spread", skip_serializing_if = "Option::is_none")]
    pub scatter: Option<Scatter>,
}

/// One check before and now.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Change {
    /// Of the check.
    pub id: String,
    /// What is measured, for people.
    pub quantity: String,
    /// SI, or `1` for a pure number.
    pub unit: String,
    /// What became of it.
    pub verdict: Verdict,
    /// NaN where there was none.
    #[serde(deserialize_with = "nan_as_null::number")]
    pub before: f64,
    /// NaN where there is none.
    #[serde(deserialize_with = "nan_as_null::number")]
    pub now: f64,
    /// Values that count as the same.
    pub band: Option<Band>,
    /// A further reason for the verdict, such as a bound that was loosened.
    pub remark: Option<String>,
}

/// A run compared with an earlier one.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Comparison {
    /// What the run is compared with, for people.
    pub with: String,
    /// The most urgent first.
    pub changes: Vec<Change>,
}

impl Comparison {
    /// Number of changes of this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.of(verdict).count()
    }

    /// Changes of this verdict.
    pub(crate) fn of(&self, verdict: Verdict) -> impl Iterator<Item = &Change> {
        self.changes.iter().filter(move |change| change.verdict == verdict)
    }

    /// Whether nothing got worse and nothing is missing.
    pub fn holds(&self) -> bool {
        self.count(Verdict::Worse) + self.count(Verdict::Missing) == 0
    }
}
