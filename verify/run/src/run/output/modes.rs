//! Natural modes as fields, of the display mesh and of the nodes.
#![allow(non_snake_case)]

use super::body::BodyFrames;
use super::node_fields::field_at_nodes;
use super::vtu::{PointArray, VtuFrame, write_vtu};
use anyhow::Result;
use mtled::Simulation;
use std::path::Path;

/// Writes `nodes_modes.vtu` and, unless nothing of the body is as large as a cell, `body_modes.vtu`,
/// with a field for each mode whose largest displacement of a node is 1.
pub(crate) fn write_modes(simulation: &Simulation, motions: &[&[f64]], dir: &Path) -> Result<()> {
    let positions = &simulation.discretisation.cloud.positions;
    let points: Vec<[f64; 3]> = positions.iter().map(|X| (*X).into()).collect();
    let width = motions.len().to_string().len().max(2);
    let (mut point_data, mut scaled) = (Vec::new(), Vec::new());
    for (number, motion) in (1..).zip(motions) {
        let values = field_at_nodes(simulation, motion)?;
        let squares = values.chunks(3).map(|u| u.iter().map(|x| x * x).sum::<f64>());
        let largest = squares.fold(f64::MIN_POSITIVE, f64::max).sqrt();
        let unit = |values: &[f64]| -> Vec<f64> { values.iter().map(|u| u / largest).collect() };
        let name = format!("mode_{number:0width$}");
        point_data.push(PointArray::new(&name, 3, unit(&values)));
        scaled.push((name, unit(motion)));
    }
    let frame = VtuFrame { numbers: Vec::new(), points: &points, cells: None, point_data };
    write_vtu(&dir.join("nodes_modes.vtu"), &frame)?;
    if let Some(body) = BodyFrames::new(simulation)? {
        let frame = body.motions(&scaled, simulation.model.components);
        write_vtu(&dir.join("body_modes.vtu"), &frame)?;
    }
    Ok(())
}
