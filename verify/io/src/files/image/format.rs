//! Formats of images by the endings of their names.

use crate::files::error::{FileError, Mistake};
use flate2::{Compression, write::GzEncoder};
use std::io::Write;
use std::path::Path;

/// How an image is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImageFormat {
    /// `.nii`
    Nifti,
    /// `.nii.gz`
    NiftiGz,
    /// `.nrrd`
    Nrrd,
}

impl ImageFormat {
    /// The format of a file that is to be written.
    pub fn of_output(path: &Path) -> Result<ImageFormat, FileError> {
        of(path).ok_or_else(|| Mistake::UnknownExtension { known: ".nii, .nii.gz, .nrrd" }.of(path))
    }

    /// The format of a file that is to be read.
    pub(crate) fn of_input(path: &Path) -> Result<ImageFormat, FileError> {
        let name = path.to_string_lossy().to_lowercase();
        let is = |endings: &[&str]| endings.iter().any(|ending| name.ends_with(ending));
        let known = ".nrrd, .nhdr, .nii, .nii.gz, .hdr, .img, .hdr.gz, .img.gz";
        let found = match () {
            () if is(&[".nhdr"]) => Some(ImageFormat::Nrrd),
            () if is(&[".hdr", ".img"]) => Some(ImageFormat::Nifti),
            () if is(&[".hdr.gz", ".img.gz"]) => Some(ImageFormat::NiftiGz),
            () => of(path),
        };
        found.ok_or_else(|| Mistake::UnknownExtension { known }.of(path))
    }
}

fn of(path: &Path) -> Option<ImageFormat> {
    let name = path.to_string_lossy().to_lowercase();
    let endings = [
        (".nii", ImageFormat::Nifti),
        (".nii.gz", ImageFormat::NiftiGz),
        (".nrrd", ImageFormat::Nrrd),
    ];
    endings.into_iter().find(|(ending, _)| name.ends_with(ending)).map(|(_, format)| format)
}

/// Bytes compressed by gzip, the same for the same bytes.
pub(crate) fn gzip(bytes: &[u8]) -> Result<Vec<u8>, Mistake> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).map_err(Mistake::Unreadable)
}
