//! Directions of fibres.

use crate::scene::format::conditions::{DataFormat, FormulaFormat};
use crate::scene::format::geometry::Triple;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A direction at every place: one of `direction`, `formula` and `data`. Its length does not count.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DirectionFormat {
    /// The same everywhere [–]; left out where another kind is given.
    pub direction: Option<Triple>,
    /// A function of the position; left out where another kind is given.
    pub formula: Option<FormulaFormat>,
    /// Vectors from a file, all of them turned to the same side; left out where another kind is given.
    pub data: Option<DataFormat>,
}
