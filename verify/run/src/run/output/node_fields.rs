//! Fields at the nodes.

use crate::run::error_bar::Indicator;
use crate::run::prepare::Prepared;
use crate::run::record::Frame;
use anyhow::Result;
use mtled::motion::nodal_fields::NodalFields;
use mtled::problem::Problem;

/// Displacement of the approximation (not the nodal parameters), and J, Cauchy stress and strain of
/// the material.
#[derive(Debug)]
pub struct NodeFields {
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
    pub fn new(
        problem: &Problem,
        prepared: &Prepared,
        frame: &Frame,
        indicator: Option<&Indicator>,
    ) -> Result<NodeFields> {
        let u = &frame.displacement;
        let displacement = field_at_nodes(prepared, u)?;
        let (model, discretisation) = (&prepared.model, &prepared.discretisation);
        let material = NodalFields::new(problem, discretisation, model, u, &frame.extra_stress);
        let plan = &model.contact;
        let contact_pressure = prepared
            .contact_surface(problem)?
            .map(|surface| surface.pressures((plan, frame.time), discretisation, &frame.contact, u))
            .transpose()?;
        let error_bar = indicator.map(|indicator| indicator.sizes(&displacement));
        let time = frame.time;
        Ok(NodeFields { time, displacement, material, contact_pressure, error_bar })
    }
}

/// Values at the nodes of the field with nodal parameters `u` \[node\]\[x, y, z\].
pub fn field_at_nodes(prepared: &Prepared, u: &[f64]) -> Result<Vec<f64>> {
    let rows = prepared.discretisation.rows_at(&prepared.discretisation.cloud.positions)?;
    let value = |i| <[f64; 3]>::from(rows.interpolate(i, u, prepared.model.components));
    Ok((0..rows.len()).flat_map(value).collect())
}
