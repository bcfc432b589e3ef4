//! Points from rows of coordinates.

use mtled::algebra::tensor::Vector3;

/// Points from coordinates in rows of `columns` (2 or 3) numbers.
pub fn from_rows(values: &[f64], columns: usize) -> Vec<Vector3> {
    let rows = values.chunks_exact(columns);
    rows.map(|row| Vector3::new(row[0], row[1], row.get(2).copied().unwrap_or(0.0))).collect()
}
