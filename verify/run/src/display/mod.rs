//! A mesh that fills the body, to look at and never to compute on: tetrahedra in space, triangles
//! in a plane, with a smooth boundary and smooth interfaces of regions.

mod body;
mod cut;
mod fill;
mod lattice;
mod mesh;
mod regions;
mod sharpen;
mod snap;

pub(crate) use body::{DisplayMesh, display_mesh, expected_boxes};
pub(crate) use cut::{Parents, cut_away};
pub use mesh::Mesh;
pub(crate) use regions::solid;

#[cfg(test)]
mod tests;
