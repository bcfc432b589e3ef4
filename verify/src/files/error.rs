//! Why a file cannot be used, and what to do about it.

use mtled::geometry::GeometryError;
use std::path::{Path, PathBuf};

/// A file and what is wrong with it.
#[derive(Debug, thiserror::Error)]
#[error("{}: {mistake}", path.display())]
pub struct FileError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub mistake: Mistake,
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // The messages say it.
pub enum Mistake {
    #[error("the file cannot be read: {0}")]
    Unreadable(std::io::Error),
    #[error("this is a folder, a device or a pipe; a file is needed")]
    NotAFile,
    #[error("the file has {length} bytes; at most {longest} are read")]
    TooLong { length: u64, longest: u64 },
    #[error("the kind of file is not known; its name must end in one of {known}")]
    UnknownExtension { known: &'static str },
    #[error("this is not {format}: it starts with `{start}`")]
    WrongFormat { format: &'static str, start: String },
    #[error("the header has no `{field}`, which this file needs")]
    MissingField { field: &'static str },
    #[error("the header field `{field}` is `{value}`; expected {expected}")]
    BadField { field: &'static str, value: String, expected: &'static str },
    #[error("line {line} of the header is `{text}`; expected `field: value`")]
    BadHeaderLine { line: usize, text: String },
    #[error(
        "the file is truncated: its header states {expected} bytes of data, there are {found}; copy or export it again"
    )]
    Truncated { expected: usize, found: usize },
    #[error(
        "there are more data than the {expected} bytes, or numbers of text, that the header states; \
             its sizes or its type are wrong"
    )]
    Excess { expected: usize },
    #[error("the header ends after {found} bytes; the file is truncated or damaged")]
    TruncatedHeader { found: usize },
    #[error("the {encoding} data cannot be decoded: {reason}; the file is damaged")]
    Undecodable { encoding: &'static str, reason: String },
    #[error(
        "sizes {sizes:?} are no voxels, or more than the {most} that can be used; crop the image"
    )]
    BadSizes { sizes: Vec<usize>, most: usize },
    #[error("the header has no end in its first {longest} bytes")]
    LongHeader { longest: u64 },
    #[error("voxel {voxel} is {value}; labels must be whole numbers from 0 to 4294967295")]
    NotALabel { voxel: usize, value: f64 },
    #[error(
        "voxel {voxel} is {value}, larger than any label; the byte order of the header ({order} endian) is wrong, or this is not a label map"
    )]
    LabelTooLarge { voxel: usize, value: f64, order: &'static str },
    #[error("{0}")]
    Geometry(GeometryError),
    #[error("line {line} is `{text}`; expected {expected}")]
    BadLine { line: usize, text: String, expected: &'static str },
    #[error("the text ends in line {line}; expected {expected}: copy or export it again")]
    TextEnds { line: usize, expected: &'static str },
    #[error("the array has shape {shape:?} and type {kind}; expected {expected} of floats")]
    BadArray { shape: Vec<u64>, kind: String, expected: &'static str },
    #[error("there is no point data of three components called `{name}`; the file has {known}")]
    NoPointData { name: String, known: String },
    #[error("there are {points} points and {values} vectors in `{name}`")]
    VectorCount { name: String, points: usize, values: usize },
    #[error("the file states {points} points, which are {expected} coordinates, and has {found}")]
    CoordinateCount { points: usize, expected: usize, found: usize },
    #[error(
        "the file has {pieces} pieces; merge them into one, or only a part of the nodes is read"
    )]
    SeveralPieces { pieces: usize },
    #[error("point {point} has a coordinate that is not finite; points count from 1")]
    NotFinite { point: usize },
    #[error("there are no points in the file")]
    NoPoints,
    #[error("there are no triangles in the file")]
    NoTriangles,
}

impl Mistake {
    /// A header field with a value that cannot be used.
    pub(super) fn bad_field(field: &'static str, value: &str, expected: &'static str) -> Mistake {
        Mistake::BadField { field, value: value.to_string(), expected }
    }

    /// The mistake as that of a file.
    pub fn of(self, path: &Path) -> FileError {
        FileError { path: path.to_path_buf(), mistake: self }
    }
}
