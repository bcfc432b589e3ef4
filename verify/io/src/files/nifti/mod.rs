//! NIfTI images, versions 1 and 2: `.nii`, and pairs of `.hdr` and `.img`, compressed or not
//! (nifti.nimh.nih.gov/nifti-1, nifti-2).

mod frame;
mod second;

use super::bytes::{self, ByteOrder, Scalar, at_most, open, skip, start_of, voxel_bytes};
use super::error::{FileError, Mistake};
use super::unit::LengthUnit;
use super::voxels::{self, LabelMapFile, Labels};
use flate2::bufread::MultiGzDecoder;
use frame::{doubts, finite, frame};
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::LabelMap;
use nifti::{Endianness, NiftiHeader, NiftiType};
use std::io::{BufRead, Read};
use std::path::{Path, PathBuf};

/// Length of a header of version 1 \[byte\].
const HEADER: usize = 348;

/// Reads a label map; NIfTI is RAS already. `unit` overrides the file's.
pub(crate) fn read(path: &Path, unit: Option<LengthUnit>) -> Result<LabelMapFile, FileError> {
    let voxels = read_voxels(path, Content::Numbers)?;
    let files = voxels.files.clone();
    let (map, notes) = voxels.labels(unit).map_err(|mistake| mistake.of(path))?;
    Ok(LabelMapFile { map, files, notes })
}

/// What a voxel holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Content {
    /// One number.
    Numbers,
    /// The components of a vector: all first ones, then all second and all third.
    Vectors,
}

/// An image as it stands in its file.
pub(super) struct Voxels {
    pub header: NiftiHeader,
    /// The bytes of a header of version 1 in one piece with its voxels.
    pub header_bytes: Option<Vec<u8>>,
    pub size: [usize; 3],
    pub scalar: Scalar,
    pub order: ByteOrder,
    /// Slope and intercept of the stored values.
    pub scaling: (f64, f64),
    /// Stored values, first index fastest.
    pub stored: Vec<u8>,
    /// The file that was named, then the other of a pair.
    pub files: Vec<PathBuf>,
    /// Reasons to doubt where the voxels lie.
    pub notes: Vec<String>,
}

/// A header, and where it came from.
struct Start {
    header: NiftiHeader,
    bytes: Vec<u8>,
    /// Whether the voxels are in a file of their own.
    in_pair: bool,
}

/// Reads an image, compressed or not.
pub(super) fn read_voxels(path: &Path, content: Content) -> Result<Voxels, FileError> {
    let Some((header_file, voxel_file)) = pair(path) else {
        let voxels =
            parse_voxels(decompressed(path)?, content).map_err(|mistake| mistake.of(path))?;
        return Ok(Voxels { files: vec![path.to_path_buf()], ..voxels });
    };
    let start = read_header(&mut decompressed(&header_file)?);
    let start = start.map_err(|mistake| mistake.of(&header_file))?;
    if !start.in_pair {
        let expected = "`ni1` or `ni2` beside an .img file; name it .nii";
        return Err(Mistake::bad_field("magic", "n+1", expected).of(&header_file));
    }
    let voxels = parse_behind(start, decompressed(&voxel_file)?, 0, content);
    let other = if path == header_file { voxel_file.clone() } else { header_file };
    let voxels = voxels.map_err(|mistake| mistake.of(&voxel_file))?;
    Ok(Voxels { files: vec![path.to_path_buf(), other], ..voxels })
}

/// The files of header and voxels, if the name is that of one of such a pair.
fn pair(path: &Path) -> Option<(PathBuf, PathBuf)> {
    let name = path.to_string_lossy();
    let is_end = |at: usize, ending: &str| {
        name.get(at..at + ending.len()).is_some_and(|end| end.eq_ignore_ascii_case(ending))
    };
    let zip = name.len().checked_sub(3).filter(|&at| is_end(at, ".gz")).unwrap_or(name.len());
    let stem = zip.checked_sub(4)?;
    let with = |ending: &str| PathBuf::from(format!("{}{ending}{}", &name[..stem], &name[zip..]));
    match (is_end(stem, ".hdr"), is_end(stem, ".img")) {
        (true, _) => Some((path.to_path_buf(), with(".img"))),
        (_, true) => Some((with(".hdr"), path.to_path_buf())),
        _ => None,
    }
}

