//! NRRD label maps, versions 1 to 5, attached or detached; raw, gzip or text
//! (format: teem.sourceforge.net/nrrd/format.html).

use super::bytes::{self, LONGEST, at_most, open, skip, voxel_bytes};
use super::error::{FileError, Mistake};
use super::nrrd_header::{Encoding, Header};
use super::unit::LengthUnit;
use super::voxels::{self, LabelMapFile, Labels};
use flate2::bufread::MultiGzDecoder;
use mtled::geometry::LabelMap;
use std::io::{BufRead, Cursor, Read};
use std::path::{Path, PathBuf};

/// Headers are shorter than this \[byte\].
const LONGEST_HEADER: u64 = 1 << 20;

/// An NRRD file whose header has been read.
pub(super) struct Opened {
    pub header: Header,
    /// The header as it stands in the file, its empty line included.
    pub text: Vec<u8>,
    /// What follows it, or the detached data file.
    pub data: Box<dyn BufRead>,
    /// Length of the data with what may be skipped \[byte\].
    pub length: u64,
    /// The file that was named, then a detached data file.
    pub files: Vec<PathBuf>,
}

/// Reads the header of a file and opens its data.
pub(super) fn open_image(path: &Path) -> Result<Opened, FileError> {
    let (mut file, length) = open(path)?;
    let mut start = at_most(&mut file, LONGEST_HEADER).map_err(|mistake| mistake.of(path))?;
    let header = Header::parse(&start).map_err(|mistake| mistake.of(path))?;
    let length = length.saturating_sub(header.length as u64);
    if header.length as u64 == LONGEST_HEADER && length > 0 {
        return Err(Mistake::LongHeader { longest: LONGEST_HEADER }.of(path));
    }
    let behind = start.split_off(header.length);
    let mut files = vec![path.to_path_buf()];
    let (data, length): (Box<dyn BufRead>, u64) = match header.get("datafile") {
        None => (Box::new(Cursor::new(behind).chain(file)), length),
        Some(name) if name.starts_with("LIST") || name.contains('%') => {
            let expected = "the name of one data file";
            return Err(Mistake::bad_field("data file", name, expected).of(path));
        }
        Some(name) => {
            let data = path.parent().unwrap_or(Path::new(".")).join(name);
            let (file, length) = open(&data)?;
            files.push(data);
            (Box::new(file), length)
        }
    };
    Ok(Opened { header, text: start, data, length, files })
}

/// Reads a label map into RAS metres; `unit` overrides the file's. Of a file of several layers
/// `layer` says which is read, from 0.
pub(crate) fn read(
    path: &Path,
    unit: Option<LengthUnit>,
    layer: Option<usize>,
) -> Result<LabelMapFile, FileError> {
    let Opened { header, data, length, files, .. } = open_image(path)?;
    let mut notes = header.doubts();
    let map = map(&header, data, length, (unit, layer), &mut notes)
        .map_err(|mistake| mistake.of(path))?;
    Ok(LabelMapFile { map, files, notes })
}

/// The image whose voxels are in `length` bytes of data.
fn map(
    header: &Header,
    data: impl BufRead,
    length: u64,
    (unit, layer): (Option<LengthUnit>, Option<usize>),
    notes: &mut Vec<String>,
) -> Result<LabelMap, Mistake> {
    let ((layers, size), scalar) = (header.layers_and_sizes()?, header.scalar()?);
    let (encoding, layer) = (header.encoding()?, which(header, layer, layers)?);
    let order = header.byte_order(scalar, encoding)?;
    let (origin, directions) = header.frame(unit)?;
    let count = voxels::voxel_count(&size)?;
    let all = voxels::voxel_count(&[count, layers])?;
    let labels = match encoding {
        Encoding::Text => {
            let numbers = text_labels(behind_lines(header, data)?.0, all)?;
            Labels::of(numbers.into_iter().skip(layer).step_by(layers), scalar, order)?
        }
        Encoding::Raw | Encoding::Gzip => {
            let bytes = stored(header, data, length, all * scalar.size())?;
            let numbers = bytes::numbers(&bytes, scalar, order).skip(layer).step_by(layers);
            Labels::of(numbers, scalar, order)?
        }
    };
    voxels::label_map(size, origin, directions, labels, notes)
}

