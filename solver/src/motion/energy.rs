//! Energies and their balance, and momenta.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Vector3, vector_at};
use crate::force::{internal_force, strain_energy};
use crate::model::Model;
use crate::motion::state::{State, kinetic_energy};

/// Energies \[J\] half a step before the time of the state, like velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energies {
    /// ½ Σ m v².
    pub kinetic: f64,
    /// Σ_q w_q ψ(F_q).
    pub strain: f64,
    /// Work of body forces and tractions.
    pub external_work: f64,
    /// Work of prescribed displacements, and in static runs of contact.
    pub constraint_work: f64,
    /// Dissipated by damping.
    pub damping_loss: f64,
    /// Done against viscous branches, which lose it in time, less what active fibres have done.
    pub extra_work: f64,
    /// Of a motion: kept of nodes that touch obstacles.
    pub contact_energy: f64,
    /// Of a motion: what obstacles have taken for good.
    pub contact_loss: f64,
}

/// Momenta half a step before the time of the state, like velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Momenta {
    /// Σ m v \[kg·m/s\].
    pub linear: Vector3,
    /// Σ m (x − c) × v about a fixed place c \[kg·m²/s\].
    pub angular: Vector3,
}

/// Momenta with the masses of the equation of motion, the angular one about `about` \[m\]. Central
/// differences keep both of a free body to round-off: (x − ½ Δt v) × v is x × v.
pub fn momenta(model: &Model, state: &State, about: &Vector3) -> Momenta {
    let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
    for (node, (mass, X)) in model.inertia.iter().zip(&model.positions).enumerate() {
        let at = |field: &[f64]| vector_at(field, node, model.components);
        let momentum = *mass * at(&state.velocity);
        linear += momentum;
        angular += (X + at(&state.displacement) - about).cross(&momentum);
    }
    Momenta { linear, angular }
}

impl Energies {
    /// kinetic + strain + kept and lost in contact + damping loss + extra work − external work − constraint
    /// work \[J\]: constant up to O(Δt²) for central differences.
    pub fn balance(&self) -> f64 {
        let contact = self.contact_energy + self.contact_loss;
        let held = self.kinetic + self.strain + contact + self.damping_loss + self.extra_work;
        held - self.external_work - self.constraint_work
    }
}

/// By how much the mean of the strain energies at t − Δt and t exceeds that between them \[J\],
/// ¼ Δu · Δf_int: without it central differences keep the energy of a linear body exactly.
pub fn excess_of_mean(model: &Model, state: &State) -> f64 {
    let mut workspace = state.workspace(model);
    let mut change = vec![0.0; model.size()];
    let mut before = change.clone();
    let last = displacement_before(state);
    internal_force(&model.points, &state.displacement, &mut workspace, &mut change);
    internal_force(&model.points, &last, &mut workspace, &mut before);
    change.iter_mut().zip(&before).for_each(|(f, b)| *f -= b);
    let moved = state.displacement.iter().zip(&last).map(|(u, b)| u - b);
    0.25 * moved.zip(&change).map(|(u, f)| u * f).sum::<f64>()
}

/// Displacements at t − Δt \[m\].
fn displacement_before(state: &State) -> Vec<f64> {
    let moved = state.displacement.iter().zip(&state.velocity);
    moved.map(|(u, v)| u - state.time_step * v).collect()
}

/// Kinetic energy ½ Σ m v² at t − Δt/2, strain energy as the mean of those at
/// t − Δt and t, and the accumulated work.
pub fn energies(model: &Model, state: &State) -> Energies {
    let before = displacement_before(state);
    let strain = 0.5
        * (strain_energy(&model.points, &before)
            + strain_energy(&model.points, &state.displacement));
    let impacts = &state.contact.impacts;
    Energies {
        kinetic: kinetic_energy(model, &state.velocity),
        strain,
        external_work: state.work.external,
        constraint_work: state.work.constraint - impacts.work,
        damping_loss: state.work.damping + impacts.damped,
        // In a motion what is remembered is a step old, in a static run all of it is.
        extra_work: state.work.extra + 0.5 * state.extra.work_towards(model, &state.displacement),
        contact_energy: impacts.stored(),
        contact_loss: impacts.lost,
    }
}
