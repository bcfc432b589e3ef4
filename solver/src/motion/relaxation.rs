//! Dynamic relaxation: damped motion towards a static solution.

use crate::algebra::packed::largest;
use crate::error::Error;
use crate::model::Model;
use crate::motion::balance::Imbalance;
use crate::motion::observe::{Continue, Observer, notify};
use crate::motion::state::State;
use crate::motion::step::{Buffers, Scheme, external_force, step};
use crate::motion::step_control::{StepController, check_divergence};
use crate::motion::summary::{Convergence, Summary};
use crate::problem::Relaxation;

/// Steps between two estimates of the lowest frequency.
const ESTIMATE_EVERY: usize = 10;
/// Steps between two assessments of the error.
const ASSESS_EVERY: usize = 20;
/// Slowest decay of the error per step that two assessments can resolve \[–\].
const SLOWEST_RATE: f64 = 0.999;

/// Applies the loads over `load_steps` steps, then keeps them constant until the
/// estimated error of the largest displacement is below the tolerance and the
/// residual confirms it (Joldes, Wittek, Miller 2011).
pub(crate) fn relax(
    model: &Model,
    settings: &Relaxation,
    state: &mut State,
    observer: &mut dyn Observer,
) -> Result<Summary, Error> {
    let mut buffers = Buffers::new(model, observer.tracks_work());
    let mut control = StepController::new(model, settings.step, state, &mut buffers)?;
    let mut damping = Damping::new(model, settings);
    let mut convergence = Convergence { estimated_error: f64::INFINITY, residual: f64::INFINITY };
    notify(model, state, &mut buffers, 1.0, 0.0, observer);
    // At a turning point a single increment says nothing: take the largest
    // since the last assessment.
    let (mut increment, mut increment_before) = (0.0f64, f64::INFINITY);
    let mut residuals = 0;
    for count in 1..=settings.max_steps {
        if control.reevaluate(model, state, &mut buffers) {
            damping.reset();
        }
        let load_time =
            |count: usize| settings.load_end * (count as f64 / settings.load_steps as f64).min(1.0);
        let scheme = Scheme::relaxation(control.time_step, damping.c);
        let report =
            step(model, &scheme, load_time(count - 1), load_time(count), state, &mut buffers);
        control.record(model, state, &mut buffers, &report);
        check_divergence(model, state, &report)?;
        increment = increment.max(report.largest_increment);
        damping.update(model, state, &buffers, state.time_step);
        let loaded = count > settings.load_steps;
        // The last assessment says how far it came, should it not converge.
        let last = count == settings.max_steps;
        if loaded && count.is_multiple_of(ASSESS_EVERY) || last {
            let rate = rate(damping.c, increment / increment_before);
            // One window may lie at a turning point, two do not.
            let moved = if loaded { increment.max(increment_before) } else { increment };
            residuals += 1;
            convergence = assess(model, state, &mut buffers, rate, moved);
        }
        if count.is_multiple_of(ASSESS_EVERY) {
            increment_before = std::mem::take(&mut increment);
        }
        let size = largest(&state.displacement).max(1e-12 * model.extent);
        let converged = loaded
            && convergence.estimated_error <= settings.tolerance * size
            && convergence.residual <= 10.0 * settings.tolerance;
        let progress = if converged { 1.0 } else { progress(count, settings, &convergence, size) };
        let jacobian = report.smallest_jacobian.jacobian;
        let stop =
            notify(model, state, &mut buffers, jacobian, progress, observer) == Continue::Stop;
        if converged || stop {
            let summary = control.summary(state, residuals, stop);
            // Stopped early, it may never have been assessed.
            let relaxation = convergence.residual.is_finite().then_some(convergence);
            return Ok(Summary { relaxation, ..summary });
        }
    }
    Err(Error::NotConverged {
        steps: settings.max_steps,
        error: convergence.estimated_error,
        tolerance: settings.tolerance * largest(&state.displacement),
        residual: convergence.residual,
    })
}

