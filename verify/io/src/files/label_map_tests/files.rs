//! Small files, and how they are read.

use crate::files::{LabelMapFile, Mistake, read_label_map};
use flate2::{Compression, write::GzEncoder};
use mtled::geometry::LabelMap;
use std::io::Write;

/// Reads bytes as a file of this name in a folder of its own.
pub(crate) fn read_as(name: &str, bytes: &[u8]) -> Result<LabelMap, Mistake> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read_label_map(&path, None, None).map(|read| read.map).map_err(|error| error.mistake)
}

/// As [`read_as`], with what is said about the labels.
pub(crate) fn read_noted(name: &str, bytes: &[u8]) -> LabelMapFile {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read_label_map(&path, None, None).unwrap()
}

pub(crate) fn nrrd_text(header: &str, data: &[u8]) -> Vec<u8> {
    [b"NRRD0004\n", header.as_bytes(), b"\n", data].concat()
}

pub(crate) fn gzip(data: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(data).unwrap();
    encoder.finish().unwrap()
}

/// Eight voxels with labels 0 to 7.
pub(crate) const SMALL: &str = "type: uint8\ndimension: 3\nsizes: 2 2 2\nspacings: 1 2 3\n";
pub(crate) const LABELS: [u8; 8] = [0, 1, 2, 3, 4, 5, 6, 7];
