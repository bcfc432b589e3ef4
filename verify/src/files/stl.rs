//! Triangulated surfaces in STL files: read from ASCII or binary ones, written as binary ones.

use super::bytes::{bytes_of, start_of};
use super::error::{FileError, Mistake};
use super::unit::LengthUnit;
use mtled::algebra::tensor::Vector3;
use std::io::Cursor;
use std::path::Path;

/// Triangles that share vertices where the file repeats their coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Triangles {
    /// \[m\]
    pub vertices: Vec<Vector3>,
    /// Indices of the corners \[triangle\].
    pub triangles: Vec<[u32; 3]>,
}

/// Reads a surface; STL states no unit.
pub fn read(path: &Path, unit: LengthUnit) -> Result<Triangles, FileError> {
    let bytes = bytes_of(path)?;
    parse(&bytes, unit).map_err(|mistake| mistake.of(path))
}

fn parse(bytes: &[u8], unit: LengthUnit) -> Result<Triangles, Mistake> {
    let text = bytes.starts_with(b"solid") && surplus(bytes) != Some(0);
    let bytes = match text {
        true => unnamed_text(bytes),
        false => plainly_binary(bytes)?,
    };
    let mesh = stl_io::read_stl(&mut Cursor::new(bytes))
        .map_err(|error| Mistake::Undecodable { encoding: "STL", reason: error.to_string() })?;
    if mesh.faces.is_empty() {
        return Err(Mistake::NoTriangles);
    }
    let metres = unit.in_metres();
    let vertices: Vec<Vector3> = (mesh.vertices.iter())
        .map(|vertex| Vector3::from_fn(|n, _| f64::from(vertex[n]) * metres))
        .collect();
    if let Some(point) = vertices.iter().position(|v| !v.iter().all(|c| c.is_finite())) {
        return Err(Mistake::NotFinite { point: point + 1 });
    }
    let triangles = mesh.faces.iter().map(|face| face.vertices.map(|n| n as u32)).collect();
    Ok(Triangles { vertices, triangles })
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

/// Bytes beyond those that a binary file states; 0 shows that it is one, whatever its
/// header begins with.
fn surplus(bytes: &[u8]) -> Option<i64> {
    Some((bytes.len() - START) as i64 - stated(bytes)? as i64)
}

/// A binary file of the right length, with a header that no reader takes for text.
fn plainly_binary(bytes: &[u8]) -> Result<Vec<u8>, Mistake> {
    let Some(expected) = stated(bytes) else {
        return Err(Mistake::WrongFormat { format: "an STL file", start: start_of(bytes) });
    };
    let found = bytes.len() - START;
    match found.checked_sub(expected) {
        None => Err(Mistake::Truncated { expected, found }),
        Some(TRIANGLE..) => Err(Mistake::Excess { expected }),
        Some(_) => Ok([&[0; START - 4], &bytes[START - 4..]].concat()),
    }
}

/// A text file whose solid has a name, as the reader needs it.
fn unnamed_text(bytes: &[u8]) -> Vec<u8> {
    let first = bytes.iter().position(|&b| b == b'\n').unwrap_or(bytes.len());
    [b"solid surface", &bytes[first..]].concat()
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

    fn binary() -> Vec<u8> {
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
        let from_binary = parse(&binary(), LengthUnit::Millimetre).unwrap();
        assert_eq!(from_binary, parse(ascii().as_bytes(), LengthUnit::Millimetre).unwrap());
        assert_eq!((from_binary.vertices.len(), from_binary.triangles.len()), (4, 4));
        assert!(from_binary.vertices.contains(&Vector3::new(0.01, 0.0, 0.0)));
    }

    #[test]
    fn a_binary_surface_whose_header_begins_with_solid_is_read() {
        let mut bytes = binary();
        bytes[..13].copy_from_slice(b"solid surface");
        let read = parse(&bytes, LengthUnit::Metre).unwrap();
        assert_eq!(read, parse(&binary(), LengthUnit::Metre).unwrap());
    }

    #[test]
    fn a_text_surface_needs_no_name() {
        let text = ascii().replace("solid tetrahedron\n", "solid\n");
        let read = parse(text.as_bytes(), LengthUnit::Metre).unwrap();
        assert_eq!(read.triangles.len(), 4);
    }

    #[test]
    fn a_surface_with_more_triangles_than_stated_is_refused() {
        let mut bytes = binary();
        bytes[80] = 3;
        let error = parse(&bytes, LengthUnit::Metre).unwrap_err();
        assert!(matches!(error, Mistake::Excess { expected: 150 }), "{error}");
    }

    #[test]
    fn a_truncated_surface_is_refused_with_its_length() {
        let bytes = binary();
        let error = parse(&bytes[..bytes.len() - 30], LengthUnit::Metre).unwrap_err();
        assert!(matches!(error, Mistake::Truncated { expected: 200, found: 170 }), "{error}");
    }
}
