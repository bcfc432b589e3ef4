//! Fields at the nodes.
#![allow(non_snake_case)]

use crate::run::error_bar::Indicator;
use crate::run::prepare::Prepared;
use crate::run::record::Frame;
use anyhow::Result;
use mtled::algebra::tensor::Matrix3;
use mtled::motion::internal_force::projected_mean_stress;
use mtled::problem::Problem;

/// Displacement of the approximation (not the nodal parameters), and J, Cauchy stress and strain
/// averaged from the quadrature points around.
#[derive(Debug)]
pub struct NodeFields {
    /// \[node\]\[x, y, z\] \[m\]
    pub displacement: Vec<f64>,
    /// \[node\] \[–\]
    pub jacobian: Vec<f64>,
    /// \[node\]\[by rows\] \[Pa\]
    pub stress: Vec<f64>,
    /// Green–Lagrange strain \[node\]\[xx, yy, zz, xy, yz, zx\] \[–\].
    pub strain: Vec<f64>,
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
        let (jacobian, stress, strain) = averaged(problem, prepared, frame);
        let (plan, discretisation) = (&prepared.model.contact, &prepared.discretisation);
        let contact_pressure = prepared
            .contact_surface(problem)?
            .map(|surface| surface.pressures((plan, frame.time), discretisation, &frame.contact, u))
            .transpose()?;
        let error_bar = indicator.map(|indicator| indicator.sizes(&displacement));
        let time = frame.time;
        Ok(NodeFields { time, displacement, jacobian, stress, strain, contact_pressure, error_bar })
    }

    /// Pressure \[node\] \[Pa\].
    pub fn pressure(&self) -> Vec<f64> {
        self.stress.chunks(9).map(|s| -(s[0] + s[4] + s[8]) / 3.0).collect()
    }
}

/// Values at the nodes of the field with nodal parameters `u` \[node\]\[x, y, z\].
pub fn field_at_nodes(prepared: &Prepared, u: &[f64]) -> Result<Vec<f64>> {
    let rows = prepared.discretisation.rows_at(&prepared.discretisation.cloud.positions)?;
    let value = |i| <[f64; 3]>::from(rows.interpolate(i, u, prepared.model.components));
    Ok((0..rows.len()).flat_map(value).collect())
}

/// J \[–\], Cauchy stress by rows \[Pa\], projected pressure included, and Green–Lagrange strain
/// \[–\], averaged over the quadrature points that a node supports, weighted by volume times φ
/// where positive.
fn averaged(
    problem: &Problem,
    prepared: &Prepared,
    frame: &Frame,
) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let u = &frame.displacement;
    let discretisation = &prepared.discretisation;
    let (rows, quadrature) = (&discretisation.supports, &discretisation.quadrature);
    let nodes = discretisation.cloud.positions.len();
    let (mut total, mut jacobian, mut stress, mut strain) =
        (vec![0.0; nodes], vec![0.0; nodes], vec![0.0; 9 * nodes], vec![0.0; 6 * nodes]);
    let frames = prepared.model.fibre_frames();
    let projected = projected_mean_stress(&prepared.model, u);
    for (point, mean_stress) in projected.into_iter().enumerate() {
        let F = rows.deformation_gradient(point, u, prepared.model.components);
        let law = &problem.regions[quadrature.regions[point] as usize].material.law;
        // The Cauchy stress is the same in every frame of the material.
        let own = frames[point].filter(|_| law.has_fibres()).map_or(F, |frame| F * frame);
        let mut sigma = law.cauchy(&own) + Matrix3::from_diagonal_element(mean_stress);
        if let Some(&[xx, yy, zz, xy, yz, xz]) = frame.extra_stress.get(point) {
            let S = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            sigma += F * S * F.transpose() / F.determinant();
        }
        let E = 0.5 * (F.transpose() * F - Matrix3::identity());
        let E = [E.m11, E.m22, E.m33, E.m12, E.m23, E.m13];
        for entry in rows.row(point) {
            let node = rows.nodes[entry] as usize;
            let weight = quadrature.weights[point] * rows.phi[entry].max(1e-6);
            total[node] += weight;
            jacobian[node] += weight * F.determinant();
            for (k, value) in sigma.transpose().iter().enumerate() {
                stress[9 * node + k] += weight * value;
            }
            for (k, value) in E.iter().enumerate() {
                strain[6 * node + k] += weight * value;
            }
        }
    }
    for node in 0..nodes {
        // Within what is held as a volume nothing deforms.
        if total[node] == 0.0 {
            jacobian[node] = 1.0;
            continue;
        }
        jacobian[node] /= total[node];
        stress[9 * node..9 * node + 9].iter_mut().for_each(|value| *value /= total[node]);
        strain[6 * node..6 * node + 6].iter_mut().for_each(|value| *value /= total[node]);
    }
    (jacobian, stress, strain)
}
