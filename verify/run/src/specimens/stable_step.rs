//! The largest stable step of real runs, found by bisection.

use mtled::algebra::random::Random;
use mtled::model::Model;
use mtled::motion::state::State;
use mtled::motion::step::{Buffers, Scheme, step};

/// Steps of a trial run. A step 0.1 % above the limit multiplies the highest
/// mode by 1 + √(8·0.001) = 1.09 in each step, by 10¹⁹ in all.
pub const TRIAL_STEPS: usize = 500;
/// Growth of the kinetic energy above which a run is unstable: modes just below the limit
/// grow by no more than the square of the number of steps.
pub const GROWTH: f64 = 1e8;
/// Width of the bracket at which bisection ends \[–\].
pub const BISECTION: f64 = 1e-3;

/// A random velocity \[m/s\], a value per component of each node, that moves nodes by 1e-8 of the
/// spacing in a step of the size of the per-point bound.
pub fn trial_velocity(model: &Model, spacing: &[f64]) -> Vec<f64> {
    let finest = spacing.iter().copied().fold(f64::INFINITY, f64::min);
    let size = 1e-8 * finest / model.per_point_bound;
    let mut random = Random(11);
    (0..model.size()).map(|_| size * random.symmetric()).collect()
}

/// Largest stable step \[s\] by bisection between a stable and an unstable one; `guess` is
/// only where the search starts.
pub fn largest_stable_step(model: &Model, u: &[f64], t: f64, velocity: &[f64], guess: f64) -> f64 {
    let stable = |time_step: f64| is_stable(model, u, t, velocity, time_step);
    let (mut low, mut high) = (0.98 * guess, 1.02 * guess);
    while !stable(low) {
        (low, high) = (0.8 * low, low);
    }
    while stable(high) {
        (low, high) = (high, 1.2 * high);
    }
    while high - low > BISECTION * low {
        let middle = 0.5 * (low + high);
        if stable(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Integrates without damping, with the conditions constant as at time `t`.
fn is_stable(model: &Model, u: &[f64], t: f64, velocity: &[f64], time_step: f64) -> bool {
    let mut state = State::new(model);
    state.displacement.copy_from_slice(u);
    state.velocity.copy_from_slice(velocity);
    let mut buffers = Buffers::new(model, false);
    let scheme = Scheme::central_difference(time_step, time_step, 0.0);
    let mut first = None;
    for _ in 0..TRIAL_STEPS {
        step(model, &scheme, t, t, &mut state, &mut buffers);
        let energy = kinetic_energy(model, &state);
        let first = *first.get_or_insert(energy);
        if energy.is_nan() || energy >= GROWTH * first {
            return false;
        }
    }
    true
}

fn kinetic_energy(model: &Model, state: &State) -> f64 {
    let d = model.components;
    let squares = |node: usize| state.velocity[d * node..d * (node + 1)].iter().map(|v| v * v);
    let energy = |(node, mass): (usize, &f64)| 0.5 * mass * squares(node).sum::<f64>();
    model.lumped_mass.iter().enumerate().map(energy).sum()
}
