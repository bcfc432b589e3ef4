//! Centres of mass as weighted sums of nodal displacements, and what is said of lattices.

use mtled::algebra::tensor::Vector3;
use mtled::discretisation::Discretisation;
use mtled::problem::Problem;
use mtled_case::scene::{Case, Probe};
use mtled_checks::escape::printable;

/// x_c = X_c + Σ_a s_a u_a: the centre of mass of a region.
#[derive(Debug, Clone)]
pub struct MassCentre {
    /// X_c \[m\]
    pub reference: Vector3,
    /// Mass of the region \[kg\].
    pub mass: f64,
    /// s_a = Σ_q ρ w_q φ_a / Σ_q ρ w_q over the points of the region
    /// \[node\] \[–\].
    weights: Vec<f64>,
}

impl MassCentre {
    /// s_a \[node\] \[–\].
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Displacement of the centre \[m\] for nodal parameters `u`.
    pub fn displacement(&self, u: &[f64], components: usize) -> Vector3 {
        let mut displacement = Vector3::zeros();
        for (node, weight) in self.weights.iter().enumerate() {
            for k in 0..components {
                displacement[k] += weight * u[components * node + k];
            }
        }
        displacement
    }
}

/// The centre of mass of every region, in the order of the problem.
pub fn centres_of_mass(problem: &Problem, discretisation: &Discretisation) -> Vec<MassCentre> {
    let nodes = discretisation.cloud.positions.len();
    let empty = MassCentre { reference: Vector3::zeros(), mass: 0.0, weights: vec![0.0; nodes] };
    let mut centres = vec![empty; problem.regions.len()];
    for (quadrature, rows) in discretisation.volumes() {
        for point in 0..rows.len() {
            let region = quadrature.regions[point] as usize;
            let mass = problem.regions[region].material.density * quadrature.weights[point];
            let centre = &mut centres[region];
            centre.mass += mass;
            centre.reference += quadrature.positions[point] * mass;
            for entry in rows.row(point) {
                centre.weights[rows.nodes[entry] as usize] += mass * rows.phi[entry];
            }
        }
    }
    for centre in centres.iter_mut().filter(|centre| centre.mass > 0.0) {
        centre.reference /= centre.mass;
        centre.weights.iter_mut().for_each(|weight| *weight /= centre.mass);
    }
    centres
}

/// A line for every lattice that reaches beyond the body.
pub(crate) fn left_out_text(case: &Case) -> Vec<String> {
    let reaching = case.probes.iter().filter(|probe| probe.kind.left_out() > 0);
    let line = |probe: &Probe| {
        format!(
            "  lattice \"{}\": {} of {} positions are recorded, the others lie outside the body",
            printable(&probe.name),
            probe.kind.count(),
            probe.kind.count() + probe.kind.left_out()
        )
    };
    reaching.map(line).collect()
}
