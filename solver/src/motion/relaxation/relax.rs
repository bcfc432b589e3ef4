//! Dynamic relaxation: damped motion towards a static solution.

use crate::algebra::packed::largest;
use crate::error::Error;
use crate::model::Model;
use crate::model::rigid_motions::free_rigid_motions;
use crate::motion::balance::Imbalance;
use crate::motion::observe::{Continue, Observer, notify};
use crate::motion::relaxation::damping::Damping;
use crate::motion::stability::{Here, Stability, fastest_node};
use crate::motion::state::State;
use crate::motion::step::{Buffers, Scheme, external_force, step};
use crate::motion::step_control::{StepController, check_divergence};
use crate::motion::summary::{Convergence, Summary};
use crate::problem::Relaxation;

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
    let mut stability = Stability::default();
    let mut decay = Decay::default();
    let mut error = Assessment::default();
    notify(model, state, 1.0, 0.0, observer);
    let unobstructed = model.contact.obstacles.is_empty();
    for count in 1.. {
        if control.reevaluate(model, state, &mut buffers) {
            damping.reset();
        }
        let (from, to) = (load_time(settings, count - 1), load_time(settings, count));
        let scheme = Scheme::relaxation(control.time_step, damping.c);
        let report = step(model, &scheme, from, to, state, &mut buffers);
        control.record(model, state, &mut buffers, &report);
        let loaded = count > settings.load_steps;
        check_divergence(model, state, &report)
            .map_err(|error| stability.explain(slid_away(model, state, error)))?;
        let curvature = damping.update(model, state, &buffers);
        let still = || model.constraints.hold_still(from, to);
        if let Some(curvature) = curvature.filter(|_| unobstructed && still()) {
            stability.observe(model, state, &damping.change, curvature);
        }
        // The last assessment says how far it came, should it not converge.
        let last = count >= settings.max_steps;
        error.largest = error.largest.max(report.largest_increment);
        let look = count.is_multiple_of(ASSESS_EVERY);
        if loaded && look || last {
            error.assess(model, state, &mut buffers, damping.c, loaded);
        }
        if look {
            error.before = std::mem::take(&mut error.largest);
        }
        let size = largest(&state.displacement).max(1e-12 * model.extent);
        let converged = loaded && error.is_within(settings.tolerance, size);
        let progress = if converged { 1.0 } else { progress(count, settings, &error.now, size) };
        let jacobian = report.smallest_jacobian.jacobian;
        let stop = notify(model, state, jacobian, progress, observer) == Continue::Stop;
        if converged {
            stability.search(model, Here::of(state), &mut buffers.workspace);
        }
        if converged || stop {
            let summary = control.summary(state, error.assessments, stop && !converged);
            return Ok(error.in_summary(summary, stability));
        }
        if last || decay.has_stalled(count, report.largest_increment) && loaded {
            // For the records: the state that is kept.
            notify(model, state, jacobian, 1.0, observer);
            return Err(stability.explain(not_converged(model, settings, state, &error.now, count)));
        }
    }
    unreachable!("the loop returns")
}

/// The time of the loads in a step \[s\].
fn load_time(settings: &Relaxation, count: usize) -> f64 {
    settings.load_end * (count as f64 / settings.load_steps as f64).min(1.0)
}

/// How far the body is from rest, looked at now and then.
struct Assessment {
    /// Largest increment since the last look, as a single one at a turning point says nothing \[m\].
    largest: f64,
    /// The same before it \[m\].
    before: f64,
    /// What the last look found.
    now: Convergence,
    assessments: usize,
}

impl Default for Assessment {
    fn default() -> Assessment {
        let unknown = Convergence { estimated_error: f64::INFINITY, residual: f64::INFINITY };
        Assessment { largest: 0.0, before: f64::INFINITY, now: unknown, assessments: 0 }
    }
}

impl Assessment {
    /// Error estimate max|Δu| c'/(1 − c'), and the residual of the static equations.
    fn assess(
        &mut self,
        model: &Model,
        state: &mut State,
        buffers: &mut Buffers,
        c: f64,
        loaded: bool,
    ) {
        let rate = rate(c, self.largest / self.before);
        // One window may lie at a turning point, two do not.
        let moved = if loaded { self.largest.max(self.before) } else { self.largest };
        self.now = Convergence {
            estimated_error: moved * rate / (1.0 - rate),
            residual: residual(model, state, buffers),
        };
        self.assessments += 1;
    }

