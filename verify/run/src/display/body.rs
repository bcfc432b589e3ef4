//! The display mesh of a body.
#![allow(non_snake_case)]

use super::cut::cut_away;
use super::lattice::Lattice;
use super::mesh::Mesh;
use super::regions::into_regions;
use super::sharpen::sharpen;
use super::snap::{Freedom, snap};
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{GeometryError, Shape};
use mtled::problem::{Dimension, Problem};

/// Boxes per node of a small body: steps of the lattice are half a spacing.
const PER_NODE: f64 = 8.0;
/// Boxes of a body, unless it has more nodes.
const BOXES: f64 = 4000.0;
/// The most boxes of a body.
const MOST_BOXES: f64 = 60_000.0;
/// The most boxes of a lattice, most of them outside of the body.
const MOST_OF_LATTICE: f64 = 3e7;
/// The volume of the mesh may differ from that of the body by this part of it before the lattice
/// is refined \[–\].
const CLOSE: f64 = 0.02;
/// What a lattice is refined by \[–\].
const FINER: f64 = 0.7;
/// How often it is refined.
const MOST_REFINEMENTS: usize = 3;

/// A mesh that fills the body, to look at and never to compute on.
#[derive(Debug, Clone)]
pub(crate) struct DisplayMesh {
    /// Its cells, each with its region.
    pub mesh: Mesh,
    /// Whether a vertex is on the boundary.
    pub on_boundary: Vec<bool>,
    /// Step of the lattice that it was cut from \[m\].
    pub edge: f64,
}

/// The display mesh of the body of a problem with this many nodes, whose volume \[m³\] is known.
/// Its lattice has about eight boxes per node for small bodies, one for large ones and at most
/// 60 000 in all, and is refined where thin parts would be lost.
pub(crate) fn display_mesh(
    problem: &Problem,
    nodes: usize,
    volume: f64,
) -> Result<DisplayMesh, GeometryError> {
    let dimension = &problem.dimension;
    let body = problem.body.section(dimension)?;
    let known = volume / dimension.thickness();
    let components = dimension.components() as f64;
    let mut edge = (known / expected_boxes(nodes as f64)).powf(1.0 / components);
    let mut mesh = body_mesh(&body, dimension, edge)?;
    for _ in 0..MOST_REFINEMENTS {
        let boxes = known / (FINER * edge).powf(components);
        if (mesh.volume() - known).abs() < CLOSE * known || boxes > MOST_BOXES {
            break;
        }
        edge *= FINER;
        mesh = body_mesh(&body, dimension, edge)?;
    }
    if problem.regions.len() > 1 {
        into_regions(&mut mesh, &problem.regions, &body, dimension);
    }
    let mut on_boundary = vec![false; mesh.vertices.len()];
    for (side, _) in mesh.boundary() {
        side.iter().for_each(|&vertex| on_boundary[vertex as usize] = true);
    }
    Ok(DisplayMesh { mesh, on_boundary, edge })
}

/// Boxes of the lattice in a body with this many nodes, unless thin parts need more.
pub(crate) fn expected_boxes(nodes: f64) -> f64 {
    (PER_NODE * nodes).min(BOXES).max(nodes).min(MOST_BOXES)
}

/// The cells of a lattice of steps of about `edge` \[m\] inside a solid, which is a cross-section
/// in a plane.
pub(crate) fn body_mesh(
    shape: &Shape,
    dimension: &Dimension,
    edge: f64,
) -> Result<Mesh, GeometryError> {
    let unbounded = GeometryError::Unbounded { shape: "body" };
    let (mut lower, mut upper) = shape.bounding_box().ok_or(unbounded)?;
    if let Dimension::PlaneStrain { z, .. } = dimension {
        (lower.z, upper.z) = (*z, *z);
    }
    let mut edge = edge;
    while Lattice::boxes(&lower, &upper, edge) > MOST_OF_LATTICE {
        edge /= FINER;
    }
    let lattice = Lattice::new(lower, upper, edge);
    let level = |X: &Vector3| lattice.level(shape, X);
    let (mut mesh, mut values) = lattice.cells(shape);
    let sides = mesh.vertices.iter().map(|X| lattice.sides(X)).collect();
    let freedom = Freedom { fixed: vec![false; mesh.vertices.len()], sides };
    snap(&mut mesh, &mut values, &level, &freedom);
    let (mut mesh, _) = cut_away(&mesh, &values, &level);
    sharpen(&mut mesh, shape, edge);
    // Cuts through four points of a plane may leave nothing of a cell.
    let smallest = 1e-9 * lattice.cell_measure();
    debug_assert!(mesh.iter().all(|cell| mesh.measure(cell) > smallest));
    mesh.drop_unused_vertices();
    Ok(mesh)
}
