//! The formats of surface files, by their names and by their first bytes.

use crate::files::error::Mistake;
use std::path::Path;

/// A format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Stl,
    Obj,
    Ply,
    /// XML of PolyData.
    Vtp,
    /// Legacy VTK file of PolyData.
    Vtk,
}

/// Bytes in which the first words of a file are looked for.
const START: usize = 4096;

impl Kind {
    const ALL: [(&'static str, Kind); 5] = [
        ("stl", Kind::Stl),
        ("obj", Kind::Obj),
        ("ply", Kind::Ply),
        ("vtp", Kind::Vtp),
        ("vtk", Kind::Vtk),
    ];

    /// The format that the extension of a name stands for.
    pub(crate) fn of_name(path: &Path) -> Result<Kind, Mistake> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let known = Kind::ALL.iter().find(|(name, _)| *name == ending);
        known.map(|(_, kind)| *kind).ok_or(Mistake::UnknownSurface)
    }

    fn extension(self) -> &'static str {
        Kind::ALL.iter().find(|(_, kind)| *kind == self).map_or("", |(name, _)| name)
    }

    /// Refuses a file of which the first bytes belong to another format.
    pub(crate) fn check_content(self, bytes: &[u8]) -> Result<(), Mistake> {
        match content(bytes) {
            Some(Content::Surface(found)) if found != self => {
                let (named, extension) = (self.extension(), found.extension());
                Err(Mistake::OtherSurface { named, extension })
            }
            Some(Content::Other(found, remedy)) => Err(Mistake::NoSurface { found, remedy }),
            _ => Ok(()),
        }
    }
}

/// What the first bytes of a file show.
enum Content {
    Surface(Kind),
    /// No surface: what it is, and what to do.
    Other(&'static str, &'static str),
}

fn content(bytes: &[u8]) -> Option<Content> {
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(START)]);
    let start = start.trim_start_matches('\u{feff}');
    let is = |kind| Some(Content::Surface(kind));
    if bytes.starts_with(&[0x1f, 0x8b]) {
        return Some(Content::Other("compressed data (gzip)", "unpack it with gunzip"));
    }
    if bytes.starts_with(b"PK\x03\x04") {
        return Some(Content::Other("a zip archive", "unpack it, or export it as STL"));
    }
    if start.starts_with("ply\n") || start.starts_with("ply\r") {
        return is(Kind::Ply);
    }
    if start.starts_with("# vtk DataFile") {
        return is(Kind::Vtk);
    }
    if let Some(at) = start.find("<VTKFile") {
        let tag = start[at..].split('>').next().unwrap_or_default();
        let other = "extract its surface and save that as PolyData (.vtp), as ParaView does";
        return if tag.contains("PolyData\"") || !tag.contains("type=") {
            is(Kind::Vtp)
        } else {
            Some(Content::Other("a VTK file of another type than PolyData", other))
        };
    }
    let solid = start.trim_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case("solid"));
    if solid && !bytes.contains(&0) && start.to_lowercase().contains("facet") {
        return is(Kind::Stl);
    }
    if start.lines().any(|line| line.starts_with("v ")) && !bytes.contains(&0) {
        return is(Kind::Obj);
    }
    None
}
