//! Polygons in the plane.

mod corners;
mod outline;

pub(super) use corners::{anticlockwise, closed_chains, polygon_area, triangulate};
pub use outline::Outline;
