//! Triangulated surfaces in STL files: read from ASCII or binary ones, written as binary ones.

use super::space::Space;
use super::stl_text::{self, Corner};
use super::triangles::Triangles;
use crate::files::bytes::start_of;
use crate::files::error::{Mistake, check_finite};
use crate::files::unit::LengthUnit;
use mtled::algebra::tensor::Vector3;
use std::collections::HashMap;
use std::io::Cursor;

/// Reads a surface; STL states no unit.
pub(crate) fn parse(bytes: &[u8], unit: LengthUnit) -> Result<Triangles, Mistake> {
    let surface = if is_text(bytes) {
        shared(&stl_text::corners(bytes)?, unit)
    } else {
        binary(bytes, unit)?
    };
    if surface.triangles.is_empty() {
        return Err(Mistake::NoTriangles);
    }
    check_finite(&surface.vertices)?;
    Ok(surface)
}

/// Whether a file begins as text does and is no binary one of the right length.
fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start().get(..5);
    let solid = start.is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    solid && !bytes.contains(&0) && !has_stated_length(bytes)
}

fn binary(bytes: &[u8], unit: LengthUnit) -> Result<Triangles, Mistake> {
    let plain = plainly_binary(bytes)?;
    let space = Space::stated(&bytes[..START - 4])?.unwrap_or_default();
    let mesh = stl_io::read_stl(&mut Cursor::new(plain))
        .map_err(|error| Mistake::Undecodable { encoding: "STL", reason: error.to_string() })?;
    let place =
        |v: &stl_io::Vertex| in_metres(space.to_ras([v[0], v[1], v[2]].map(f64::from)), unit);
    let triangles = mesh.faces.iter().map(|face| face.vertices.map(|n| n as u32)).collect();
    Ok(Triangles { vertices: mesh.vertices.iter().map(place).collect(), triangles })
}

fn in_metres(corner: Corner, unit: LengthUnit) -> Vector3 {
    Vector3::from(corner) * unit.in_metres()
}

/// Triangles with one vertex, the first one, for all corners whose coordinates are the same in
/// single precision, in the order of the file.
fn shared(corners: &[Corner], unit: LengthUnit) -> Triangles {
    let (mut first, mut vertices) = (HashMap::new(), Vec::new());
    let number = |corner: &Corner| {
        *first.entry(corner.map(|x| (x as f32).to_bits())).or_insert_with(|| {
            vertices.push(in_metres(*corner, unit));
            vertices.len() as u32 - 1
        })
    };
    let numbers: Vec<u32> = corners.iter().map(number).collect();
    let triangles = numbers.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    Triangles { vertices, triangles }
}

/// Space of the coordinates of a file, in the words of 3D Slicer; padded to the header.
const SPACE: &[u8] = b"SPACE=LPS";

/// A binary file in mm along L, P and S of triangles in RAS, as 3D Slicer reads and writes it.
pub fn to_stl(surface: &Triangles) -> Vec<u8> {
    let place = |n: u32| {
        let at = surface.vertices[n as usize] * 1e3;
        stl_io::Vertex::new([-at.x as f32, -at.y as f32, at.z as f32])
    };
    let triangle = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|n| surface.vertices[n as usize]);
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        let normal = stl_io::Normal::new([-normal.x as f32, -normal.y as f32, normal.z as f32]);
        stl_io::Triangle { normal, vertices: corners.map(place) }
    };
    let triangles: Vec<stl_io::Triangle> = surface.triangles.iter().map(triangle).collect();
    let mut bytes = Vec::with_capacity(START + TRIANGLE * triangles.len());
    let written = stl_io::write_stl(&mut bytes, triangles.iter());
    written.expect("memory takes all bytes");
    bytes[..SPACE.len()].copy_from_slice(SPACE);
    bytes
}

/// Header of a binary file and its number of triangles \[byte\].
const START: usize = 84;
/// A triangle of a binary file \[byte\].
const TRIANGLE: usize = 50;

/// Bytes of triangles that a binary file states.
fn stated(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(START - 4..START)?;
    let count = count.iter().rev().fold(0usize, |sum, &byte| sum << 8 | usize::from(byte));
    Some(TRIANGLE * count)
}

/// Whether a file is as long as a binary one of its triangles, which shows that it is one,
/// whatever its header begins with.
fn has_stated_length(bytes: &[u8]) -> bool {
    stated(bytes).is_some_and(|expected| bytes.len() == START + expected)
}

/// A binary file of the right length, with a header that no reader takes for text.
fn plainly_binary(bytes: &[u8]) -> Result<Vec<u8>, Mistake> {
    let other = Mistake::WrongFormat { format: "an STL file", start: start_of(bytes) };
    let Some(expected) = stated(bytes) else {
        return Err(other);
    };
    let found = bytes.len() - START;
    match found.checked_sub(expected) {
        _ if looks_otherwise(bytes) => Err(other),
        None => Err(Mistake::Truncated { expected, found }),
        Some(TRIANGLE..) => Err(Mistake::Excess { expected }),
        Some(_) => Ok([&[0; START - 4], &bytes[START - 4..]].concat()),
    }
}

