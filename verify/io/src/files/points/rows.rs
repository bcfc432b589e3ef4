//! Points from rows of coordinates.

use crate::files::error::Mistake;
use mtled::algebra::tensor::Vector3;

/// Points from coordinates in rows of `columns` (2 or 3) numbers.
pub(crate) fn from_rows(values: &[f64], columns: usize) -> Vec<Vector3> {
    let rows = values.chunks_exact(columns);
    rows.map(|row| Vector3::new(row[0], row[1], row.get(2).copied().unwrap_or(0.0))).collect()
}

/// Points from three coordinates each, of which the file states the number.
pub(crate) fn from_stated(values: &[f64], points: usize) -> Result<Vec<Vector3>, Mistake> {
    let (expected, found) = (points.saturating_mul(3), values.len());
    if expected == found {
        Ok(from_rows(values, 3))
    } else {
        Err(Mistake::CoordinateCount { points, expected, found })
    }
}
