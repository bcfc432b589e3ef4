//! Dynamic relaxation: damped motion towards a static solution.

use crate::algebra::packed::largest;
use crate::error::Error;
use crate::model::Model;
use crate::motion::balance::Imbalance;
use crate::motion::observe::{Continue, Observer};
use crate::motion::pace::{Convergence, Pace, Summary, check, watch};
use crate::motion::state::State;
use crate::motion::step::{Buffers, Scheme, external_force, step};
use crate::problem::Relaxation;

/// Steps between two estimates of the lowest frequency.
const ESTIMATE_EVERY: usize = 10;
/// Steps between two looks at the error.
const LOOK_EVERY: usize = 20;
/// Slowest fall of the error per step that two looks can tell \[–\].
const SLOWEST_RATE: f64 = 0.999;

/// Applies the loads over `load_steps` steps, then holds them until the
/// estimated error of the largest displacement is below the tolerance and the
/// residual confirms it (Joldes, Wittek, Miller 2011).
pub(crate) fn relax(
    model: &Model,
    settings: &Relaxation,
    state: &mut State,
    observer: &mut dyn Observer,
) -> Result<Summary, Error> {
    let mut buffers = Buffers::new(model, observer.tracks_work());
    let mut pace = Pace::new(model, settings.step, state, &mut buffers)?;
    let mut damping = Damping::new(model, settings);
    let mut convergence = Convergence { estimated_error: f64::INFINITY, residual: f64::INFINITY };
    watch(model, state, &mut buffers, 1.0, 0.0, observer);
    // At a turning point a single increment says nothing: take the largest
    // since the last look.
    let (mut increment, mut increment_before) = (0.0f64, f64::INFINITY);
    let mut residuals = 0;
    for count in 1..=settings.max_steps {
        if pace.reevaluate(model, state, &mut buffers) {
            damping.forget();
        }
        let load_time =
            |count: usize| settings.load_end * (count as f64 / settings.load_steps as f64).min(1.0);
        let scheme = Scheme::relaxation(pace.time_step, damping.c);
        let report =
            step(model, &scheme, load_time(count - 1), load_time(count), state, &mut buffers);
        pace.record(model, state, &mut buffers, &report);
        check(model, state, &report)?;
        increment = increment.max(report.largest_increment);
        damping.learn(model, state, &buffers, state.time_step);
        let held = count > settings.load_steps;
        // The last look tells how far it came, should it not have converged.
        let last = count == settings.max_steps;
        if held && count.is_multiple_of(LOOK_EVERY) || last {
            let rate = rate(damping.c, increment / increment_before);
            // One window may lie at a turning point, two do not.
            let moved = if held { increment.max(increment_before) } else { increment };
            residuals += 1;
            convergence = assess(model, state, &mut buffers, rate, moved);
        }
        if count.is_multiple_of(LOOK_EVERY) {
            increment_before = std::mem::take(&mut increment);
        }
        let size = largest(&state.displacement).max(1e-12 * model.extent);
        let converged = held
            && convergence.estimated_error <= settings.tolerance * size
            && convergence.residual <= 10.0 * settings.tolerance;
        let progress = if converged { 1.0 } else { progress(count, settings, &convergence, size) };
        let jacobian = report.smallest_jacobian.jacobian;
        let stop =
            watch(model, state, &mut buffers, jacobian, progress, observer) == Continue::Stop;
        if converged || stop {
            let summary = pace.summary(state, residuals, stop);
            // Stopped early, it may never have looked.
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

/// Adapts the convergence factor c to the lowest frequency that moves.
struct Damping {
    c: f64,
    since: usize,
    displacement_change: Vec<f64>,
    force_before: Vec<f64>,
}

impl Damping {
    fn new(model: &Model, settings: &Relaxation) -> Damping {
        // Before anything is known: as if the load took one slow period.
        let kappa = (settings.load_steps as f64 / std::f64::consts::PI).max(2.0);
        let zeros = vec![0.0; model.size()];
        Damping {
            c: factor(kappa),
            since: 0,
            displacement_change: zeros.clone(),
            force_before: zeros,
        }
    }

    /// A changed step makes the last differences useless.
    fn forget(&mut self) {
        self.since = 0;
    }

    /// ω² = |Σ Δu·Δf|/Σ m Δu², κ = 2/(ωΔt), c = (κ − 1)/(κ + 1)
    /// (Joldes, Wittek, Miller 2011, eqs. 17–22).
    fn learn(&mut self, model: &Model, state: &State, buffers: &Buffers, time_step: f64) {
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

/// By how much the error falls in a step: c' = c + 0.2(1 − c) if the damping
/// fits, or what the increments have shown since the last look if that is
/// slower. Increments that grow say no more than that the error is large.
fn rate(c: f64, fallen: f64) -> f64 {
    let seen = fallen.powf(1.0 / LOOK_EVERY as f64).min(SLOWEST_RATE);
    (c + 0.2 * (1.0 - c)).max(seen)
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

/// Relative residual of the static equations, after the constraint forces have
/// taken what they can. Nodes in contact are left out.
fn residual(model: &Model, state: &mut State, buffers: &mut Buffers) -> f64 {
    external_force(model, state.time, &mut buffers.f_ext);
    let State { displacement, residual_scratch, time, contact, .. } = state;
    let mut imbalance = Imbalance::new(model, displacement, *time, buffers, residual_scratch);
    imbalance.ignore(model, &contact.touching);
    imbalance.relative(model)
}

/// The load is half of the way; the rest is how far the error has fallen.
fn progress(count: usize, settings: &Relaxation, convergence: &Convergence, size: f64) -> f64 {
    let loaded = (count as f64 / settings.load_steps as f64).min(1.0);
    let relative = convergence.estimated_error / size;
    let fallen = match relative.is_finite() && relative > 0.0 {
        true => (relative.min(1.0).ln() / settings.tolerance.ln()).clamp(0.0, 1.0),
        false => 0.0,
    };
    0.5 * loaded + 0.5 * fallen
}
