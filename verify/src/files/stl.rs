//! Triangulated surfaces from STL files, ASCII or binary.

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
    if !bytes.starts_with(b"solid") {
        refuse_truncated(bytes)?;
    }
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
        return Err(Mistake::NotFinite { point });
    }
    let triangles = mesh.faces.iter().map(|face| face.vertices.map(|n| n as u32)).collect();
    Ok(Triangles { vertices, triangles })
}

/// A binary file is 84 bytes and 50 per triangle.
fn refuse_truncated(bytes: &[u8]) -> Result<(), Mistake> {
    let Some(count) = bytes.get(80..84) else {
        return Err(Mistake::WrongFormat { format: "an STL file", start: start_of(bytes) });
    };
    let count = count.iter().rev().fold(0usize, |sum, &byte| sum << 8 | usize::from(byte));
    let (expected, found) = (50 * count, bytes.len() - 84);
    if found < expected { Err(Mistake::Truncated { expected, found }) } else { Ok(()) }
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
    fn a_truncated_surface_is_refused_with_its_length() {
        let bytes = binary();
        let error = parse(&bytes[..bytes.len() - 30], LengthUnit::Metre).unwrap_err();
        assert!(matches!(error, Mistake::Truncated { expected: 200, found: 170 }), "{error}");
    }
}
