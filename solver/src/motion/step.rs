//! One step of the central difference method or of dynamic relaxation.

use crate::algebra::tensor::{Vector3, vector_at};
use crate::force::{SmallestJacobian, Workspace, internal_force};
use crate::model::Model;
use crate::model::contact::{ContactStep, Moved};
use crate::motion::state::State;
use rayon::prelude::*;

/// v(t + Δt/2) = keep · v(t − Δt/2) + push · M⁻¹(f_ext − f_int), then
/// u(t + Δt) = u(t) + Δt v(t + Δt/2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scheme {
    /// \[s\]
    pub time_step: f64,
    /// \[–\]
    pub keep: f64,
    /// \[s\]
    pub push: f64,
    /// From the middle of the last step to the middle of this one \[s\].
    pub mean_step: f64,
    /// Mass-proportional damping α \[1/s\]; for the work of damping only.
    pub damping: f64,
}

impl Scheme {
    /// Central differences with damping α: with a = αΔt̄/2 and Δt̄ the mean of
    /// the two steps, (1 + a) v⁺ = (1 − a) v⁻ + Δt̄ M⁻¹f. For
    /// α = 0 and equal steps this is eq. 3 of Horton 2007. The first step starts
    /// from v(0), half a step back.
    pub fn central_difference(time_step: f64, last_step: f64, damping: f64) -> Scheme {
        let mean_step = 0.5 * (time_step + last_step);
        let a = 0.5 * damping * mean_step;
        Scheme {
            time_step,
            keep: (1.0 - a) / (1.0 + a),
            push: mean_step / (1.0 + a),
            mean_step,
            damping,
        }
    }

    /// What makes forces of m Δu, 1/(Δt push) \[1/s²\].
    fn force_factor(&self) -> f64 {
        1.0 / (self.time_step * self.push)
    }

    /// Dynamic relaxation (Joldes, Wittek, Miller 2011, eq. 10):
    /// u⁺ = α M⁻¹f + (1 + c²)u − c²u⁻ with α = ((c + 1)Δt/2)².
    pub fn relaxation(time_step: f64, c: f64) -> Scheme {
        Scheme {
            time_step,
            keep: c * c,
            push: 0.25 * (c + 1.0) * (c + 1.0) * time_step,
            mean_step: time_step,
            damping: 0.0,
        }
    }
}

/// Vectors that a step needs, allocated once.
#[derive(Debug)]
pub struct Buffers {
    /// For the internal force.
    pub workspace: Workspace,
    /// \[component of node\] \[N\]
    pub f_int: Vec<f64>,
    /// \[component of node\] \[N\]
    pub f_ext: Vec<f64>,
    velocity_before: Vec<f64>,
    /// Whether work is accumulated.
    pub track_work: bool,
}

impl Buffers {
    /// For a model; `track_work` has the steps accumulate work.
    pub fn new(model: &Model, track_work: bool) -> Buffers {
        let zeros = || vec![0.0; model.size()];
        Buffers {
            workspace: Workspace::new(&model.points),
            f_int: zeros(),
            f_ext: zeros(),
            velocity_before: if track_work { zeros() } else { Vec::new() },
            track_work,
        }
    }
}

/// Result of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepReport {
    /// Smallest J before the step.
    pub smallest_jacobian: SmallestJacobian,
    /// Largest change of a displacement component \[m\]; NaN if there is one.
    pub largest_increment: f64,
}

/// Advances `state` by one step; external forces at time `load_time` \[s\],
/// conditions at `target_time` \[s\].
pub fn step(
    model: &Model,
    scheme: &Scheme,
    load_time: f64,
    target_time: f64,
    state: &mut State,
    buffers: &mut Buffers,
) -> StepReport {
    state.extra.interval = state.time_step;
    state.extra.act(model, load_time, &mut buffers.workspace);
    let smallest_jacobian = internal_force(
        &model.points,
        &state.displacement,
        &mut buffers.workspace,
        &mut buffers.f_int,
    );
    state.work.extra += state.extra.remember(model, load_time, &mut buffers.workspace);
    external_force(model, load_time, &mut buffers.f_ext);
    add_following(model, load_time, &state.displacement, &mut buffers.f_ext);
    if buffers.track_work {
        buffers.velocity_before.copy_from_slice(&state.velocity);
    }
    state.contact.impacts.begin(&state.velocity);
    predict(model, scheme, state, buffers);
    let before = std::mem::replace(&mut state.force_factor, scheme.force_factor());
    let times = (load_time, target_time);
    let largest_increment = constrain(model, (scheme, before), times, state);
    if buffers.track_work {
        add_work(model, scheme, state, buffers);
    }
    state.step += 1;
    state.time = target_time;
    state.time_step = scheme.time_step;
    StepReport { smallest_jacobian, largest_increment }
}

/// Adds the forces that depend on displacements `u` \[m\], at time `t` \[s\], which
/// [`external_force`] leaves out.
pub fn add_following(model: &Model, t: f64, u: &[f64], f_ext: &mut [f64]) {
    model.following.add_force((t, None), u, model.components, f_ext);
}

/// Sum of all load patterns at time `t` \[s\]: what does not depend on displacements.
pub fn external_force(model: &Model, t: f64, f_ext: &mut [f64]) {
    let length = CHUNK * model.components;
    let add = |(chunk, f_ext): (usize, &mut [f64])| {
        f_ext.fill(0.0);
        for load in &model.loads {
            let (amplitude, force) = (load.amplitude.at(t), &load.force[chunk * length..]);
            f_ext.iter_mut().zip(force).for_each(|(f, pattern)| *f += amplitude * pattern);
        }
    };
    if f_ext.len() <= length {
        add((0, f_ext))
    } else {
        f_ext.par_chunks_mut(length).enumerate().for_each(add)
    }
}

