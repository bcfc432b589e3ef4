//! Plots and drawings.

use super::nan_as_null;
use serde::{Deserialize, Serialize};

/// A picture.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Figure {
    /// Curves over two axes.
    Plot(Plot),
    /// Shapes in a plane.
    Drawing(Drawing),
}

/// Curves over two axes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Plot {
    /// Heading.
    pub title: String,
    /// Explanation below the figure.
    pub caption: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// The curves.
    pub series: Vec<Series>,
    /// Slopes drawn as triangles on log-log axes.
    #[serde(deserialize_with = "nan_as_null::numbers")]
    pub slopes: Vec<f64>,
}

/// An axis of a plot.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Axis {
    /// What is plotted along it.
    pub label: String,
    /// SI, or `1` for a pure number.
    pub unit: String,
    /// Whether its scale is logarithmic.
    pub log: bool,
}

/// One curve of a plot.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Series {
    /// Its entry in the legend.
    pub name: String,
    /// (x, y) in the units of the axes; NaN interrupts the curve.
    #[serde(deserialize_with = "nan_as_null::points")]
    pub points: Vec<(f64, f64)>,
    /// Half-lengths of vertical error bars; empty for none.
    #[serde(deserialize_with = "nan_as_null::numbers")]
    pub error_bars: Vec<f64>,
    /// How it is drawn.
    pub style: SeriesStyle,
}

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SeriesStyle {
    /// A line.
    Line,
    /// A mark at each point.
    Points,
    /// A line with a mark at each point.
    LineAndPoints,
}

/// An axis of this label and unit.
pub fn axis(label: &str, unit: &str, log: bool) -> Axis {
    Axis { label: label.into(), unit: unit.into(), log }
}

/// A line with a mark at each point.
pub fn curve(name: &str, points: Vec<(f64, f64)>) -> Series {
    styled(name, points, SeriesStyle::LineAndPoints)
}

/// A plain line.
pub fn line(name: &str, points: Vec<(f64, f64)>) -> Series {
    styled(name, points, SeriesStyle::Line)
}

/// A curve of this style without error bars.
pub fn styled(name: &str, points: Vec<(f64, f64)>, style: SeriesStyle) -> Series {
    Series { name: name.into(), points, error_bars: Vec::new(), style }
}

/// Shapes in a plane with equal scales, such as outlines before and after.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Drawing {
    /// Heading.
    pub title: String,
    /// Explanation below the figure.
    pub caption: String,
    /// Unit of the coordinates.
    pub unit: String,
    /// From the back to the front.
    pub layers: Vec<Layer>,
}

/// Polylines of one style.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Layer {
    /// Its entry in the legend, empty for none.
    pub name: String,
    /// How it is drawn.
    pub style: LayerStyle,
    /// Index into the palette: layers with the same number share a colour.
    pub colour: usize,
    /// Whether the last point is joined to the first.
    pub closed: bool,
    /// Points (x, y) \[line\]\[point\]; NaN interrupts a line.
    #[serde(deserialize_with = "nan_as_null::lines")]
    pub lines: Vec<Vec<[f64; 2]>>,
}

/// How the lines of a layer are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LayerStyle {
    /// Solid lines.
    Outline,
    /// Dashed lines.
    Dashed,
    /// Closed lines, filled.
    Filled,
    /// A dot at each point.
    Dots,
}
