//! Figures and the bounds that they must keep.

use super::comparison::Band;
use super::nan_as_null;
use crate::escape::file_name;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Where a bound comes from. The three kinds never mix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A closed form or a theorem.
    Exact,
    /// A published or finite-element value with its own uncertainty.
    Reference,
    /// An earlier figure of the same code.
    Regression,
}

impl Kind {
    /// Its name in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Kind::Exact => "exact",
            Kind::Reference => "reference",
            Kind::Regression => "regression",
        }
    }
}

/// Where a figure may leave the band of the baseline without being worse.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Better {
    /// Below it, as errors and work.
    Lower,
    /// Nowhere, as answers.
    Neither,
}

/// What a value must satisfy to pass.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", remote = "Self")]
pub enum Bound {
    /// Value ≤ limit.
    AtMost(#[serde(deserialize_with = "nan_as_null::number")] f64),
    /// Value ≥ limit.
    AtLeast(#[serde(deserialize_with = "nan_as_null::number")] f64),
    /// Lower limit ≤ value ≤ upper limit.
    Between(
        #[serde(deserialize_with = "nan_as_null::number")] f64,
        #[serde(deserialize_with = "nan_as_null::number")] f64,
    ),
    /// None of its own: a stored figure judges by its band, and nothing where none is stored.
    Baseline(Better),
}

impl Serialize for Bound {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Bound::serialize(self, serializer)
    }
}

/// In files from before [`Bound::Baseline`] the largest number stands for it.
impl<'de> Deserialize<'de> for Bound {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Bound, D::Error> {
        Ok(match Bound::deserialize(deserializer)? {
            Bound::AtMost(f64::MAX) => Bound::Baseline(Better::Lower),
            Bound::Between(f64::MIN, f64::MAX) => Bound::Baseline(Better::Neither),
            bound => bound,
        })
    }
}

impl Bound {
    /// Whether `value` does not break the bound; NaN does, and so does what is not finite where
    /// there is no limit.
    pub fn holds(&self, value: f64) -> bool {
        match *self {
            Bound::AtMost(limit) => value <= limit,
            Bound::AtLeast(limit) => value >= limit,
            Bound::Between(low, high) => value >= low && value <= high,
            Bound::Baseline(_) => value.is_finite(),
        }
    }
}

/// One measured figure against its bound.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Check {
    /// Unique and stable: `study/case/quantity`.
    pub id: String,
    /// Id of the study that it belongs to.
    pub study: String,
    /// What is measured, for people.
    pub quantity: String,
    /// Where the bound comes from.
    pub kind: Kind,
    /// The measured figure, in `unit`.
    #[serde(deserialize_with = "nan_as_null::number")]
    pub value: f64,
    /// What the value must satisfy, in `unit`.
    pub bound: Bound,
    /// SI, or `1` for a pure number.
    pub unit: String,
    /// Whether the value does not break the bound.
    pub pass: bool,
    /// The band of the stored figure that judges a check without a bound of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band: Option<Band>,
    /// Source of the bound, such as a citation.
    pub source: String,
    /// Text of the smallest input file that reproduces the failure, for a check
    /// that fails.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reproduce: Option<String>,
    /// Error bar of the reference that the value is measured against, in the
    /// unit of the value: smaller changes are neither better nor worse.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_error: Option<f64>,
}

impl Check {
    /// Judges `value`; `id` is `study/…`.
    pub fn new(
        id: &str,
        quantity: &str,
        kind: Kind,
        value: f64,
        bound: Bound,
        unit: &str,
        source: &str,
    ) -> Check {
        Check {
            id: id.to_string(),
            study: id.split('/').next().unwrap_or(id).to_string(),
            quantity: quantity.to_string(),
            kind,
            value,
            bound,
            unit: unit.to_string(),
            pass: bound.holds(value),
            band: None,
            source: source.to_string(),
            reproduce: None,
            reference_error: None,
        }
    }

    /// Whether something judges the value: a bound, or the band of a stored figure.
    pub fn is_judged(&self) -> bool {
        self.band.is_some() || !matches!(self.bound, Bound::Baseline(_))
    }

    /// Whether it was judged and keeps its bound.
    pub fn passed(&self) -> bool {
        self.pass && self.is_judged()
    }

    /// File of a report with the input that reproduces a failure, relative to the
    /// report's folder; None where the check passes or has no such input.
    pub(crate) fn failure_file(&self) -> Option<String> {
        (!self.pass && self.reproduce.is_some()).then(|| self.case_file())
    }

    /// File of a report for the input that reproduces a failure of this check, relative to
    /// the report's folder.
    pub(crate) fn case_file(&self) -> String {
        format!("failures/{}.toml", file_name(&self.id))
    }
}
