//! NRRD label maps, versions 1 to 5, attached or detached; raw, gzip or text
//! (format: teem.sourceforge.net/nrrd/format.html).

use super::bytes::{ByteOrder, Scalar, bytes_of, inflate};
use super::error::{FileError, Mistake};
use super::nrrd_header::{Encoding, Header};
use super::unit::LengthUnit;
use super::voxels::{self, LabelMapFile};
use mtled::geometry::LabelMap;
use std::borrow::Cow;
use std::path::Path;

/// Reads a label map into RAS metres; `unit` overrides the file's.
pub fn read(path: &Path, unit: Option<LengthUnit>) -> Result<LabelMapFile, FileError> {
    let bytes = bytes_of(path)?;
    let header = Header::parse(&bytes).map_err(|mistake| mistake.of(path))?;
    let mut files = vec![path.to_path_buf()];
    let data = match header.get("datafile") {
        None => Cow::Borrowed(&bytes[header.length..]),
        Some(name) if name.starts_with("LIST") || name.contains('%') => {
            let expected = "the name of one data file";
            return Err(Mistake::bad_field("data file", name, expected).of(path));
        }
        Some(name) => {
            let data = path.parent().unwrap_or(Path::new(".")).join(name);
            files.push(data.clone());
            Cow::Owned(bytes_of(&data)?)
        }
    };
    let map = map(&header, &data, unit).map_err(|mistake| mistake.of(path))?;
    Ok(LabelMapFile { map, files })
}

fn map(header: &Header, data: &[u8], unit: Option<LengthUnit>) -> Result<LabelMap, Mistake> {
    let (size, scalar, encoding) = (header.sizes()?, header.scalar()?, header.encoding()?);
    let order = header.byte_order(scalar, encoding)?;
    let (origin, directions) = header.frame()?;
    let metres = match unit {
        Some(unit) => unit.in_metres(),
        None => header.unit()?.in_metres(),
    };
    let count = voxels::voxel_count(&size)?;
    let data = after_lines(header, data)?;
    let labels = match encoding {
        Encoding::Text => text_labels(&String::from_utf8_lossy(data), count, scalar)?,
        Encoding::Raw => {
            let data = after_bytes(header, data, count * scalar.size())?;
            voxels::labels(data, count, scalar, order, (1.0, 0.0))?
        }
        Encoding::Gzip => {
            let skip = header.skip("byteskip", "byte skip")?.unwrap_or(0);
            let expected = skip + count * scalar.size();
            let data = inflate(data, expected)?;
            if data.len() < expected {
                return Err(Mistake::Truncated { expected, found: data.len() });
            }
            let data = after_bytes(header, &data, count * scalar.size())?;
            voxels::labels(data, count, scalar, order, (1.0, 0.0))?
        }
    };
    voxels::label_map(size, origin * metres, directions * metres, labels)
}

/// The data after `line skip`.
fn after_lines<'a>(header: &Header, data: &'a [u8]) -> Result<&'a [u8], Mistake> {
    let lines = header.skip("lineskip", "line skip")?.unwrap_or(0);
    let length = data.split_inclusive(|&b| b == b'\n').take(lines).map(<[u8]>::len).sum();
    Ok(&data[length..])
}

/// The data after `byte skip`; -1 means that they are the last bytes.
fn after_bytes<'a>(header: &Header, data: &'a [u8], expected: usize) -> Result<&'a [u8], Mistake> {
    let truncated = Mistake::Truncated { expected, found: data.len() };
    match header.skip("byteskip", "byte skip")? {
        Some(skip) => data.get(skip..).ok_or(truncated),
        None => data.len().checked_sub(expected).map(|from| &data[from..]).ok_or(truncated),
    }
}

fn text_labels(text: &str, count: usize, scalar: Scalar) -> Result<Vec<u32>, Mistake> {
    let words = text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
    let mut labels = Vec::new();
    for (voxel, word) in words.take(count).enumerate() {
        let value = word.parse::<f64>().map_err(|_| {
            let reason = format!("`{}` is not a number", word.chars().take(20).collect::<String>());
            Mistake::Undecodable { encoding: "text", reason }
        })?;
        labels.push(voxels::label(voxel, value, scalar, ByteOrder::Little)?);
    }
    if labels.len() < count {
        return Err(Mistake::Truncated { expected: count, found: labels.len() });
    }
    Ok(labels)
}
