//! Closed surfaces in files: STL, OBJ, PLY and PolyData of VTK (.vtp, .vtk) are read, STL is written.

mod ears;
mod kind;
mod legacy_vtk;
mod obj;
mod ply;
mod polygons;
mod space;
mod stl;
mod stl_text;
#[cfg(test)]
mod tests;
mod triangles;
mod vtp;

pub use stl::to_stl;
pub use triangles::{SurfaceFile, Triangles};

use super::bytes::bytes_of;
use super::error::{FileError, Mistake};
use super::unit::LengthUnit;
use kind::Kind;
use polygons::Polygons;
use std::path::Path;

/// Reads a surface, of the format that the extension of its name says; none of them states its
/// unit. A file whose content is of another format is refused.
pub fn read(path: &Path, unit: LengthUnit) -> Result<SurfaceFile, FileError> {
    let kind = Kind::of_name(path).map_err(|mistake| mistake.of(path))?;
    let bytes = bytes_of(path)?;
    parse(&bytes, kind, unit).map_err(|mistake| mistake.of(path))
}

fn parse(bytes: &[u8], kind: Kind, unit: LengthUnit) -> Result<SurfaceFile, Mistake> {
    kind.check_content(bytes)?;
    let polygons: fn(&[u8]) -> Result<Polygons, Mistake> = match kind {
        Kind::Stl => {
            let surface = stl::parse(bytes, unit)?;
            return Ok(SurfaceFile { surface, notes: Vec::new() });
        }
        Kind::Obj => obj::polygons,
        Kind::Ply => ply::polygons,
        Kind::Vtp => vtp::polygons,
        Kind::Vtk => legacy_vtk::polygons,
    };
    polygons(bytes)?.triangles(unit)
}
