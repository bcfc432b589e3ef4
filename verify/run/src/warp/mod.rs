//! Images, landmarks and surfaces moved by the displacement field of a run.

mod deform;
mod error;
mod field;
mod inverse;
mod landmarks;
mod surfaces;

pub use deform::{Deformed, deform, forward_field, nodes_outside};
pub use error::WarpError;
pub use field::DisplacementField;
pub use inverse::{TOLERANCE, source_of};
pub use landmarks::{MovedLandmark, move_landmarks, to_csv};
pub use surfaces::{RegionSurface, region_surfaces};
