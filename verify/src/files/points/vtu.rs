//! The points of a VTU file and vectors at them: ASCII, or binary inline or appended, plain or
//! compressed by zlib.

use super::rows::from_stated;
use crate::files::bytes::{ByteOrder, LONGEST, Scalar, start_of};
use crate::files::error::Mistake;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use mtled::algebra::tensor::Vector3;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::HashMap;
use std::io::Read;

/// No cloud has more nodes.
const MOST_POINTS: usize = 20_000_000;

pub(super) type Attributes = HashMap<String, String>;

/// How binary arrays of a file are stored.
pub(super) struct Storage {
    order: ByteOrder,
    /// Type of the lengths in front of the data.
    lengths: Scalar,
    compressed: bool,
}

pub fn parse(bytes: &[u8]) -> Result<Vec<Vector3>, Mistake> {
    vectors(bytes, None)
}

/// The vectors of an array of the point data, as many as points.
pub fn point_data(bytes: &[u8], name: &str) -> Result<Vec<Vector3>, Mistake> {
    vectors(bytes, Some(name))
}

/// The points, or the point data of a name.
fn vectors(bytes: &[u8], name: Option<&str>) -> Result<Vec<Vector3>, Mistake> {
    let appended = find(bytes, b"<AppendedData");
    let PointsArray { file, piece, array, text } =
        points_array(&bytes[..appended.unwrap_or(bytes.len())], name)?;
    let storage = storage(&file)?;
    if let Some(components) = array.get("NumberOfComponents").filter(|&n| n != "3") {
        return Err(Mistake::bad_field("NumberOfComponents", components, "3 for vectors"));
    }
    if !matches!(array.get("type").map(String::as_str), Some("Float32" | "Float64")) {
        let other = array.get("type").map_or("", String::as_str);
        return Err(Mistake::bad_field("type", other, "Float32 or Float64"));
    }
    let points = piece.get("NumberOfPoints").map(|text| {
        let bad = |_| Mistake::bad_field("NumberOfPoints", text, "a whole number");
        text.trim().parse::<usize>().map_err(bad)
    });
    let points = points.transpose()?;
    let most = 3 * points.map_or(MOST_POINTS, |points| points.min(MOST_POINTS));
    let values = storage.values(&array, &text, appended.map(|at| &bytes[at..]), most)?;
    from_stated(&values, points.unwrap_or(values.len() / 3))
}

pub(super) fn damaged(encoding: &'static str, reason: String) -> Mistake {
    Mistake::Undecodable { encoding, reason }
}

pub(super) fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|window| window == what)
}

/// Attributes of VTKFile, of its only Piece and of the DataArray in Points or PointData, and
/// its text.
struct PointsArray {
    file: Attributes,
    piece: Attributes,
    array: Attributes,
    text: String,
}

fn points_array(xml: &[u8], name: Option<&str>) -> Result<PointsArray, Mistake> {
    let section: &[u8] = if name.is_some() { b"PointData" } else { b"Points" };
    let mut known = Vec::new();
    let mut wanted = |tag: &BytesStart| {
        let Some(name) = name else { return true };
        let found = attributes(tag).remove("Name").unwrap_or_default();
        let same = found == name;
        known.push(found);
        same
    };
    let mut reader = Reader::from_reader(xml);
    let (mut file, mut pieces, mut array) = (None, Vec::new(), None);
    let (mut in_points, mut text, mut buffer) = (false, String::new(), Vec::new());
    // Elements that are open inside the array: their texts are no coordinates.
    let mut open: Option<usize> = None;
    loop {
        let event = reader.read_event_into(&mut buffer);
        match event.map_err(|error| damaged("XML", error.to_string()))? {
            Event::Start(tag) if tag.name().as_ref() == b"VTKFile" => file = Some(attributes(&tag)),
            Event::Start(tag) | Event::Empty(tag) if tag.name().as_ref() == b"Piece" => {
                pieces.push(attributes(&tag));
            }
            Event::Start(tag) if tag.name().as_ref() == section => in_points = true,
            Event::Start(tag)
                if in_points
                    && tag.name().as_ref() == b"DataArray"
                    && array.is_none()
                    && wanted(&tag) =>
            {
                array = Some(attributes(&tag));
                open = Some(0);
            }
            Event::Empty(tag)
                if in_points
                    && tag.name().as_ref() == b"DataArray"
                    && array.is_none()
                    && wanted(&tag) =>
            {
                array = Some(attributes(&tag));
            }
            Event::Start(_) => open = open.map(|inside| inside + 1),
            Event::Text(part) if open == Some(0) => text += &String::from_utf8_lossy(&part),
            Event::End(tag) if tag.name().as_ref() == section => in_points = false,
            Event::End(_) => open = open.and_then(|inside| inside.checked_sub(1)),
            Event::Eof => break,
            _ => {}
        }
        buffer.clear();
    }
    let format = "a VTU file (XML with <VTKFile>)";
    let file = file.ok_or(Mistake::WrongFormat { format, start: start_of(xml) })?;
    let array = array.ok_or_else(|| match name {
        None => Mistake::MissingField { field: "Points/DataArray" },
        Some(name) => Mistake::NoPointData { name: name.to_string(), known: listed(&known) },
    })?;
    if pieces.len() > 1 {
        return Err(Mistake::SeveralPieces { pieces: pieces.len() });
    }
    let piece = pieces.pop().unwrap_or_default();
    Ok(PointsArray { file, piece, array, text })
}

