//! The boundary of a solid: panels for integrals, points for nodes, outlines.

mod composite;
mod creases;
mod curve_panels;
mod features;
mod marching;
mod merged_triangles;
mod panel;
mod panels;
mod patch;
mod points;
mod solid_panels;
mod target_spacing;
mod vicinity;
mod voxel_panels;

pub(crate) use features::CLEARANCE;
pub use panel::Panel;
pub(crate) use patch::{Level, Patch};
pub(crate) use points::{BoundaryPoints, boundary_points, project};
pub(crate) use target_spacing::{TargetSpacing, lattice_cells, nearest_count};
pub(crate) use voxel_panels::merges_voxels;

#[cfg(test)]
mod tests;
