//! Parts of a body.

use serde::{Deserialize, Serialize};

/// A part of the body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// What lies within `depth` edges of the box's lower or upper face along an axis.
    End {
        /// 0, 1, 2 for x, y, z.
        axis: u8,
        /// Whether it is the upper end.
        upper: bool,
        /// Over the edge of the box \[–\].
        depth: f64,
    },
    /// The ball about the middle of an end.
    Spot {
        /// 0, 1, 2 for x, y, z.
        axis: u8,
        /// Whether it is the upper end.
        upper: bool,
        /// Over the edge of the box \[–\].
        radius: f64,
    },
    /// Everything.
    Whole,
    /// The walls of the hole.
    Hole,
}