fn listed(names: &[String]) -> String {
    if names.is_empty() { "none".to_string() } else { names.join(", ") }
}

pub(super) fn attributes(tag: &BytesStart) -> Attributes {
    let pairs = tag.attributes().flatten();
    pairs
        .map(|pair| {
            let name = String::from_utf8_lossy(pair.key.as_ref()).to_string();
            (name, String::from_utf8_lossy(&pair.value).to_string())
        })
        .collect()
}

pub(super) fn storage(file: &Attributes) -> Result<Storage, Mistake> {
    let get = |name: &str| file.get(name).map(String::as_str);
    Ok(Storage {
        order: match get("byte_order") {
            Some("BigEndian") => ByteOrder::Big,
            Some("LittleEndian") | None => ByteOrder::Little,
            Some(other) => {
                return Err(Mistake::bad_field("byte_order", other, "LittleEndian or BigEndian"));
            }
        },
        lengths: match get("header_type") {
            Some("UInt64") => Scalar::U64,
            Some("UInt32") | None => Scalar::U32,
            Some(other) => {
                return Err(Mistake::bad_field("header_type", other, "UInt32 or UInt64"));
            }
        },
        compressed: match get("compressor") {
            None => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                return Err(Mistake::bad_field(
                    "compressor",
                    other,
                    "vtkZLibDataCompressor or none",
                ));
            }
        },
    })
}

/// Bytes from an offset of the appended data, raw or base64.
fn appended_bytes(tail: &[u8], offset: usize) -> Result<Vec<u8>, Mistake> {
    let open = find(tail, b">").ok_or(Mistake::MissingField { field: "AppendedData" })?;
    let raw = find(&tail[..open], b"\"raw\"").is_some();
    let start = open + find(&tail[open..], b"_").ok_or(Mistake::NoPoints)? + 1;
    let data = &tail[start..];
    let truncated = Mistake::Truncated { expected: offset, found: data.len() };
    let data = data.get(offset..).ok_or(truncated)?;
    if raw {
        return Ok(data.to_vec());
    }
    base64_bytes(&data[..find(data, b"<").unwrap_or(data.len())])
}

/// Base64 in which padding may stand between pieces.
fn base64_bytes(text: &[u8]) -> Result<Vec<u8>, Mistake> {
    let text: Vec<u8> = text.iter().copied().filter(|b| !b.is_ascii_whitespace()).collect();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    for group in text.chunks(4) {
        let part = STANDARD.decode(group).map_err(|error| damaged("base64", error.to_string()))?;
        bytes.extend(part);
    }
    Ok(bytes)
}