/// Adapts the damping factor c to the lowest frequency in motion.
struct Damping {
    c: f64,
    since: usize,
    displacement_change: Vec<f64>,
    force_before: Vec<f64>,
}

impl Damping {
    fn new(model: &Model, settings: &Relaxation) -> Damping {
        // Initially as if the load took one period of the slowest mode.
        let kappa = (settings.load_steps as f64 / std::f64::consts::PI).max(2.0);
        let zeros = vec![0.0; model.size()];
        Damping {
            c: factor(kappa),
            since: 0,
            displacement_change: zeros.clone(),
            force_before: zeros,
        }
    }

    /// Drops the last differences, which belong to another step.
    fn reset(&mut self) {
        self.since = 0;
    }

    /// ω² = |Σ Δu·Δf|/Σ m Δu², κ = 2/(ωΔt), c = (κ − 1)/(κ + 1)
    /// (Joldes, Wittek, Miller 2011, eqs. 17–22).
    fn update(&mut self, model: &Model, state: &State, buffers: &Buffers, time_step: f64) {
        self.since += 1;
        if self.since == ESTIMATE_EVERY - 1 {
            self.force_before.copy_from_slice(&buffers.f_int);
            self.displacement_change.copy_from_slice(&state.velocity);
        }
        if self.since < ESTIMATE_EVERY {
            return;
        }
        self.since = 0;
        let (mut stiffness, mut inertia) = (0.0, 0.0);
        let d = model.components;
        for (node, mass) in model.inertia.iter().enumerate() {
            for i in d * node..d * (node + 1) {
                let change = time_step * self.displacement_change[i];
                stiffness += change * (buffers.f_int[i] - self.force_before[i]);
                inertia += mass * change * change;
            }
        }
        let omega = (stiffness.abs() / inertia).sqrt();
        if omega.is_finite() && omega > 0.0 {
            self.c = factor((2.0 / (omega * time_step)).max(1.5));
        }
    }
}

fn factor(kappa: f64) -> f64 {
    (kappa - 1.0) / (kappa + 1.0)
}

/// Factor by which the error decays in a step (method book, eq. 20.3): c' = c + 0.2(1 − c)
/// for well-chosen damping, or the decay of the increments since the last assessment
/// if that is slower. Growing increments only say that the error is large.
fn rate(c: f64, fallen: f64) -> f64 {
    let observed = fallen.powf(1.0 / ASSESS_EVERY as f64).min(SLOWEST_RATE);
    (c + 0.2 * (1.0 - c)).max(observed)
}

/// Error estimate max|Δu| c'/(1 − c'), and the residual of the static
/// equations.
fn assess(
    model: &Model,
    state: &mut State,
    buffers: &mut Buffers,
    rate: f64,
    increment: f64,
) -> Convergence {
    Convergence {
        estimated_error: increment * rate / (1.0 - rate),
        residual: residual(model, state, buffers),
    }
}

/// Relative residual of the static equations without constraint forces and nodes
/// in contact.
fn residual(model: &Model, state: &mut State, buffers: &mut Buffers) -> f64 {
    external_force(model, state.time, &mut buffers.f_ext);
    let State { displacement, residual_scratch, time, contact, .. } = state;
    let mut imbalance = Imbalance::new(model, displacement, *time, buffers, residual_scratch);
    imbalance.ignore(model, &contact.touching);
    imbalance.relative(model)
}

/// Loading counts as one half, the decay of the error as the other.
fn progress(count: usize, settings: &Relaxation, convergence: &Convergence, size: f64) -> f64 {
    let loaded = (count as f64 / settings.load_steps as f64).min(1.0);
    let relative = convergence.estimated_error / size;
    let fallen = match relative.is_finite() && relative > 0.0 {
        true => (relative.min(1.0).ln() / settings.tolerance.ln()).clamp(0.0, 1.0),
        false => 0.0,
    };
    0.5 * loaded + 0.5 * fallen
}
