//! Short words for the plain data of a study.

use crate::study::{Axis, Column, Series, SeriesStyle};

/// A column of text.
pub fn text(name: &str) -> Column {
    Column { name: name.into(), unit: String::new() }
}

/// A column of numbers.
pub fn number(name: &str, unit: &str) -> Column {
    Column { name: name.into(), unit: unit.into() }
}

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

pub fn styled(name: &str, points: Vec<(f64, f64)>, style: SeriesStyle) -> Series {
    Series { name: name.into(), points, error_bars: Vec::new(), style }
}

/// Like `f64::max`, but NaN wins.
pub fn larger(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}
