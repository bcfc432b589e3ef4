//! NIfTI images, `.nii` and `.nii.gz`; pairs and those of version 2 are only read.

use super::format::{ImageFormat, gzip};
use super::grid::Grid;
use super::nifti_header::{VOXELS_AT, header};
use super::voxels::{Header, Image};
use crate::files::bytes::{ByteOrder, Scalar};
use crate::files::error::{FileError, Mistake};
use crate::files::nifti::{Content, read_voxels};
use crate::files::unit::LengthUnit;
use std::path::Path;

/// Reads an image; NIfTI is RAS already.
pub(crate) fn read(path: &Path, unit: Option<LengthUnit>) -> Result<Image, FileError> {
    let voxels = read_voxels(path, Content::Numbers)?;
    let grid = voxels
        .frame(unit)
        .and_then(|(origin, directions)| Grid::new(voxels.size, origin, directions));
    Ok(Image {
        grid: grid.map_err(|mistake| mistake.of(path))?,
        scalar: voxels.scalar,
        order: voxels.order,
        stored: voxels.stored,
        notes: voxels.notes,
        header: Header::Nifti { bytes: voxels.header_bytes, scaling: voxels.scaling },
    })
}

/// The header of a NIfTI-1 image in one piece is kept, without extensions; another gets one of
/// its grid.
pub(crate) fn image(image: &Image, voxels: &[u8], format: ImageFormat) -> Result<Vec<u8>, Mistake> {
    let (mut bytes, order) = match &image.header {
        Header::Nifti { bytes: Some(bytes), .. } => {
            let mut bytes = bytes.clone();
            bytes.resize(VOXELS_AT, 0);
            let start = VOXELS_AT as f32;
            bytes[108..112].copy_from_slice(&match image.order {
                ByteOrder::Little => start.to_le_bytes(),
                ByteOrder::Big => start.to_be_bytes(),
            });
            (bytes, image.order)
        }
        Header::Nifti { bytes: None, scaling: (slope, intercept) } => {
            let mut bytes = header(&image.grid, image.scalar, false)?;
            bytes[112..116].copy_from_slice(&(*slope as f32).to_le_bytes());
            bytes[116..120].copy_from_slice(&(*intercept as f32).to_le_bytes());
            (bytes, ByteOrder::Little)
        }
        Header::Nrrd { .. } => (header(&image.grid, image.scalar, false)?, ByteOrder::Little),
    };
    if order == image.order {
        bytes.extend(voxels);
    } else {
        let words = voxels.chunks_exact(image.scalar.size());
        bytes.extend(words.flat_map(|word| word.iter().rev()));
    }
    finish(bytes, format)
}

/// Five axes, the fourth of one entry, the fifth of the components along L, P and S \[mm\].
pub(crate) fn field(
    grid: &Grid,
    vectors: &[[f32; 3]],
    format: ImageFormat,
) -> Result<Vec<u8>, Mistake> {
    let mut bytes = header(grid, Scalar::F32, true)?;
    bytes.reserve(12 * vectors.len());
    for (component, factor) in [-1e3, -1e3, 1e3].into_iter().enumerate() {
        for vector in vectors {
            let value = factor * f64::from(vector[component]);
            bytes.extend((value as f32).to_le_bytes());
        }
    }
    finish(bytes, format)
}

fn finish(bytes: Vec<u8>, format: ImageFormat) -> Result<Vec<u8>, Mistake> {
    match format {
        ImageFormat::NiftiGz => gzip(&bytes),
        ImageFormat::Nifti | ImageFormat::Nrrd => Ok(bytes),
    }
}