/// Nodes of a chunk, the unit of work of a thread; smaller models stay on one thread.
const CHUNK: usize = 4096;

/// The free step.
fn predict(model: &Model, scheme: &Scheme, state: &mut State, buffers: &Buffers) {
    let (d, inertia) = (model.components, &model.inertia);
    let State { velocity, displacement, .. } = state;
    let Buffers { f_ext, f_int, .. } = buffers;
    if inertia.len() <= CHUNK {
        return predict_chunk(d, scheme, inertia, (velocity, displacement), (f_ext, f_int));
    }
    let moving = velocity.par_chunks_mut(d * CHUNK).zip(displacement.par_chunks_mut(d * CHUNK));
    let forces = f_ext.par_chunks(d * CHUNK).zip(f_int.par_chunks(d * CHUNK));
    inertia.par_chunks(CHUNK).zip(moving).zip(forces).for_each(|((inertia, moving), forces)| {
        predict_chunk(d, scheme, inertia, moving, forces);
    });
}

fn predict_chunk(
    d: usize,
    scheme: &Scheme,
    inertia: &[f64],
    (velocity, displacement): (&mut [f64], &mut [f64]),
    (f_ext, f_int): (&[f64], &[f64]),
) {
    for (node, mass) in inertia.iter().enumerate() {
        let push = scheme.push / mass;
        for i in d * node..d * (node + 1) {
            velocity[i] = scheme.keep * velocity[i] + push * (f_ext[i] - f_int[i]);
            displacement[i] += scheme.time_step * velocity[i];
        }
    }
}

/// Prescribed displacements, then contact, on u(t + Δt). Returns the largest
/// change of a component \[m\].
fn constrain(
    model: &Model,
    (scheme, factor_before): (&Scheme, f64),
    times: (f64, f64),
    state: &mut State,
) -> f64 {
    let State { displacement, velocity, constraint_forces, contact, .. } = state;
    let rate = 1.0 / scheme.time_step;
    let (positions, mass) = (&model.positions, &model.inertia);
    model.constraints.enforce(
        times.1,
        positions,
        mass,
        displacement,
        constraint_forces,
        |i, delta| {
            velocity[i] += delta * rate;
        },
    );
    let increment = largest_or_nan(velocity) * scheme.time_step;
    if model.contact.obstacles.is_empty() {
        return increment;
    }
    let time_step = scheme.time_step;
    contact.impacts.note_free(velocity);
    let growth = factor_before / scheme.force_factor();
    let moving = ContactStep { mass, displacement, velocity, times, time_step, growth };
    contact.enforce(&model.contact, positions, increment, moving);
    let (time_step, keep) = (scheme.time_step, scheme.keep);
    let moved = Moved { positions, mass, displacement, velocity, times, time_step, keep };
    contact.settle_impacts(&model.contact, moved);
    // What contact takes back is no movement: a node that is pressed against an obstacle
    // in equilibrium would seem to move for ever.
    let after = largest_or_nan(velocity) * scheme.time_step;
    contact.has_moved(&model.contact, after - increment);
    after
}

/// Largest size of an entry; NaN if there is one, which `f64::max` drops.
fn largest_or_nan(values: &[f64]) -> f64 {
    let largest = |values: &[f64]| {
        let largest = values.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        let sum: f64 = values.iter().sum();
        if sum.is_nan() { f64::NAN } else { largest }
    };
    if values.len() <= 3 * CHUNK {
        return largest(values);
    }
    let larger = |a: f64, b: f64| if a.is_nan() || a > b { a } else { b };
    values.par_chunks(3 * CHUNK).map(largest).reduce(|| 0.0, larger)
}

/// Adds the work from the middle of the last step to the middle of this one:
/// force at t times Δt̄ times the mean of the two velocities.
fn add_work(model: &Model, scheme: &Scheme, state: &mut State, buffers: &Buffers) {
    let d = model.components;
    let (mut external, mut total, mut damping) = (0.0, 0.0, 0.0);
    for (node, mass) in model.inertia.iter().enumerate() {
        for i in d * node..d * (node + 1) {
            let mean = 0.5 * (state.velocity[i] + buffers.velocity_before[i]);
            let gained = mass * (state.velocity[i] - buffers.velocity_before[i]);
            let dissipated = scheme.damping * mass * mean * mean * scheme.mean_step;
            let by_forces = (buffers.f_ext[i] - buffers.f_int[i]) * mean * scheme.mean_step;
            external += buffers.f_ext[i] * mean * scheme.mean_step;
            // What is not work of the forces is work of constraints and contact.
            total += gained * mean - by_forces + dissipated;
            damping += dissipated;
        }
    }
    state.work.external += external;
    state.work.constraint += total;
    state.work.damping += damping;
}

/// The node whose displacement is largest or not a number, and that size \[m\].
pub fn worst_node(model: &Model, state: &State) -> (usize, Vector3, f64) {
    let size = |node: usize| {
        let norm = vector_at(&state.displacement, node, model.components).norm();
        if norm.is_nan() { f64::INFINITY } else { norm }
    };
    let worst =
        (0..model.positions.len()).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or_default();
    (worst, model.positions[worst], size(worst))
}