/// Whether a file of another length than stated begins as compressed data, or with text where the
/// number of triangles stands, which would be beyond 150 million.
fn looks_otherwise(bytes: &[u8]) -> bool {
    const GZIP: &[u8] = &[0x1f, 0x8b];
    let text = |byte: &u8| byte.is_ascii_graphic() || byte.is_ascii_whitespace();
    let other = bytes.starts_with(GZIP) || bytes[..START].iter().all(text);
    other && !has_stated_length(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]];

    fn tetrahedron() -> Vec<stl_io::Triangle> {
        [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
            .map(|face: [usize; 3]| stl_io::Triangle {
                normal: stl_io::Normal::new([0.0; 3]),
                vertices: face.map(|n| stl_io::Vertex::new(CORNERS[n])),
            })
            .to_vec()
    }

    fn written() -> Vec<u8> {
        let mut bytes = Vec::new();
        stl_io::write_stl(&mut bytes, tetrahedron().iter()).unwrap();
        bytes
    }

    fn ascii() -> String {
        let mut text = "solid tetrahedron\n".to_string();
        for triangle in tetrahedron() {
            text += "facet normal 0 0 0\n outer loop\n";
            for vertex in triangle.vertices {
                text += &format!("  vertex {} {} {}\n", vertex[0], vertex[1], vertex[2]);
            }
            text += " endloop\nendfacet\n";
        }
        text + "endsolid tetrahedron\n"
    }

    #[test]
    fn binary_and_ascii_give_the_same_surface_in_metres() {
        let from_binary = parse(&written(), LengthUnit::Millimetre).unwrap();
        assert_eq!(from_binary, parse(ascii().as_bytes(), LengthUnit::Millimetre).unwrap());
        assert_eq!((from_binary.vertices.len(), from_binary.triangles.len()), (4, 4));
        assert!(from_binary.vertices.contains(&Vector3::new(0.01, 0.0, 0.0)));
    }

    #[test]
    fn a_binary_surface_whose_header_begins_with_solid_is_read() {
        let mut bytes = written();
        bytes[..13].copy_from_slice(b"solid surface");
        let read = parse(&bytes, LengthUnit::Metre).unwrap();
        assert_eq!(read, parse(&written(), LengthUnit::Metre).unwrap());
    }

    #[test]
    fn a_text_surface_needs_no_name() {
        let text = ascii().replace("solid tetrahedron\n", "solid\n");
        let read = parse(text.as_bytes(), LengthUnit::Metre).unwrap();
        assert_eq!(read.triangles.len(), 4);
    }

    #[test]
    fn a_text_keeps_its_digits_and_corners_that_differ_in_the_last_are_one() {
        let text = ascii().replace("vertex 10 0 0", "vertex 10.000123456789 0 0");
        let (first, rest) = text.split_at(text.find("endfacet").unwrap());
        let text = first.to_string() + &rest.replace("10.000123456789", "10.0001234567");
        let read = parse(text.as_bytes(), LengthUnit::Metre).unwrap();
        assert_eq!(read.vertices.len(), 4);
        let far = read.vertices.iter().map(|vertex| vertex.x).fold(0.0, f64::max);
        assert!((far - 10.000_123_456_7).abs() < 1e-9, "{far}");
    }

    #[test]
    fn a_surface_with_more_triangles_than_stated_is_refused() {
        let mut bytes = written();
        bytes[80] = 3;
        let error = parse(&bytes, LengthUnit::Metre).unwrap_err();
        assert!(matches!(error, Mistake::Excess { expected: 150 }), "{error}");
    }

    #[test]
    fn a_truncated_surface_is_refused_with_its_length() {
        let bytes = written();
        let error = parse(&bytes[..bytes.len() - 30], LengthUnit::Metre).unwrap_err();
        assert!(matches!(error, Mistake::Truncated { expected: 200, found: 170 }), "{error}");
    }

    #[test]
    fn a_surface_of_two_solids_has_the_triangles_of_both() {
        let both = ascii() + &ascii().replace("10", "20");
        let read = parse(both.as_bytes(), LengthUnit::Metre).unwrap();
        assert_eq!((read.vertices.len(), read.triangles.len()), (7, 8));
    }

    #[test]
    fn the_space_of_a_header_or_a_name_is_honoured() {
        let plain = parse(&written(), LengthUnit::Metre).unwrap();
        let turned: Vec<Vector3> =
            plain.vertices.iter().map(|v| Vector3::new(-v.x, -v.y, v.z)).collect();
        for (space, expected) in [("LPS", &turned), ("RAS", &plain.vertices)] {
            let mut bytes = written();
            bytes[..9].copy_from_slice(format!("SPACE={space}").as_bytes());
            let text = ascii().replace("solid tetrahedron", &format!("solid liver SPACE={space}"));
            for file in [&bytes, text.as_bytes()] {
                assert_eq!(&parse(file, LengthUnit::Metre).unwrap().vertices, expected);
            }
        }
        let unknown = ascii().replace("solid tetrahedron", "solid SPACE=LAS");
        let error = parse(unknown.as_bytes(), LengthUnit::Metre).unwrap_err().to_string();
        assert!(error.contains("`SPACE` is `LAS`; expected `LPS` or `RAS`"), "{error}");
    }

    #[test]
    fn a_surface_that_was_written_is_read_at_the_same_place() {
        let surface = parse(&written(), LengthUnit::Millimetre).unwrap();
        let again = parse(&to_stl(&surface), LengthUnit::Millimetre).unwrap();
        assert_eq!(again, surface);
    }

    #[test]
    fn files_of_other_formats_are_not_called_truncated() {
        let object = "# an object\n".to_string() + &"v 0.0 1.0 2.0\n".repeat(20);
        let packed = [&[0x1f, 0x8b, 8, 0][..], &[7; 200]].concat();
        for (file, start) in [(object.as_bytes(), "# an object"), (&packed, "\\u{1f}")] {
            let error = parse(file, LengthUnit::Metre).unwrap_err();
            assert!(matches!(error, Mistake::WrongFormat { .. }), "{error}");
            assert!(error.to_string().contains(start), "{error}");
        }
    }

    #[test]
    fn a_text_without_a_triangle_is_refused() {
        let error = parse(b"solid nothing\nendsolid\n", LengthUnit::Metre).unwrap_err();
        assert!(matches!(error, Mistake::NoTriangles), "{error}");
    }
}
