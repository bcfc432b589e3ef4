//! What a study returns: plain data that a report can be built from, with no
//! mechanics in it.

mod comparison;
mod lost;
pub mod shorthand;

pub use comparison::{Band, BandSource, Change, Comparison, Scale, Spread, Verdict};

use serde::{Deserialize, Serialize};

/// Where a bound comes from. The three kinds never mix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A closed form or a theorem.
    Exact,
    /// A published or finite-element value with its own uncertainty.
    Reference,
    /// Our own earlier figure.
    Regression,
}

/// What a value must satisfy to pass.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    AtMost(#[serde(deserialize_with = "lost::number")] f64),
    AtLeast(#[serde(deserialize_with = "lost::number")] f64),
    Between(
        #[serde(deserialize_with = "lost::number")] f64,
        #[serde(deserialize_with = "lost::number")] f64,
    ),
}

impl Bound {
    /// Whether `value` keeps the bound; NaN never does.
    pub fn holds(&self, value: f64) -> bool {
        match *self {
            Bound::AtMost(limit) => value <= limit,
            Bound::AtLeast(limit) => value >= limit,
            Bound::Between(low, high) => value >= low && value <= high,
        }
    }
}

/// One measured figure against its bound.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Check {
    /// Unique, stable: `study/case/quantity`.
    pub id: String,
    pub study: String,
    /// In words, for people.
    pub quantity: String,
    pub kind: Kind,
    #[serde(deserialize_with = "lost::number")]
    pub value: f64,
    pub bound: Bound,
    /// SI, or `1` for a pure number.
    pub unit: String,
    pub pass: bool,
    /// Where the bound comes from.
    pub source: String,
    /// Text of the smallest case file that shows what broke, for a check that
    /// fails.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reproduce: Option<String>,
    /// Error bar of the reference that the value is measured against, in the
    /// unit of the value: smaller changes cannot be told for better or worse.
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
            source: source.to_string(),
            reproduce: None,
            reference_error: None,
        }
    }

    /// Where a report keeps the case file that shows the failure, relative to
    /// its folder; None where the check passes or has no such case.
    pub fn failure_file(&self) -> Option<String> {
        let shown = !self.pass && self.reproduce.is_some();
        shown.then(|| format!("failures/{}.toml", self.id.replace('/', "-")))
    }
}

/// One study: a claim with its checks, tables and figures.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Study {
    pub id: String,
    pub title: String,
    /// What is claimed, in one or two sentences.
    pub claim: String,
    /// The command that reproduces it.
    pub command: String,
    pub checks: Vec<Check>,
    pub tables: Vec<Table>,
    pub figures: Vec<Figure>,
    /// Findings that are not gated, a paragraph each.
    pub notes: Vec<String>,
    /// A reason why it could not run; a skip is not a pass.
    pub failure: Option<String>,
    #[serde(deserialize_with = "lost::number")]
    pub wall_seconds: f64,
}

/// A table of figures; every column has its unit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Table {
    pub title: String,
    pub columns: Vec<Column>,
    pub rows: Vec<Vec<Cell>>,
}

/// A column heading; `unit` is empty for text.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Column {
    pub name: String,
    pub unit: String,
}

/// A cell of a table.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Cell {
    #[serde(deserialize_with = "lost::number")]
    Number(f64),
    Text(String),
}

/// A picture.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Figure {
    Plot(Plot),
    Drawing(Drawing),
}

/// Curves over two axes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Plot {
    pub title: String,
    pub caption: String,
    pub x: Axis,
    pub y: Axis,
    pub series: Vec<Series>,
    /// Slopes drawn as triangles on log-log axes.
    #[serde(deserialize_with = "lost::numbers")]
    pub slopes: Vec<f64>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Axis {
    pub label: String,
    pub unit: String,
    pub log: bool,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Series {
    pub name: String,
    #[serde(deserialize_with = "lost::points")]
    pub points: Vec<(f64, f64)>,
    /// Half-lengths of vertical error bars; empty for none.
    #[serde(deserialize_with = "lost::numbers")]
    pub error_bars: Vec<f64>,
    pub style: SeriesStyle,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SeriesStyle {
    Line,
    Points,
    LineAndPoints,
}

/// Shapes in a plane with equal scales, such as outlines before and after.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Drawing {
    pub title: String,
    pub caption: String,
    /// Unit of the coordinates.
    pub unit: String,
    pub layers: Vec<Layer>,
}

/// Polylines of one look, drawn in the order of the layers.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Layer {
    pub name: String,
    pub style: LayerStyle,
    /// Index into the palette: layers with the same number share a colour.
    pub colour: usize,
    pub closed: bool,
    #[serde(deserialize_with = "lost::lines")]
    pub lines: Vec<Vec<[f64; 2]>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LayerStyle {
    Outline,
    Dashed,
    Filled,
    Dots,
}

/// A whole run of the harness.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Report {
    pub schema_version: u32,
    pub suite: String,
    pub provenance: Provenance,
    pub studies: Vec<Study>,
    #[serde(deserialize_with = "lost::number")]
    pub wall_seconds: f64,
    /// With a baseline, where one was given.
    pub comparison: Option<Comparison>,
}

/// Which code ran where.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Provenance {
    pub version: String,
    pub commit: String,
    pub compiler: String,
    pub processor: String,
    pub processor_features: String,
    pub threads: usize,
    pub date: String,
}

impl Report {
    /// All checks of all studies.
    pub fn checks(&self) -> impl Iterator<Item = &Check> {
        self.studies.iter().flat_map(|study| &study.checks)
    }

    /// Whether every study ran, every bound is kept and nothing got worse.
    pub fn passed(&self) -> bool {
        self.bounds_hold() && self.comparison.as_ref().is_none_or(Comparison::holds)
    }

    /// Whether every study ran and every bound is kept.
    pub fn bounds_hold(&self) -> bool {
        self.studies.iter().all(|study| study.failure.is_none())
            && self.checks().all(|check| check.pass)
    }
}
