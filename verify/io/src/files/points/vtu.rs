//! The points of a VTU file and vectors at them.

use super::rows::from_stated;
use crate::files::bytes::start_of;
use crate::files::error::Mistake;
use crate::files::vtk_xml::{Attributes, Storage, attributes, damaged, split};
use mtled::algebra::tensor::Vector3;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// No cloud has more nodes.
const MOST_POINTS: usize = 20_000_000;

pub(crate) fn parse(bytes: &[u8]) -> Result<Vec<Vector3>, Mistake> {
    vectors(bytes, None)
}

/// The vectors of an array of the point data, as many as points.
pub(crate) fn point_data(bytes: &[u8], name: &str) -> Result<Vec<Vector3>, Mistake> {
    vectors(bytes, Some(name))
}

/// The points, or the point data of a name.
fn vectors(bytes: &[u8], name: Option<&str>) -> Result<Vec<Vector3>, Mistake> {
    let (xml, appended) = split(bytes);
    let PointsArray { file, piece, array, text } = points_array(xml, name)?;
    let storage = Storage::of(&file)?;
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
    let values = storage.values(&array, &text, appended, most)?;
    from_stated(&values, points.unwrap_or(values.len() / 3))
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
    let mut is_asked = |tag: &BytesStart| {
        if tag.name().as_ref() != b"DataArray" {
            return false;
        }
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
            Event::Start(tag) if in_points && array.is_none() && is_asked(&tag) => {
                array = Some(attributes(&tag));
                open = Some(0);
            }
            Event::Empty(tag) if in_points && array.is_none() && is_asked(&tag) => {
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