/// The layer to read, of so many.
fn which(header: &Header, layer: Option<usize>, layers: usize) -> Result<usize, Mistake> {
    match layer {
        None if layers == 1 => Ok(0),
        Some(layer) if layer < layers => Ok(layer),
        Some(layer) => Err(Mistake::NoSuchLayer { layer, layers }),
        None => {
            let named = |layer: usize| {
                let segments = header.segments().into_iter().filter(|(of, ..)| *of == layer);
                let names: Vec<String> =
                    segments.map(|(_, label, name)| format!("{label} {name}")).collect();
                format!("layer {layer} ({})", names.join(", "))
            };
            const NAMED: usize = 8;
            let found: Vec<String> = (0..layers.min(NAMED)).map(named).collect();
            Err(Mistake::SeveralLayers { layers, found: found.join("; ") })
        }
    }
}

/// The data behind the lines that are to be skipped, and how many bytes these have.
fn behind_lines<R: BufRead>(header: &Header, mut data: R) -> Result<(R, u64), Mistake> {
    let lines = header.skip("lineskip", "line skip")?.unwrap_or(0);
    let mut before = 0;
    for _ in 0..lines {
        match data.skip_until(b'\n').map_err(Mistake::Unreadable)? {
            0 => break,
            length => before += length as u64,
        }
    }
    Ok((data, before))
}

/// The `expected` bytes of all voxels from `length` bytes of data, which are raw or gzip.
pub(super) fn stored(
    header: &Header,
    data: impl BufRead,
    length: u64,
    expected: usize,
) -> Result<Vec<u8>, Mistake> {
    let (mut data, before) = behind_lines(header, data)?;
    let bytes_before = header.skip("byteskip", "byte skip")?;
    match header.encoding()? {
        Encoding::Gzip => {
            let mut data = MultiGzDecoder::new(data);
            skip(&mut data, bytes_before.unwrap_or(0))?;
            exactly(data, expected)
        }
        Encoding::Raw => {
            let left = length.saturating_sub(before);
            // A skip of −1 means that the voxels are the last bytes.
            let skipped = bytes_before.unwrap_or(left.saturating_sub(expected as u64));
            let found = left.saturating_sub(skipped);
            if found < expected as u64 {
                return Err(Mistake::Truncated { expected, found: found as usize });
            }
            skip(&mut data, skipped)?;
            exactly(data, expected)
        }
        Encoding::Text => {
            Err(Mistake::bad_field("encoding", "ascii", "raw or gzip; save it in one of these"))
        }
    }
}

/// All of the data, which must be as many as expected; a line end may follow.
fn exactly(data: impl Read, expected: usize) -> Result<Vec<u8>, Mistake> {
    let (bytes, rest) = voxel_bytes(data, expected)?;
    match rest[..] {
        [] | [b'\n'] | [b'\r', b'\n'] => Ok(bytes),
        _ => Err(Mistake::Excess { expected }),
    }
}

fn text_labels(data: impl Read, count: usize) -> Result<Vec<f64>, Mistake> {
    let text = at_most(data, LONGEST)?;
    let text = String::from_utf8_lossy(&text);
    let words = text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
    let mut labels = Vec::new();
    for (voxel, word) in words.enumerate() {
        if voxel == count {
            return Err(Mistake::Excess { expected: count });
        }
        let value = word.parse::<f64>().map_err(|_| {
            let reason = format!("`{}` is not a number", word.chars().take(20).collect::<String>());
            Mistake::Undecodable { encoding: "text", reason }
        })?;
        labels.push(value);
    }
    if labels.len() < count {
        return Err(Mistake::Truncated { expected: count, found: labels.len() });
    }
    Ok(labels)
}
