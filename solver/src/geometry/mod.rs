//! Solids, their boundaries, and selections of their points (method book,
//! section 4).

mod boundary;
mod dimension;
mod distance_function;
mod error;
mod field;
mod line_of_sight;
mod part;
mod point_hash;
mod polygon;
mod primitives;
mod section;
mod selection;
mod shape;
mod size_limit;
mod surface;
mod triangles;
mod validate;
mod voxels;

pub use boundary::Panel;
pub(crate) use boundary::{
    BoundaryPoints, CLEARANCE, TargetSpacing, boundary_points, lattice_cells, merges_voxels,
    nearest_count, project,
};
pub use dimension::Dimension;
pub use distance_function::DistanceFunction;
pub(crate) use error::positive;
pub use error::{EdgeFault, EdgeFaults, GeometryError};
pub use field::{Field, Scattered, TooFewData};
pub(crate) use line_of_sight::Place;
pub(crate) use part::CoveredPanel;
pub(crate) use point_hash::PointHash;
pub use polygon::Outline;
pub use selection::{Extent, Selector};
pub use shape::Shape;
pub(crate) use size_limit::{CELLS, DISTANCE_SAMPLES, NODES, POINTS};
pub use surface::{Mended, Surface, SurfaceNote};
pub(crate) use voxels::{KnownDistance, ScalarGrid, indices};
pub use voxels::{LabelField, LabelMap};

#[cfg(test)]
mod tests;
