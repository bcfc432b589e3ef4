//! XML files of VTK: their arrays, ASCII or binary inline or appended, plain or compressed by zlib.

use super::bytes::{self, ByteOrder, LONGEST, Scalar, start_of};
use super::error::Mistake;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::HashMap;
use std::io::Read;

pub(crate) type Attributes = HashMap<String, String>;

/// How binary arrays of a file are stored.
pub(crate) struct Storage {
    order: ByteOrder,
    /// Type of the lengths in front of the data.
    lengths: Scalar,
    compressed: bool,
}

/// An array of a file: its piece, its section, its attributes, its text.
pub(crate) struct Array {
    pub piece: usize,
    pub section: &'static str,
    pub attributes: Attributes,
    text: String,
}

/// A file with all arrays of some sections.
pub(crate) struct XmlFile<'a> {
    storage: Storage,
    pub arrays: Vec<Array>,
    tail: Option<&'a [u8]>,
}

impl<'a> XmlFile<'a> {
    /// Of a file that is called `format` where it is none.
    pub(crate) fn parse(
        bytes: &'a [u8],
        sections: &[&'static str],
        format: &'static str,
    ) -> Result<Self, Mistake> {
        let (xml, tail) = split(bytes);
        let (file, arrays) = arrays(xml, sections)?;
        let wrong = || Mistake::WrongFormat { format, start: start_of(xml) };
        Ok(XmlFile { storage: Storage::of(&file.ok_or_else(wrong)?)?, arrays, tail })
    }

    /// The numbers of an array.
    pub fn values(&self, array: &Array) -> Result<Vec<f64>, Mistake> {
        self.storage.values(&array.attributes, &array.text, self.tail, usize::MAX)
    }

    /// The letters of an array of text, which has a code for each.
    pub(crate) fn letters(&self, array: &Array) -> Result<String, Mistake> {
        let mut attributes = array.attributes.clone();
        attributes.insert("type".to_string(), "UInt8".to_string());
        let codes = self.storage.values(&attributes, &array.text, self.tail, usize::MAX)?;
        let letters = codes.into_iter().map(|code| char::from(code as u8));
        Ok(letters.take_while(|letter| *letter != '\0').collect())
    }
}

impl Array {
    /// Its name, if it has one.
    pub(crate) fn name(&self) -> Option<&str> {
        self.attributes.get("Name").map(String::as_str)
    }

    /// Whether it has letters, no numbers.
    pub(crate) fn is_text(&self) -> bool {
        self.attributes.get("type").is_some_and(|kind| kind == "String")
    }
}

/// The XML of a file and the data appended to it.
pub(crate) fn split(bytes: &[u8]) -> (&[u8], Option<&[u8]>) {
    match find(bytes, b"<AppendedData") {
        Some(at) => (&bytes[..at], Some(&bytes[at..])),
        None => (bytes, None),
    }
}

/// Attributes of VTKFile, and every array of the sections that are read.
fn arrays(
    xml: &[u8],
    sections: &[&'static str],
) -> Result<(Option<Attributes>, Vec<Array>), Mistake> {
    let mut reader = Reader::from_reader(xml);
    let (mut file, mut section, mut buffer) = (None, None, Vec::new());
    let (mut arrays, mut pieces) = (Vec::<Array>::new(), 0usize);
    // Elements that are open inside an array: their texts are none of its numbers.
    let mut open: Option<usize> = None;
    let section_of = |name: &[u8]| sections.iter().find(|section| section.as_bytes() == name);
    let is_array = |name: &[u8]| matches!(name, b"DataArray" | b"Array");
    let array = |tag: &BytesStart, section: Option<&&'static str>, pieces: usize| {
        let (attributes, text) = (attributes(tag), String::new());
        let piece = pieces.saturating_sub(1);
        section.map(|section| Array { piece, section, attributes, text })
    };
    loop {
        let event = reader.read_event_into(&mut buffer);
        match event.map_err(|error| damaged("XML", error.to_string()))? {
            Event::Start(tag) if tag.name().as_ref() == b"VTKFile" => file = Some(attributes(&tag)),
            Event::Start(tag) if tag.name().as_ref() == b"Piece" => pieces += 1,
            Event::Start(tag) if section_of(tag.name().as_ref()).is_some() => {
                section = section_of(tag.name().as_ref());
            }
            Event::Start(tag) if is_array(tag.name().as_ref()) => {
                open = section.map(|_| 0);
                arrays.extend(array(&tag, section, pieces));
            }
            Event::Empty(tag) if is_array(tag.name().as_ref()) => {
                arrays.extend(array(&tag, section, pieces));
            }
            Event::Start(_) => open = open.map(|inside| inside + 1),
            Event::Text(part) if open == Some(0) => {
                if let Some(array) = arrays.last_mut() {
                    array.text += &String::from_utf8_lossy(&part);
                }
            }
            Event::End(tag) if section_of(tag.name().as_ref()).is_some() => section = None,
            Event::End(_) => open = open.and_then(|inside| inside.checked_sub(1)),
            Event::Eof => break,
            _ => {}
        }
        buffer.clear();
    }
    Ok((file, arrays))
}

pub(crate) fn damaged(encoding: &'static str, reason: String) -> Mistake {
    Mistake::Undecodable { encoding, reason }
}

fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|window| window == what)
}

pub(crate) fn attributes(tag: &BytesStart) -> Attributes {
    let pairs = tag.attributes().flatten();
    pairs
        .map(|pair| {
            let name = String::from_utf8_lossy(pair.key.as_ref()).to_string();
            (name, String::from_utf8_lossy(&pair.value).to_string())
        })
        .collect()
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
    /// That of a file, by the attributes of VTKFile.
    pub(crate) fn of(file: &Attributes) -> Result<Storage, Mistake> {
        let get = |name: &str| file.get(name).map(String::as_str);
        Ok(Storage {
            order: match get("byte_order") {
                Some("BigEndian") => ByteOrder::Big,
                Some("LittleEndian") | None => ByteOrder::Little,
                Some(other) => {
                    return Err(Mistake::bad_field(
                        "byte_order",
                        other,
                        "LittleEndian or BigEndian",
                    ));
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

    /// The numbers of an array with this text, or in the data at the end of the file. Compressed
    /// data that are `most` numbers and more are refused before they are inflated.
    pub fn values(
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
            Some("Int8") => Scalar::I8,
            Some("Int16") => Scalar::I16,
            Some("Int32") => Scalar::I32,
            Some("Int64") => Scalar::I64,
            Some("UInt8") => Scalar::U8,
            Some("UInt16") => Scalar::U16,
            Some("UInt32") => Scalar::U32,
            Some("UInt64") => Scalar::U64,
            other => {
                let expected = "Float32, Float64, or Int or UInt and their bits, such as Int64";
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
        let data =
            if self.compressed { self.inflate(bytes, most)? } else { self.plain(bytes)?.to_vec() };
        Ok(bytes::numbers(&data, scalar, self.order).collect())
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