fn decompressed(path: &Path) -> Result<Box<dyn Read>, FileError> {
    let (mut file, _) = open(path)?;
    let start = file.fill_buf().map_err(|error| Mistake::Unreadable(error).of(path))?;
    Ok(if start.starts_with(&[0x1f, 0x8b]) {
        Box::new(MultiGzDecoder::new(file))
    } else {
        Box::new(file)
    })
}

pub(super) fn parse_voxels(mut stream: impl Read, content: Content) -> Result<Voxels, Mistake> {
    let start = read_header(&mut stream)?;
    if start.in_pair {
        let expected = "`n+1`; name the .hdr file of a pair, with its .img file beside it";
        return Err(Mistake::bad_field("magic", "ni1", expected));
    }
    let before = start.bytes.len() as u64;
    parse_behind(start, stream, before, content)
}

/// The voxels in a stream of which the first bytes `before` have been read.
fn parse_behind(
    start: Start,
    mut stream: impl Read,
    before: u64,
    content: Content,
) -> Result<Voxels, Mistake> {
    let Start { header, bytes, in_pair } = start;
    let size = size(&header, content)?;
    frame(&header)?;
    let notes = doubts(&header, size)?;
    let order = match header.endianness {
        Endianness::Little => ByteOrder::Little,
        Endianness::Big => ByteOrder::Big,
    };
    let (scalar, count) = (scalar(&header)?, voxels::voxel_count(&size)? * content.count());
    let scaling = scaling(&header)?;
    skip(&mut stream, offset(&header)?.saturating_sub(before))?;
    let (stored, _) = voxel_bytes(stream, count * scalar.size())?;
    let header_bytes = (!in_pair && bytes.len() == HEADER).then_some(bytes);
    let files = Vec::new();
    Ok(Voxels { header, header_bytes, size, scalar, order, scaling, stored, files, notes })
}

impl Content {
    fn count(self) -> usize {
        match self {
            Content::Numbers => 1,
            Content::Vectors => 3,
        }
    }
}

impl Voxels {
    /// Centre of the first voxel and steps along the indices \[m\]; `unit` overrides the file's.
    pub(crate) fn frame(&self, unit: Option<LengthUnit>) -> Result<(Vector3, Matrix3), Mistake> {
        let (origin, directions) = frame(&self.header)?;
        let metres = self.metres(unit)?;
        Ok((origin * metres, directions * metres))
    }

    /// The unit of length \[m\]; `unit` overrides the file's.
    pub(crate) fn metres(&self, unit: Option<LengthUnit>) -> Result<f64, Mistake> {
        Ok(unit.map_or_else(|| stated_unit(&self.header), Ok)?.in_metres())
    }

    fn labels(mut self, unit: Option<LengthUnit>) -> Result<(LabelMap, Vec<String>), Mistake> {
        let (origin, directions) = self.frame(unit)?;
        let (slope, intercept) = self.scaling;
        let numbers = bytes::numbers(&self.stored, self.scalar, self.order);
        let labels = Labels::of(numbers.map(|n| slope * n + intercept), self.scalar, self.order)?;
        let map = voxels::label_map(self.size, origin, directions, labels, &mut self.notes)?;
        Ok((map, self.notes))
    }
}

