//! Tables of figures.

use serde::de::{Deserializer, Error, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A table of figures; every column has its unit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Table {
    /// Heading.
    pub title: String,
    /// One heading per cell of a row.
    pub columns: Vec<Column>,
    /// Cells \[row\]\[column\].
    pub rows: Vec<Vec<Cell>>,
}

/// A column heading.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Column {
    /// What the column holds.
    pub name: String,
    /// SI, `1` for pure numbers, empty for text.
    pub unit: String,
}

/// A column of text.
pub fn text(name: &str) -> Column {
    Column { name: name.into(), unit: String::new() }
}

/// A column of numbers.
pub fn number(name: &str, unit: &str) -> Column {
    Column { name: name.into(), unit: unit.into() }
}

/// A cell of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cell {
    /// In the unit of its column; NaN, written as `null`, for none.
    Number(f64),
    /// A text.
    Text(String),
}

impl<'d> Deserialize<'d> for Cell {
    fn deserialize<D: Deserializer<'d>>(reader: D) -> Result<Cell, D::Error> {
        reader.deserialize_any(CellVisitor)
    }
}

/// Written out because the derived reader would copy every cell first.
struct CellVisitor;

impl Visitor<'_> for CellVisitor {
    type Value = Cell;

    fn expecting(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str("a number, null or a text")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Cell, E> {
        Ok(Cell::Number(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Cell, E> {
        Ok(Cell::Number(value as f64))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Cell, E> {
        Ok(Cell::Number(value as f64))
    }

    fn visit_unit<E: Error>(self) -> Result<Cell, E> {
        Ok(Cell::Number(f64::NAN))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Cell, E> {
        Ok(Cell::Text(text.to_string()))
    }
}
