//! Faces of PLY files, as text or binary in both byte orders.

use super::polygons::Polygons;
use crate::files::error::Mistake;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult,
};
use std::borrow::Cow;
use std::io::ErrorKind;

/// The faces of a file.
pub(crate) fn polygons(bytes: &[u8]) -> Result<Polygons, Mistake> {
    let parser = Parser::<Item>::new();
    let bytes = with_line_ends(bytes);
    let mut reader = Reader::new(&bytes[..]);
    let header = parser.read_header(&mut reader).map_err(|error| damaged(&error, true))?;
    check(&header, bytes.len())?;
    let is_text = header.encoding == Encoding::Ascii;
    let mut found = Polygons::default();
    let mut comments = header.comments.iter().chain(&header.obj_infos);
    comments.try_for_each(|comment| found.state_space(comment))?;
    for element in header.elements.values() {
        let items = parser.read_payload_for_element(&mut reader, element, &header);
        let items = items.map_err(|error| damaged(&error, is_text))?;
        match element.name.as_str() {
            "vertex" => found.points = items.into_iter().map(|item| item.place).collect(),
            "face" => items.into_iter().try_for_each(|item| push(&mut found, &item.corners))?,
            "edge" => found.lines += items.len(),
            _ => {}
        }
    }
    match reader.get_ref().trim_ascii() {
        [] => Ok(found),
        rest => Err(Mistake::DataBehind { bytes: rest.len() }),
    }
}

/// Text whose lines end in the way of old Macintoshes with ends that are read.
fn with_line_ends(bytes: &[u8]) -> Cow<'_, [u8]> {
    if bytes.contains(&b'\n') {
        return Cow::Borrowed(bytes);
    }
    bytes.iter().map(|&byte| if byte == b'\r' { b'\n' } else { byte }).collect()
}

/// What is read of a vertex or a face.
struct Item {
    place: [f64; 3],
    corners: Vec<i64>,
}

impl PropertyAccess for Item {
    fn new() -> Item {
        Item { place: [0.0; 3], corners: Vec::new() }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if let Some(axis) = ["x", "y", "z"].iter().position(|axis| *axis == name) {
            let Some(value) = number(&property) else {
                return PropertyAccessResult::UnsupportedType;
            };
            self.place[axis] = value;
        } else if CORNERS.contains(&name) {
            let Some(corners) = whole_numbers(&property) else {
                return PropertyAccessResult::UnsupportedType;
            };
            self.corners = corners;
        } else {
            return PropertyAccessResult::Ignored;
        }
        PropertyAccessResult::Set
    }
}

/// Names under which a face has its corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

fn number(property: &Property) -> Option<f64> {
    match property {
        Property::Char(n) => Some(f64::from(*n)),
        Property::UChar(n) => Some(f64::from(*n)),
        Property::Short(n) => Some(f64::from(*n)),
        Property::UShort(n) => Some(f64::from(*n)),
        Property::Int(n) => Some(f64::from(*n)),
        Property::UInt(n) => Some(f64::from(*n)),
        Property::Float(n) => Some(f64::from(*n)),
        Property::Double(n) => Some(*n),
        _ => None,
    }
}

fn whole_numbers(property: &Property) -> Option<Vec<i64>> {
    fn wide<T: Copy + Into<i64>>(list: &[T]) -> Option<Vec<i64>> {
        Some(list.iter().map(|n| (*n).into()).collect())
    }
    match property {
        Property::ListChar(list) => wide(list),
        Property::ListUChar(list) => wide(list),
        Property::ListShort(list) => wide(list),
        Property::ListUShort(list) => wide(list),
        Property::ListInt(list) => wide(list),
        Property::ListUInt(list) => wide(list),
        _ => None,
    }
}

fn push(found: &mut Polygons, corners: &[i64]) -> Result<(), Mistake> {
    let corners: Result<Vec<u32>, _> = corners.iter().map(|n| u32::try_from(*n)).collect();
    let expected = "numbers of vertices, counted from 0";
    let bad = |_| Mistake::bad_field("vertex_indices", "negative or too large", expected);
    found.push(corners.map_err(bad)?);
    Ok(())
}

/// Refuses a header without places or faces, and one that promises more than the file can have.
fn check(header: &Header, bytes: usize) -> Result<(), Mistake> {
    let element = |name: &str| header.elements.get(name);
    let has = |element: &ElementDef, name: &str| element.properties.contains_key(name);
    let vertex = element("vertex").ok_or(Mistake::MissingField { field: "element vertex" })?;
    for (axis, field) in [("x", "property x"), ("y", "property y"), ("z", "property z")] {
        if !has(vertex, axis) {
            return Err(Mistake::MissingField { field });
        }
    }
    if element("tristrips").is_some() {
        let expected = "`face`: strips must be cut into triangles where they come from";
        return Err(Mistake::bad_field("element", "tristrips", expected));
    }
    let face = element("face").ok_or(Mistake::MissingField { field: "element face" })?;
    if !CORNERS.iter().any(|name| has(face, name)) {
        return Err(Mistake::MissingField { field: "property list vertex_indices" });
    }
    // Every item takes a byte at least.
    let elements = header.elements.values();
    match elements.into_iter().find(|e| e.properties.is_empty() || e.count > bytes) {
        Some(ElementDef { name, count, .. }) => {
            let value = format!("{name} {count}");
            let expected = "a count that the file is long enough for, and properties";
            Err(Mistake::bad_field("element", &value, expected))
        }
        None => Ok(()),
    }
}

/// What the parser says, in a line; lines count in text alone.
fn damaged(error: &ParseError, is_text: bool) -> Mistake {
    let text = error.to_string();
    let parts: Vec<&str> = text.lines().map(str::trim).filter(|part| !part.is_empty()).collect();
    let text = parts.join(" ");
    let text = match error.line() {
        Some(line) if !is_text => text.trim_start_matches(&format!("Line {line}: ")).to_string(),
        _ => text,
    };
    const SHOWN: usize = 300;
    let reason: String = text.chars().take(SHOWN).filter(|c| !c.is_control()).collect();
    let reason = reason.trim_end_matches(['.', ' ', ',']).to_string();
    match error.kind() {
        ErrorKind::UnexpectedEof => Mistake::EndsEarly { reason },
        _ => Mistake::Undecodable { encoding: "PLY", reason },
    }
}