    /// Whether the error is within a part of the largest displacement `size` \[m\], and the
    /// residual confirms it.
    fn is_within(&self, tolerance: f64, size: f64) -> bool {
        self.now.estimated_error <= tolerance * size && self.now.residual <= 10.0 * tolerance
    }

    /// Adds what was found, nothing before the first look, to the summary of a run.
    fn in_summary(&self, summary: Summary, stability: Stability) -> Summary {
        let relaxation = self.now.residual.is_finite().then_some(self.now);
        let Stability { found: instability, products: stability_products, .. } = stability;
        Summary { relaxation, instability, stability_products, ..summary }
    }
}

/// A body that slides away along obstacles, with what does not hold it.
fn slid_away(model: &Model, state: &State, error: Error) -> Error {
    let is_far = matches!(error, Error::Diverged { .. }) && !model.contact.obstacles.is_empty();
    match free_rigid_motions(model, state.time, &vec![0.0; model.size()]) {
        free if is_far && free > 0 => Error::NotHeld { free, then: Box::new(error) },
        _ => error,
    }
}

/// What is left to be said of a run that ends too far from equilibrium.
fn not_converged(
    model: &Model,
    settings: &Relaxation,
    state: &State,
    convergence: &Convergence,
    steps: usize,
) -> Error {
    let (node, moving) = fastest_node(model, &state.velocity);
    Error::NotConverged {
        steps,
        stalled: steps < settings.max_steps,
        error: convergence.estimated_error,
        tolerance: settings.tolerance * largest(&state.displacement),
        residual: convergence.residual,
        node,
        position: model.positions[node],
        moving: moving * state.time_step,
        free: free_rigid_motions(model, state.time, &state.displacement),
    }
}

/// Whether the movement still decays. The largest increments of the second quarter and of
/// the second half of all steps are compared whenever the number of steps has doubled:
/// relaxation that converges makes them smaller by orders of magnitude, and one that has
/// not even halved them will not end within ten times as many.
#[derive(Default)]
struct Decay {
    /// Of the last window of steps, and so far of this one \[m\].
    increments: (f64, f64),
}

/// Steps after which the decay is judged for the first time.
const JUDGED_FROM: usize = 40_000;

impl Decay {
    fn has_stalled(&mut self, count: usize, increment: f64) -> bool {
        let (before, now) = &mut self.increments;
        *now = now.max(increment);
        let window = JUDGED_FROM / 4;
        if !(count.is_multiple_of(window) && (count / window).is_power_of_two()) {
            return false;
        }
        let stalled = count >= JUDGED_FROM && *now > 0.5 * *before;
        (*before, *now) = (*now, 0.0);
        stalled
    }
}

/// Factor by which the error decays in a step (method book, eq. 20.3): c' = c + 0.2(1 − c)
/// for well-chosen damping, or the decay of the increments since the last assessment
/// if that is slower. Growing increments only say that the error is large.
fn rate(c: f64, fallen: f64) -> f64 {
    let observed = fallen.powf(1.0 / ASSESS_EVERY as f64).min(SLOWEST_RATE);
    (c + 0.2 * (1.0 - c)).max(observed)
}

/// Relative residual of the static equations without constraint forces, with those of contact.
fn residual(model: &Model, state: &mut State, buffers: &mut Buffers) -> f64 {
    external_force(model, state.time, &mut buffers.f_ext);
    let State { displacement, residual_scratch, time, contact, force_factor, .. } = state;
    contact.add_forces(&model.contact, *force_factor, &mut buffers.f_ext);
    Imbalance::new(model, displacement, *time, buffers, residual_scratch).relative(model)
}

/// Loading counts as one half, the decay of the error as the other.
fn progress(count: usize, settings: &Relaxation, convergence: &Convergence, size: f64) -> f64 {
    let loaded = (count as f64 / settings.load_steps as f64).min(1.0);
    let relative = convergence.estimated_error / size;
    let fallen = if relative.is_finite() && relative > 0.0 {
        (relative.min(1.0).ln() / settings.tolerance.ln()).clamp(0.0, 1.0)
    } else {
        0.0
    };
    // Not at its end before the residual confirms the error.
    (0.5 * loaded + 0.5 * fallen).min(0.999)
}
