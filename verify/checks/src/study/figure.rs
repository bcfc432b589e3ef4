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
    /// Small figures side by side.
    Panels(Panels),
}

/// Small plots or drawings side by side under one heading. The scales of plots are the same, and
/// so is their legend, which is that of the first.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Panels {
    /// Heading.
    pub title: String,
    /// Explanation below the figure.
    pub caption: String,
    /// Each with a title of its own; their captions are not shown.
    pub panels: Vec<Figure>,
}

impl Figure {
    /// Heading.
    pub fn title(&self) -> &str {
        match self {
            Figure::Plot(plot) => &plot.title,
            Figure::Drawing(drawing) => &drawing.title,
            Figure::Panels(panels) => &panels.title,
        }
    }

    /// Explanation below the figure.
    pub(crate) fn caption(&self) -> &str {
        match self {
            Figure::Plot(plot) => &plot.caption,
            Figure::Drawing(drawing) => &drawing.caption,
            Figure::Panels(panels) => &panels.caption,
        }
    }
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
    /// Names of 0, 1, 2 … in place of numbers, from the top; empty for an axis of numbers. Only on
    /// the vertical axis.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub names: Vec<String>,
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
    /// Number of its colour and mark; that of its place among the curves where it is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<usize>,
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
    /// Marks that point to smaller x: upper bounds.
    AtMost,
    /// Marks that point to larger x: lower bounds.
    AtLeast,
    /// The area below the largest y is shaded over the whole width: nothing is decided there,
    /// and marks of other curves in it are faint.
    Floor,
}

/// An axis of this label and unit.
pub fn axis(label: &str, unit: &str, log: bool) -> Axis {
    Axis { label: label.into(), unit: unit.into(), log, names: Vec::new() }
}

/// An axis with a name in place of each of 0, 1, 2 …
pub fn names_axis(label: &str, names: Vec<String>) -> Axis {
    Axis { names, ..axis(label, "1", false) }
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
    Series { name: name.into(), points, error_bars: Vec::new(), style, colour: None }
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
    /// What the colours of [`LayerStyle::Band`] mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<ColourScale>,
}

/// Colours of a quantity, one for each band of its values.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ColourScale {
    /// The quantity.
    pub label: String,
    /// Its unit.
    pub unit: String,
    /// Ends of the bands, from the smallest: one more than there are bands.
    #[serde(deserialize_with = "nan_as_null::numbers")]
    pub edges: Vec<f64>,
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
    /// Closed lines, filled with the colour of the band of the drawing's scale that the number of
    /// the layer's colour is, from 0.
    Band,
}
