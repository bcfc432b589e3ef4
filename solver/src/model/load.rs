//! External forces: body forces and dead tractions.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::geometry::Panel;
use crate::problem::{Amplitude, Problem};

/// A nodal force pattern \[N\] with the amplitude that scales it.
#[derive(Debug, Clone)]
pub struct LoadPattern {
    /// \[component of node\] \[N\]
    pub force: Vec<f64>,
    pub amplitude: Amplitude,
}

/// All load patterns of a problem: body forces Σ_q ρ w_q φ_a b and tractions
/// ∮ φ_a t dA over the selected boundary panels, by the quadrature that consistent
/// gradients balance exactly.
pub fn load_patterns(
    problem: &Problem,
    discretisation: &Discretisation,
    density: &[f64],
) -> Result<Vec<LoadPattern>, Error> {
    let d = problem.dimension.components();
    let size = d * discretisation.cloud.positions.len();
    let mut patterns = Vec::new();
    for body_force in &problem.loads.body_forces {
        let mut force = vec![0.0; size];
        let supports = &discretisation.supports;
        let weights = &discretisation.quadrature.weights;
        for (point, (density, weight)) in density.iter().zip(weights).enumerate() {
            let acceleration =
                body_force.acceleration.at(&discretisation.quadrature.positions[point]);
            let mass = density * weight;
            for entry in supports.row(point) {
                let share = mass * supports.phi[entry];
                add(&mut force, d, supports.nodes[entry], &(acceleration * share));
            }
        }
        patterns.push(LoadPattern { force, amplitude: body_force.amplitude.clone() });
    }
    for traction in &problem.loads.tractions {
        let force = traction_force(problem, discretisation, traction)?;
        patterns.push(LoadPattern { force, amplitude: traction.amplitude.clone() });
    }
    Ok(patterns)
}

fn traction_force(
    problem: &Problem,
    discretisation: &Discretisation,
    traction: &crate::problem::Traction,
) -> Result<Vec<f64>, Error> {
    let d = problem.dimension.components();
    let mut force = vec![0.0; d * discretisation.cloud.positions.len()];
    let chosen = |panel: &Panel| traction.part.contains(&panel.centre);
    if !discretisation.surface.panels.iter().any(chosen) {
        return Err(Error::EmptyTraction { name: traction.name.clone() });
    }
    let nodes = discretisation.cloud.positions.len();
    let density = |panel: &Panel| if chosen(panel) { traction.traction } else { Vector3::zeros() };
    let surface = &discretisation.surface;
    let shares = surface.spread(nodes, &surface.strengths(nodes, density));
    for (node, share) in shares.iter().enumerate() {
        add(&mut force, d, node as u32, share);
    }
    Ok(force)
}

fn add(force: &mut [f64], components: usize, node: u32, share: &Vector3) {
    for k in 0..components {
        force[components * node as usize + k] += share[k];
    }
}
