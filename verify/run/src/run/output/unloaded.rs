//! A body without loads as fields and as a surface.
#![allow(non_snake_case)]

use super::body::BodyFrames;
use super::node_fields::field_at_nodes;
use super::vtu::{PointArray, VtuFrame, write_vtu};
use anyhow::Result;
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled_checks::report::write_atomically;
use mtled_io::files::surface::{Triangles, to_stl};
use std::path::Path;

/// Writes the body without loads, `offsets` \[component of node\] \[m\] from the known shape:
/// `nodes_unloaded.vtu` and, unless nothing of the body is as large as a cell, `body_unloaded.vtu`, whose
/// field `displacement` leads to the known shape; in space `unloaded.stl` too, its surface.
pub fn write_unloaded(simulation: &Simulation, offsets: &[f64], dir: &Path) -> Result<()> {
    let positions = &simulation.discretisation.cloud.positions;
    let values = field_at_nodes(simulation, offsets)?;
    let moved = |(X, w): (&Vector3, &[f64])| [X.x + w[0], X.y + w[1], X.z + w[2]];
    let points: Vec<[f64; 3]> = positions.iter().zip(values.chunks(3)).map(moved).collect();
    let back = values.iter().map(|w| -w).collect();
    let point_data = vec![PointArray::new("displacement", 3, back)];
    let frame = VtuFrame { numbers: Vec::new(), points: &points, cells: None, point_data };
    write_vtu(&dir.join("nodes_unloaded.vtu"), &frame)?;
    let Some(mut body) = BodyFrames::new(simulation)? else { return Ok(()) };
    let components = simulation.model.components;
    body.move_by(offsets, components);
    let back: Vec<f64> = offsets.iter().map(|w| -w).collect();
    let frame = body.motions(&[("displacement".to_string(), back)], components);
    write_vtu(&dir.join("body_unloaded.vtu"), &frame)?;
    if components == 3 {
        let (vertices, triangles) = body.surface();
        let surface = Triangles { vertices, triangles };
        write_atomically(&dir.join("unloaded.stl"), &to_stl(&surface))?;
    }
    Ok(())
}