fn read_header(stream: &mut impl Read) -> Result<Start, Mistake> {
    let mut bytes = at_most(&mut *stream, HEADER as u64)?;
    if second::is_start(&bytes) {
        bytes.extend(at_most(stream, (second::HEADER - HEADER) as u64)?);
        let (header, in_pair) = second::header(&bytes)?;
        return Ok(Start { header, bytes, in_pair });
    }
    let format = "a NIfTI file (.nii or .nii.gz, or .hdr beside .img; Analyze 7.5 does not say where right is)";
    if bytes.len() < HEADER {
        return if bytes.starts_with(&348i32.to_le_bytes()) {
            Err(Mistake::TruncatedHeader { found: bytes.len() })
        } else {
            Err(Mistake::WrongFormat { format, start: start_of(&bytes) })
        };
    }
    let magic = &bytes[HEADER - 4..];
    let header = NiftiHeader::from_reader(&bytes[..])
        .map_err(|_| Mistake::WrongFormat { format, start: start_of(magic) })?;
    if header.sizeof_hdr != HEADER as i32 {
        return Err(Mistake::WrongFormat { format, start: start_of(&bytes) });
    }
    let in_pair = magic == b"ni1\0";
    Ok(Start { header, bytes, in_pair })
}

/// Voxels along the three axes; further axes must have one entry, or one of them the components.
fn size(header: &NiftiHeader, content: Content) -> Result<[usize; 3], Mistake> {
    let axes = usize::from(header.dim[0]);
    let sizes: Vec<usize> = header.dim[1..].iter().take(axes).map(|&n| usize::from(n)).collect();
    let further: usize = sizes.iter().skip(3).map(|&n| n.max(1)).product();
    if axes < 3 || further != content.count() {
        let expected = match content {
            Content::Numbers => {
                "three axes, one label per voxel: of a series, or of a probability for each \
                 structure, make one volume of labels first"
            }
            Content::Vectors => "three axes and one more of 3, the components of a vector",
        };
        return Err(Mistake::bad_field("dim", &format!("{sizes:?}"), expected));
    }
    Ok([sizes[0], sizes[1], sizes[2]])
}

fn scalar(header: &NiftiHeader) -> Result<Scalar, Mistake> {
    Ok(match header.data_type() {
        Ok(NiftiType::Uint8) => Scalar::U8,
        Ok(NiftiType::Int8) => Scalar::I8,
        Ok(NiftiType::Uint16) => Scalar::U16,
        Ok(NiftiType::Int16) => Scalar::I16,
        Ok(NiftiType::Uint32) => Scalar::U32,
        Ok(NiftiType::Int32) => Scalar::I32,
        Ok(NiftiType::Uint64) => Scalar::U64,
        Ok(NiftiType::Int64) => Scalar::I64,
        Ok(NiftiType::Float32) => Scalar::F32,
        Ok(NiftiType::Float64) => Scalar::F64,
        _ => {
            let expected = "a type of whole numbers such as 2 (uint8)";
            return Err(Mistake::bad_field("datatype", &header.datatype.to_string(), expected));
        }
    })
}

/// Where the voxels start \[byte\]; 0 means behind the header.
fn offset(header: &NiftiHeader) -> Result<u64, Mistake> {
    let offset = header.vox_offset;
    if !(offset >= 0.0 && offset.fract() == 0.0) {
        let expected = "a whole number of bytes such as 352";
        return Err(Mistake::bad_field("vox_offset", &offset.to_string(), expected));
    }
    Ok(offset as u64)
}

/// Slope and intercept of the stored values; a slope of 0 means none.
fn scaling(header: &NiftiHeader) -> Result<(f64, f64), Mistake> {
    match header.scl_slope {
        slope if slope == 0.0 || !slope.is_finite() => Ok((1.0, 0.0)),
        slope => {
            finite("scl_inter", &[header.scl_inter])?;
            Ok((f64::from(slope), f64::from(header.scl_inter)))
        }
    }
}

fn stated_unit(header: &NiftiHeader) -> Result<LengthUnit, Mistake> {
    match header.xyzt_units & 7 {
        0 | 2 => Ok(LengthUnit::Millimetre),
        1 => Ok(LengthUnit::Metre),
        3 => Ok(LengthUnit::Micrometre),
        other => {
            let expected = "0 (unknown), 1 (m), 2 (mm) or 3 (µm)";
            Err(Mistake::bad_field("xyzt_units", &other.to_string(), expected))
        }
    }
}