impl Storage {
    /// The numbers of an array with this text, or in the data at the end of the file. Compressed
    /// data that are `most` numbers and more are refused before they are inflated.
    pub(super) fn values(
        &self,
        array: &Attributes,
        text: &str,
        appended: Option<&[u8]>,
        most: usize,
    ) -> Result<Vec<f64>, Mistake> {
        let get = |name: &str| array.get(name).map(String::as_str);
        let scalar = match get("type") {
            Some("Float32") => Scalar::F32,
            Some("Float64") => Scalar::F64,
            Some("Int32") => Scalar::I32,
            Some("Int64") => Scalar::I64,
            Some("UInt8") => Scalar::U8,
            other => {
                let expected = "Float32, Float64, Int32, Int64 or UInt8";
                return Err(Mistake::bad_field("type", other.unwrap_or(""), expected));
            }
        };
        match get("format") {
            Some("ascii") => {
                let values: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
                values.map_err(|error| damaged("ASCII", error.to_string()))
            }
            Some("binary") => self.numbers(&base64_bytes(text.as_bytes())?, scalar, most),
            Some("appended") => {
                let offset = get("offset").and_then(|offset| offset.parse().ok());
                let offset = offset.ok_or(Mistake::MissingField { field: "offset" })?;
                let tail = appended.ok_or(Mistake::MissingField { field: "AppendedData" })?;
                self.numbers(&appended_bytes(tail, offset)?, scalar, most)
            }
            other => {
                let expected = "ascii, binary or appended";
                Err(Mistake::bad_field("format", other.unwrap_or(""), expected))
            }
        }
    }

    /// Numbers of an array that starts with its lengths.
    fn numbers(&self, bytes: &[u8], scalar: Scalar, most: usize) -> Result<Vec<f64>, Mistake> {
        let most = most.saturating_mul(scalar.size());
        let data = match self.compressed {
            true => self.inflate(bytes, most)?,
            false => self.plain(bytes)?.to_vec(),
        };
        let words = data.chunks_exact(scalar.size());
        Ok(words.map(|word| scalar.read(word, self.order)).collect())
    }

    /// The n-th length in front of the data.
    fn length(&self, bytes: &[u8], n: usize) -> Result<usize, Mistake> {
        let size = self.lengths.size();
        let word = bytes.get(n * size..(n + 1) * size);
        let word = word.ok_or(Mistake::TruncatedHeader { found: bytes.len() })?;
        Ok(self.lengths.read(word, self.order) as usize)
    }

    fn plain<'a>(&self, bytes: &'a [u8]) -> Result<&'a [u8], Mistake> {
        let (expected, start) = (self.length(bytes, 0)?, self.lengths.size());
        let found = bytes.len() - start;
        let end = start.saturating_add(expected);
        bytes.get(start..end).ok_or(Mistake::Truncated { expected, found })
    }

    /// Blocks: their number, size, size of the last, compressed sizes, data; `most` bytes in all.
    fn inflate(&self, bytes: &[u8], most: usize) -> Result<Vec<u8>, Mistake> {
        let blocks = self.length(bytes, 0)?;
        if blocks == 0 {
            return Ok(Vec::new());
        }
        let (size, partial) = (self.length(bytes, 1)?, self.length(bytes, 2)?);
        let last = if partial == 0 { size } else { partial };
        let stated = size.saturating_mul(blocks - 1).saturating_add(last);
        if stated > most || stated as u64 > LONGEST {
            let most = most.min(LONGEST as usize);
            let reason = format!("its blocks state {stated} bytes, its points {most} at most");
            return Err(damaged("zlib", reason));
        }
        let mut start = blocks.saturating_add(3).saturating_mul(self.lengths.size());
        let mut out = Vec::new();
        for block in 0..blocks {
            let expected = self.length(bytes, 3 + block)?;
            let found = bytes.len().saturating_sub(start);
            let data = bytes.get(start..start.saturating_add(expected));
            let data = data.ok_or(Mistake::Truncated { expected, found })?;
            let size = if block + 1 < blocks || partial == 0 { size } else { partial };
            let before = out.len();
            // One byte more than stated, to notice that there is one.
            let inflated = ZlibDecoder::new(data).take(size as u64 + 1).read_to_end(&mut out);
            inflated.map_err(|error| damaged("zlib", error.to_string()))?;
            if out.len() - before != size {
                let reason = format!("block {block} has not the {size} bytes that are stated");
                return Err(damaged("zlib", reason));
            }
            start += expected;
        }
        Ok(out)
    }
}
