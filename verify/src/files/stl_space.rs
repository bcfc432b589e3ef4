//! Coordinates in STL files and the axes that they are along.

use super::error::Mistake;

/// Coordinates of a corner as a file has them.
pub(super) type Corner = [f32; 3];

/// Axes of the coordinates, which 3D Slicer writes into the header or the name of a solid as
/// `SPACE=LPS` or `SPACE=RAS`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Space {
    Ras,
    Lps,
}

impl Space {
    /// The space that a header or a name states. Where it states none, the coordinates are taken
    /// as they are, as those of a drawing.
    pub fn stated(header: &[u8]) -> Result<Space, Mistake> {
        let header = String::from_utf8_lossy(header);
        let words = header.split(|c: char| !c.is_alphanumeric() && c != '=');
        let found = words.into_iter().find_map(|word| word.strip_prefix("SPACE="));
        match found {
            None | Some("RAS") => Ok(Space::Ras),
            Some("LPS") => Ok(Space::Lps),
            Some(other) => Err(Mistake::bad_field("SPACE", other, "`LPS` or `RAS`")),
        }
    }

    /// A point of this space along R, A and S.
    pub fn to_ras(self, [x, y, z]: Corner) -> Corner {
        match self {
            Space::Ras => [x, y, z],
            Space::Lps => [-x, -y, z],
        }
    }
}
