//! Fields at the nodes.

use crate::run::error_bar::Indicator;
use crate::run::record::Frame;
use anyhow::Result;
use mtled::Simulation;
use mtled::motion::nodal_fields::NodalFields;

/// Displacement of the approximation (not the nodal parameters), and J, Cauchy stress and strain of
/// the material.
#[derive(Debug)]
pub(crate) struct NodeFields {
    /// \[node\]\[x, y, z\] \[m\]
    pub displacement: Vec<f64>,
    /// J, Cauchy stress and strain.
    pub material: NodalFields,
    /// \[node\] \[Pa\]; nothing without obstacles.
    pub contact_pressure: Option<Vec<f64>>,
    /// Of the frame \[s\].
    pub time: f64,
    /// \[node\] \[m\]; of the last frame.
    pub error_bar: Option<Vec<f64>>,
}

impl NodeFields {
    /// Of a frame, with the error bars of `indicator`.
    pub(crate) fn new(
        simulation: &Simulation,
        frame: &Frame,
        indicator: Option<&Indicator>,
    ) -> Result<NodeFields> {
        let u = &frame.displacement;
        let displacement = field_at_nodes(simulation, u)?;
        let Simulation { problem, model, discretisation, .. } = simulation;
        let material = NodalFields::new(problem, discretisation, model, u, &frame.extra_stress);
        let plan = &model.contact;
        let contact_pressure = simulation
            .contact_surface()?
            .map(|surface| surface.pressures((plan, frame.time), discretisation, &frame.contact, u))
            .transpose()?;
        let error_bar = indicator.map(|indicator| indicator.sizes(&displacement));
        let time = frame.time;
        Ok(NodeFields { time, displacement, material, contact_pressure, error_bar })
    }
}

/// Values at the nodes of the field with nodal parameters `u` \[node\]\[x, y, z\].
pub fn field_at_nodes(simulation: &Simulation, u: &[f64]) -> Result<Vec<f64>> {
    let rows = simulation.discretisation.rows_at(&simulation.discretisation.cloud.positions)?;
    let value = |i| <[f64; 3]>::from(rows.interpolate(i, u, simulation.model.components));
    Ok((0..rows.len()).flat_map(value).collect())
}
