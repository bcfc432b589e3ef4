//! Energies and their balance.

use crate::model::Model;
use crate::motion::internal_force::strain_energy;
use crate::motion::state::State;

/// Energies \[J\] half a step before the time of the state, like velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energies {
    /// ½ Σ m v².
    pub kinetic: f64,
    /// Σ_q w_q ψ(F_q).
    pub strain: f64,
    /// Work of body forces and tractions.
    pub external_work: f64,
    /// Work of prescribed displacements and contact.
    pub constraint_work: f64,
    /// Dissipated by damping.
    pub damping_loss: f64,
}

impl Energies {
    /// kinetic + strain + damping loss − external work − constraint work
    /// \[J\]: constant up to O(Δt²) for central differences.
    pub fn balance(&self) -> f64 {
        self.kinetic + self.strain + self.damping_loss - self.external_work - self.constraint_work
    }
}

/// Kinetic energy ½ Σ m v² at t − Δt/2, strain energy as the mean of those at
/// t − Δt and t, and the accumulated work.
pub fn energies(model: &Model, state: &State) -> Energies {
    let d = model.components;
    let mut kinetic = 0.0;
    for (node, mass) in model.inertia.iter().enumerate() {
        let squares = state.velocity[d * node..d * (node + 1)].iter().map(|v| v * v);
        kinetic += 0.5 * mass * squares.sum::<f64>();
    }
    let before: Vec<f64> = state
        .displacement
        .iter()
        .zip(&state.velocity)
        .map(|(u, v)| u - state.time_step * v)
        .collect();
    let strain = 0.5 * (strain_energy(model, &before) + strain_energy(model, &state.displacement));
    Energies {
        kinetic,
        strain,
        external_work: state.work.external,
        constraint_work: state.work.constraint,
        damping_loss: state.work.damping,
    }
}
