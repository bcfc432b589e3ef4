//! Faces of VTP files, XML of PolyData.

use super::legacy_vtk::cells;
use super::polygons::Polygons;
use super::space::Space;
use crate::files::error::Mistake;
use crate::files::vtk_xml::{Array, XmlFile};

/// The parts of a file that are read.
const SECTIONS: [&str; 6] = ["FieldData", "Points", "Verts", "Lines", "Strips", "Polys"];

/// The faces of all pieces of a file.
pub(crate) fn polygons(bytes: &[u8]) -> Result<Polygons, Mistake> {
    let file = XmlFile::parse(bytes, &SECTIONS, "a VTP file (XML with <VTKFile>)")?;
    let mut found = Polygons::default();
    found.space = space(&file)?.unwrap_or_default();
    let last = file.arrays.iter().map(|array| array.piece).max().unwrap_or(0);
    (0..=last).try_for_each(|number| piece(&file, number, &mut found))?;
    Ok(found)
}

fn piece(file: &XmlFile, piece: usize, found: &mut Polygons) -> Result<(), Mistake> {
    let values = |section: &str, name: Option<&str>| {
        let is = |array: &&Array| {
            let is_named = name.is_none() || array.name() == name;
            array.piece == piece && array.section == section && is_named
        };
        let array = file.arrays.iter().find(is);
        Ok(array.map(|array| file.values(array)).transpose()?.unwrap_or_default())
    };
    let cells_of = |section: &str| -> Result<Vec<Vec<u32>>, Mistake> {
        let points = values(section, Some("connectivity"))?;
        cells(&values(section, Some("offsets"))?, &points)
    };
    let before = found.points.len() as u32;
    let points = values("Points", None)?;
    if points.len() % 3 != 0 {
        let (points, found) = (points.len() / 3, points.len());
        return Err(Mistake::CoordinateCount { points, expected: 3 * points, found });
    }
    found.points.extend(points.chunks_exact(3).map(|p| [p[0], p[1], p[2]]));
    let moved = |cell: Vec<u32>| -> Vec<u32> {
        cell.into_iter().map(|n| n.saturating_add(before)).collect()
    };
    cells_of("Polys")?.into_iter().for_each(|face| found.push(moved(face)));
    cells_of("Strips")?.into_iter().for_each(|strip| found.push_strip(&moved(strip)));
    found.lines += cells_of("Verts")?.len() + cells_of("Lines")?.len();
    Ok(())
}

/// Axes of the coordinates, which 3D Slicer writes as a text.
fn space(file: &XmlFile) -> Result<Option<Space>, Mistake> {
    let is = |array: &&Array| array.section == "FieldData" && array.name() == Some("SPACE");
    let stated = file.arrays.iter().find(is);
    stated.map(|array| Space::named(&file.letters(array)?)).transpose()
}
