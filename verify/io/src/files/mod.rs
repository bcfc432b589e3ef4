//! Files of other programs: label maps (NRRD, NIfTI), surfaces (STL, OBJ, PLY, VTK), node positions (CSV, NPY,
//! VTU, VTK) and landmarks (CSV) are read, images (NRRD, NIfTI) read and written. All lengths
//! inside are in metres.

mod bytes;
mod error;
pub mod image;
pub mod nifti;
pub mod nrrd;
mod nrrd_header;
pub mod points;
mod shear;
pub mod surface;
mod unit;
mod voxels;
mod vtk_xml;

pub use bytes::visit_bytes;
pub use error::{FileError, Mistake};
pub use unit::LengthUnit;
pub(crate) use voxels::LabelMapFile;

use std::path::Path;

/// Reads an NRRD or NIfTI label map, told apart by their names; `unit`
/// overrides what the file states, and `layer` says which layer of overlapping segments is read.
pub fn read_label_map(
    path: &Path,
    unit: Option<LengthUnit>,
    layer: Option<usize>,
) -> Result<LabelMapFile, FileError> {
    let name = path.to_string_lossy().to_lowercase();
    if name.ends_with(".nrrd") || name.ends_with(".nhdr") {
        nrrd::read(path, unit, layer)
    } else if [".nii", ".hdr", ".img"]
        .iter()
        .any(|ending| name.strip_suffix(".gz").unwrap_or(&name).ends_with(ending))
    {
        match layer {
            None | Some(0) => nifti::read(path, unit),
            Some(layer) => Err(Mistake::NoSuchLayer { layer, layers: 1 }.of(path)),
        }
    } else {
        let known = ".nrrd, .nhdr, .nii, .nii.gz, .hdr, .img, .hdr.gz, .img.gz";
        Err(Mistake::UnknownImage { known }.of(path))
    }
}

#[cfg(test)]
mod label_map_tests;
