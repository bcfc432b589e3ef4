//! Readers of foreign files: label maps (NRRD, NIfTI), surfaces (STL), node
//! positions (CSV, NPY, VTU, VTK). Everything comes back in metres.

mod error;
pub mod nifti;
pub mod nrrd;
mod nrrd_header;
pub mod points;
pub mod stl;
mod voxels;

pub use error::{FileError, Mistake};

use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::LabelMap;
use std::path::{Path, PathBuf};

/// A unit of length in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthUnit {
    Metre,
    Millimetre,
    Micrometre,
}

impl LengthUnit {
    /// How many metres it is.
    pub fn in_metres(self) -> f64 {
        match self {
            LengthUnit::Metre => 1.0,
            LengthUnit::Millimetre => 1e-3,
            LengthUnit::Micrometre => 1e-6,
        }
    }
}

/// A label map in RAS world coordinates (x right, y anterior, z superior) and
/// the files it came from.
#[derive(Debug, Clone)]
pub struct LabelMapFile {
    pub map: LabelMap,
    /// The file that was asked for first, then a detached data file.
    pub files: Vec<PathBuf>,
}

/// Reads an NRRD or NIfTI label map, told apart by their names; `unit`
/// overrides what the file states.
pub fn read_label_map(path: &Path, unit: Option<LengthUnit>) -> Result<LabelMapFile, FileError> {
    let name = path.to_string_lossy().to_lowercase();
    if name.ends_with(".nrrd") || name.ends_with(".nhdr") {
        nrrd::read(path, unit)
    } else if name.ends_with(".nii") || name.ends_with(".nii.gz") {
        let map = nifti::read(path, unit)?;
        Ok(LabelMapFile { map, files: vec![path.to_path_buf()] })
    } else {
        Err(Mistake::UnknownExtension { known: ".nrrd, .nhdr, .nii, .nii.gz" }.of(path))
    }
}

/// An image in metres from its parts.
fn label_map(
    size: [usize; 3],
    origin: Vector3,
    directions: Matrix3,
    labels: Vec<u32>,
) -> Result<LabelMap, Mistake> {
    LabelMap::new(size, origin, directions, labels).map_err(Mistake::Geometry)
}

/// The bytes of a file.
fn bytes_of(path: &Path) -> Result<Vec<u8>, FileError> {
    std::fs::read(path).map_err(|error| Mistake::Unreadable(error).of(path))
}

#[cfg(test)]
mod label_map_tests;
