//! Images of one value per voxel (NIfTI, NRRD), read and written with their grid, and fields
//! of vectors on such a grid.

mod format;
mod grid;
mod nifti;
mod nifti_header;
mod nrrd;
mod vectors;
mod voxels;

pub use format::ImageFormat;
pub use grid::Grid;
pub use vectors::{VectorFile, VectorFrame, read_vectors};
pub use voxels::{Image, Interpolation};

use super::error::FileError;
use super::unit::LengthUnit;
use std::path::Path;

/// Whether a file is an image by its name.
pub fn is_image(path: &Path) -> bool {
    ImageFormat::of_input(path).is_ok()
}

/// Reads an image, told apart by its name; `unit` overrides what the file states.
pub fn read_image(path: &Path, unit: Option<LengthUnit>) -> Result<Image, FileError> {
    match ImageFormat::of_input(path)? {
        ImageFormat::Nifti | ImageFormat::NiftiGz => nifti::read(path, unit),
        ImageFormat::Nrrd => nrrd::read(path, unit),
    }
}

/// The bytes of a file with the grid, the type and, where the format is the same, the header of
/// `image`, and other voxels, stored as those of `image`. `path` is for messages.
pub fn image_bytes(
    image: &Image,
    voxels: &[u8],
    format: ImageFormat,
    path: &Path,
) -> Result<Vec<u8>, FileError> {
    match format {
        ImageFormat::Nifti | ImageFormat::NiftiGz => nifti::image(image, voxels, format),
        ImageFormat::Nrrd => nrrd::image(image, voxels),
    }
    .map_err(|mistake| mistake.of(path))
}

/// The bytes of a file of displacement vectors on a grid, as ITK reads them: vectors \[mm\] along
/// L, P, S from `vectors` \[voxel\] \[m\] along R, A, S, in single precision. NIfTI has five axes
/// and the intent 1007, NRRD the kind `vector` on its first axis.
pub fn field_bytes(
    grid: &Grid,
    vectors: &[[f32; 3]],
    format: ImageFormat,
    path: &Path,
) -> Result<Vec<u8>, FileError> {
    match format {
        ImageFormat::Nifti | ImageFormat::NiftiGz => nifti::field(grid, vectors, format),
        ImageFormat::Nrrd => nrrd::field(grid, vectors),
    }
    .map_err(|mistake| mistake.of(path))
}
