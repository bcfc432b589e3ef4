//! Points with a displacement each, from CSV, NPY and VTU files.
#![allow(non_snake_case)]

use super::{npy, vtu};
use crate::files::bytes::bytes_of;
use crate::files::error::{FileError, Mistake};
use mtled::algebra::tensor::Vector3;
use std::path::Path;

/// Columns of a CSV file, in any order among others.
const COLUMNS: [&str; 6] = ["x", "y", "z", "ux", "uy", "uz"];
const HEADER: &str = "a header that names x, y, z, ux, uy and uz";
const ROW: &str = "finite numbers below x, y, z, ux, uy and uz";

/// Points and displacements in the unit of the file, with the format given by the extension
/// of the name: CSV with a header x, y, z, ux, uy, uz; NPY of shape (n, 6); the points of a
/// VTU file with its point data called `name`.
pub fn read_displacements(path: &Path, name: &str) -> Result<Vec<(Vector3, Vector3)>, FileError> {
    let kind = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let parse = |bytes: &[u8]| match kind.as_str() {
        "csv" | "txt" => from_csv(bytes),
        "npy" => {
            let (values, _) = npy::numbers(bytes, &[6], "(n, 6)")?;
            Ok(values.chunks_exact(6).map(pair).collect())
        }
        "vtu" => from_vtu(bytes, name),
        _ => Err(Mistake::UnknownExtension { known: ".csv, .npy, .vtu" }),
    };
    let bytes = bytes_of(path)?;
    parse(&bytes).and_then(finite).map_err(|mistake| mistake.of(path))
}

fn pair(row: &[f64]) -> (Vector3, Vector3) {
    (Vector3::new(row[0], row[1], row[2]), Vector3::new(row[3], row[4], row[5]))
}

fn finite(data: Vec<(Vector3, Vector3)>) -> Result<Vec<(Vector3, Vector3)>, Mistake> {
    let is_finite = |(X, u): &(Vector3, Vector3)| X.iter().chain(u).all(|c| c.is_finite());
    match data.iter().position(|row| !is_finite(row)) {
        None => Ok(data),
        Some(point) => Err(Mistake::NotFinite { point: point + 1 }),
    }
}

fn from_vtu(bytes: &[u8], name: &str) -> Result<Vec<(Vector3, Vector3)>, Mistake> {
    let (points, values) = (vtu::parse(bytes)?, vtu::point_data(bytes, name)?);
    match points.len() == values.len() {
        true => Ok(points.into_iter().zip(values).collect()),
        false => Err(Mistake::VectorCount {
            name: name.to_string(),
            points: points.len(),
            values: values.len(),
        }),
    }
}

fn from_csv(bytes: &[u8]) -> Result<Vec<(Vector3, Vector3)>, Mistake> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(bytes);
    let undecodable =
        |error: csv::Error| Mistake::Undecodable { encoding: "CSV", reason: error.to_string() };
    let bad = |row: &csv::StringRecord, expected| {
        let line = row.position().map_or(1, |position| position.line() as usize);
        let text = row.iter().collect::<Vec<_>>().join(",");
        Mistake::BadLine { line, text: text.chars().take(60).collect(), expected }
    };
    let header = reader.headers().map_err(undecodable)?.clone();
    let column = |name: &str| header.iter().position(|cell| cell.eq_ignore_ascii_case(name));
    let columns: Option<Vec<usize>> = COLUMNS.into_iter().map(column).collect();
    let columns = columns.ok_or_else(|| bad(&header, HEADER))?;
    let rows = reader.records().map(|row| {
        let row = row.map_err(undecodable)?;
        let cell = |&column: &usize| row.get(column).and_then(|cell| cell.parse::<f64>().ok());
        let values: Option<Vec<f64>> = columns.iter().map(cell).collect();
        let values = values.filter(|values| values.iter().all(|value| value.is_finite()));
        values.map(|values| pair(&values)).ok_or_else(|| bad(&row, ROW))
    });
    rows.collect()
}
