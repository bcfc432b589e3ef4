//! Lumped and fictitious masses.

use crate::discretisation::Discretisation;
use crate::discretisation::quadrature::Quadrature;
use crate::error::Error;
use crate::problem::MassRule;

/// Lumped mass per node \[kg\] from the density of each region \[kg/m³\]: the even split m_a = Σ_q ρ w_q/n_q (Horton 2007, section 2.5) or the
/// row sum m_a = Σ_q ρ w_q φ_a (method book, eqs. 13.1 and 13.2). The total is the
/// body's mass either way, that of what is held as a volume included.
pub fn lumped_mass(
    discretisation: &Discretisation,
    density: &[f64],
    rule: MassRule,
) -> Result<Vec<f64>, Error> {
    let mut mass = vec![0.0; discretisation.cloud.positions.len()];
    for (quadrature, rows) in discretisation.volumes() {
        for (point, point_mass) in masses(quadrature, density).enumerate() {
            let row = rows.row(point);
            let even_part = point_mass / row.len() as f64;
            for entry in row {
                mass[rows.nodes[entry] as usize] += match rule {
                    MassRule::EvenSplit => even_part,
                    _ => point_mass * rows.phi[entry],
                };
            }
        }
    }
    let mean = mass.iter().sum::<f64>() / mass.len() as f64;
    match mass.iter().position(|&m| m.is_nan() || m <= 1e-9 * mean) {
        Some(node) => Err(Error::MasslessNode {
            node,
            position: discretisation.cloud.positions[node],
            mass: mass[node],
        }),
        None => Ok(mass),
    }
}

/// Masses of points \[kg\] from the density of each region \[kg/m³\].
pub fn masses(quadrature: &Quadrature, density: &[f64]) -> impl Iterator<Item = f64> {
    let points = quadrature.regions.iter().zip(&quadrature.weights);
    points.map(|(&region, weight)| density[region as usize] * weight)
}

/// Masses \[node\] \[kg\] in proportion to `stiffness` \[node\] \[N/m\], with the
/// total of `lumped_mass` \[kg\] (method book, eq. 13.4).
pub fn fictitious_mass(stiffness: &[f64], lumped_mass: &[f64]) -> Vec<f64> {
    let factor = lumped_mass.iter().sum::<f64>() / stiffness.iter().sum::<f64>();
    stiffness.iter().map(|stiffness| factor * stiffness).collect()
}
