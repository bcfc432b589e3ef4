//! Coordinates in surface files and the axes that they are along.

use crate::files::error::Mistake;
use std::ops::Neg;

/// Axes of the coordinates, which 3D Slicer writes into a header, a comment or the name of a solid
/// as `SPACE=LPS` or `SPACE=RAS`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Space {
    /// Where nothing is stated, too: coordinates are taken as they are, as those of a drawing.
    #[default]
    Ras,
    Lps,
}

impl Space {
    /// The space that a header, a comment or a name states, if it states one.
    pub(crate) fn stated(header: &[u8]) -> Result<Option<Space>, Mistake> {
        let header = String::from_utf8_lossy(header);
        let words = header.split(|c: char| !c.is_alphanumeric() && c != '=');
        let found = words.into_iter().find_map(|word| word.strip_prefix("SPACE="));
        found.map(Space::named).transpose()
    }

    /// The space of a name.
    pub(crate) fn named(name: &str) -> Result<Space, Mistake> {
        match name {
            "RAS" => Ok(Space::Ras),
            "LPS" => Ok(Space::Lps),
            other => Err(Mistake::bad_field("SPACE", other, "`LPS` or `RAS`")),
        }
    }

    /// A point of this space along R, A and S.
    pub(crate) fn to_ras<T: Neg<Output = T>>(self, [x, y, z]: [T; 3]) -> [T; 3] {
        match self {
            Space::Ras => [x, y, z],
            Space::Lps => [-x, -y, z],
        }
    }
}
