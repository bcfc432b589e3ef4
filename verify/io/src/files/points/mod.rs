//! Node positions \[m\] from CSV, NPY, VTU and legacy VTK files, and points with
//! displacements from the first three; meshes from VTU files.

mod csv;
mod displacements;
mod landmarks;
mod legacy_vtk;
mod npy;
mod rows;
mod vtu;
mod vtu_mesh;

use super::bytes::bytes_of;
use super::error::{FileError, Mistake, check_finite};
use mtled::algebra::tensor::Vector3;
use std::path::Path;

pub use displacements::read_displacements;
pub use landmarks::{Landmark, read_landmarks, read_named_points};
pub use vtu_mesh::{MeshFile, NamedArray, read_mesh};

/// Reads node positions, with the format given by the extension of the name. Files of two
/// columns get z = 0.
pub fn read(path: &Path) -> Result<Vec<Vector3>, FileError> {
    let kind = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let parse = match kind.as_str() {
        "csv" | "txt" => csv::parse,
        "npy" => npy::parse,
        "vtu" => vtu::parse,
        "vtk" => legacy_vtk::parse,
        _ => return Err(Mistake::UnknownExtension { known: ".csv, .npy, .vtu, .vtk" }.of(path)),
    };
    let bytes = bytes_of(path)?;
    parse(&bytes).and_then(checked).map_err(|mistake| mistake.of(path))
}

fn checked(points: Vec<Vector3>) -> Result<Vec<Vector3>, Mistake> {
    if points.is_empty() {
        return Err(Mistake::NoPoints);
    }
    check_finite(&points)?;
    Ok(points)
}

#[cfg(test)]
mod tests;
