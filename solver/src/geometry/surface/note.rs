//! What was changed in triangles so that they enclose a solid.

use std::fmt::{Display, Formatter, Result};

/// A change of the triangles that a file or a caller gives; lengths in \[m\].
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "the messages name every field")]
pub enum SurfaceNote {
    Repeated { triangles: usize, at: [f64; 3] },
    Opposite { pairs: usize, at: [f64; 3] },
    Flat { shells: usize, at: [f64; 3] },
    Turned { shell: usize, with: usize, count: usize, at: [f64; 3] },
    Inside { inner: usize, outer: usize, count: usize, at: [f64; 3] },
    Filled { shell: usize, count: usize, at: [f64; 3] },
    United { first: usize, second: usize, count: usize, at: [f64; 3] },
}

impl Display for SurfaceNote {
    fn fmt(&self, f: &mut Formatter) -> Result {
        match self {
            SurfaceNote::Repeated { triangles, at } => write!(
                f,
                "{triangles} triangles repeat others, the first at {at:?} m; each is used once"
            ),
            SurfaceNote::Opposite { pairs, at } => write!(
                f,
                "{pairs} triangles lie on others that face the other way, the first at {at:?} m: \
                 nothing is between them, and both are left out"
            ),
            SurfaceNote::Flat { shells, at } => {
                write!(f, "{shells} shells without volume are left out, the first at {at:?} m")
            }
            SurfaceNote::Turned { shell, with, count, at } => {
                write!(
                    f,
                    "shell {shell} of {count}, at {at:?} m, faces inwards; it is turned outwards"
                )?;
                match with {
                    0 => Ok(()),
                    n => write!(f, ", and with it {n} in it"),
                }
            }
            SurfaceNote::Inside { inner, outer, count, at } => write!(
                f,
                "shell {inner} of {count}, at {at:?} m, lies inside shell {outer} and faces the \
                 same way: the solid is there already, and the shell is left out. If it is a \
                 cavity, turn its triangles inwards"
            ),
            SurfaceNote::Filled { shell, count, at } => write!(
                f,
                "shell {shell} of {count}, at {at:?} m, is a cavity in one shell and lies in \
                 another, which fills it; it is left out"
            ),
            SurfaceNote::United { first, second, count, at } => write!(
                f,
                "shells {first} and {second} of {count} cross near {at:?} m; the solid is their \
                 union"
            ),
        }
    }
}
