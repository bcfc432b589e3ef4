//! Why a file cannot be used, and what to do about it.

use mtled::algebra::tensor::Vector3;
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
    #[error(
        "the kind of file is not known; its name must end in one of {known}: save it as one of these, \
         for example with 3D Slicer (mgz: mri_convert)"
    )]
    UnknownImage { known: &'static str },
    #[error(
        "the kind of file is not known; a surface is read from .stl, .obj, .ply, .vtp and .vtk: \
         export it as one of these, for example with 3D Slicer, ParaView or MeshLab"
    )]
    UnknownSurface,
    #[error(
        "the name ends in .{named}, but the content is that of a .{extension} file; name it so"
    )]
    OtherSurface { named: &'static str, extension: &'static str },
    #[error("this is {found}, no surface; {remedy}")]
    NoSurface { found: &'static str, remedy: &'static str },
    #[error("this is not {format}: it starts with `{start}`")]
    WrongFormat { format: &'static str, start: String },
    #[error(
        "the file has {layers} layers of segments that overlap; say by the key `layer` which one to take: \
         {found}"
    )]
    SeveralLayers { layers: usize, found: String },
    #[error("there is no layer {layer}; the file has {layers}, counted from 0")]
    NoSuchLayer { layer: usize, layers: usize },
    #[error("the header has no `{field}`, which this file needs")]
    MissingField { field: &'static str },
    #[error("the header field `{field}` is `{value}`; expected {expected}")]
    BadField { field: &'static str, value: String, expected: &'static str },
    #[error(
        "NIfTI does not say along what its vectors are measured; say it by the key `frame`: \"lps\" \
         (displacements of ITK, ANTs and 3D Slicer), \"ras\", or \"fsl\" (directions of dtifit)"
    )]
    NoVectorFrame,
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
    #[error(
        "voxel {voxel} is {value}; labels must be whole numbers from 0 to 4294967295: of an image of \
         grey values or probabilities make a label map first, by a threshold"
    )]
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
    #[error(
        "line {line} is `{text}`, which uses point {point}, and the file has {count}; points count from 1"
    )]
    LineWithoutPoint { line: usize, text: String, point: u64, count: usize },
    #[error("face {face} uses point {point}, and the file has {count}; both count from 1")]
    NoSuchPoint { face: usize, point: u64, count: usize },
    #[error(
        "face {face}, near {at:?} m, crosses itself and cannot be cut into triangles; mend it, or \
         export triangles"
    )]
    CrossedFace { face: usize, at: [f64; 3] },
    #[error("face {face} has {corners} corners, and {most} are read at most; export triangles")]
    LargeFace { face: usize, corners: usize, most: usize },
    #[error("{bytes} bytes follow what the header states; its counts or its types are wrong")]
    DataBehind { bytes: usize },
    #[error("the file is truncated: {reason}; copy or export it again")]
    EndsEarly { reason: String },
    #[error(
        "there are {found} of {expected} numbers in `{field}`; the file is truncated, or its count is wrong"
    )]
    FewNumbers { field: &'static str, expected: usize, found: usize },
    #[error("the {what} of the cells do not match their points; the file is damaged")]
    BadCells { what: &'static str },
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

    /// A line that is not what was expected.
    pub(super) fn bad_line(line: usize, text: &str, expected: &'static str) -> Mistake {
        Mistake::BadLine { line, text: shown(text), expected }
    }

    /// Cells whose counts or offsets have no sense.
    pub(super) fn bad_cells(what: &'static str) -> Mistake {
        Mistake::BadCells { what }
    }

    /// The mistake as that of a file.
    pub fn of(self, path: &Path) -> FileError {
        FileError { path: path.to_path_buf(), mistake: self }
    }
}

/// Refuses points of which a coordinate is infinite or no number.
pub(super) fn check_finite(points: &[Vector3]) -> Result<(), Mistake> {
    match points.iter().position(|point| !point.iter().all(|c| c.is_finite())) {
        Some(point) => Err(Mistake::NotFinite { point: point + 1 }),
        None => Ok(()),
    }
}

/// The beginning of a line for a message, without control characters.
pub(super) fn shown(text: &str) -> String {
    const SHOWN: usize = 60;
    let plain = |c: char| if c.is_control() { ' ' } else { c };
    text.trim().chars().take(SHOWN).map(plain).collect()
}
