//! Meshes of tetrahedra or triangles with their fields from VTU files.

use crate::files::bytes::bytes_of;
use crate::files::error::{FileError, Mistake, check_finite};
use crate::files::vtk_xml::XmlFile;
use mtled::algebra::tensor::Vector3;
use std::path::Path;

/// A mesh with the fields at its points and in its cells.
#[derive(Debug, Clone)]
pub struct MeshFile {
    /// \[m\]
    pub points: Vec<Vector3>,
    /// Corners of a cell: 4 of a tetrahedron, 3 of a triangle.
    pub corners: usize,
    /// Points of the cells, one cell after the other.
    pub cells: Vec<u32>,
    /// Fields at the points.
    pub point_data: Vec<NamedArray>,
    /// Fields in the cells.
    pub cell_data: Vec<NamedArray>,
}

/// A field of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedArray {
    /// Its name in the file.
    pub name: String,
    /// Numbers at a point or in a cell.
    pub components: usize,
    /// \[point or cell\]\[component\]
    pub values: Vec<f64>,
}

/// The parts of a file that have arrays.
const SECTIONS: [&str; 4] = ["Points", "Cells", "PointData", "CellData"];

/// Reads the mesh of a VTU file.
pub fn read_mesh(path: &Path) -> Result<MeshFile, FileError> {
    let bytes = bytes_of(path)?;
    parse(&bytes).map_err(|mistake| mistake.of(path))
}

pub(crate) fn parse(bytes: &[u8]) -> Result<MeshFile, Mistake> {
    let file = XmlFile::parse(bytes, &SECTIONS, "a VTU file (XML with <VTKFile>)")?;
    let section = |name: &str| -> Result<Vec<NamedArray>, Mistake> {
        let own = file.arrays.iter().filter(|array| array.section == name && !array.is_text());
        own.map(|array| {
            let components = array.attributes.get("NumberOfComponents");
            let components = components.map_or(Some(1), |n| n.parse().ok());
            Ok(NamedArray {
                name: array.name().unwrap_or_default().to_string(),
                components: components.filter(|n| *n > 0).unwrap_or(1),
                values: file.values(array)?,
            })
        })
        .collect()
    };
    let points = section("Points")?.pop().ok_or(Mistake::NoPoints)?;
    let points: Vec<Vector3> =
        points.values.chunks_exact(3).map(Vector3::from_column_slice).collect();
    check_finite(&points)?;
    let (corners, cells) = cells(&section("Cells")?, points.len())?;
    let count = cells.len() / corners;
    let point_data = checked(section("PointData")?, points.len())?;
    let cell_data = checked(section("CellData")?, count)?;
    Ok(MeshFile { points, corners, cells, point_data, cell_data })
}

/// Arrays of as many values as there are points or cells.
fn checked(arrays: Vec<NamedArray>, places: usize) -> Result<Vec<NamedArray>, Mistake> {
    match arrays.iter().find(|array| array.values.len() != places * array.components) {
        None => Ok(arrays),
        Some(NamedArray { name, values, components }) => Err(Mistake::VectorCount {
            name: name.clone(),
            points: places,
            values: values.len() / components,
        }),
    }
}

/// Corners of a cell, and the points of all.
fn cells(arrays: &[NamedArray], points: usize) -> Result<(usize, Vec<u32>), Mistake> {
    let named = |name: &'static str| {
        let found = arrays.iter().find(|array| array.name == name);
        found.map(|array| &array.values).ok_or(Mistake::MissingField { field: name })
    };
    let (types, offsets, connectivity) =
        (named("types")?, named("offsets")?, named("connectivity")?);
    let expected = "triangles or tetrahedra alone, as `mtled solve` writes them";
    let first = types.first().copied().unwrap_or(0.0);
    let corners = match first as u8 {
        5 => 3,
        10 => 4,
        _ => return Err(Mistake::bad_field("types", &first.to_string(), expected)),
    };
    let other = types.iter().find(|kind| **kind != first);
    let odd = offsets.iter().zip(1..).find(|(end, n)| **end != (corners * n) as f64);
    if let Some(value) = other.or(odd.map(|(end, _)| end)) {
        return Err(Mistake::bad_field("types", &value.to_string(), expected));
    }
    let beyond = connectivity.iter().find(|n| !(0.0..points as f64).contains(*n));
    match beyond {
        Some(number) => Err(Mistake::bad_field(
            "connectivity",
            &number.to_string(),
            "numbers of points of the file",
        )),
        None if connectivity.len() != corners * types.len() => {
            Err(Mistake::Truncated { expected: corners * types.len(), found: connectivity.len() })
        }
        None => Ok((corners, connectivity.iter().map(|n| *n as u32).collect())),
    }
}
