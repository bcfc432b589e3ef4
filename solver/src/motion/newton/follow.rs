//! Static equilibria of a body with memory, one after the other in time.

use super::equilibrate::equilibrate;
use crate::error::Error;
use crate::force::Workspace;
use crate::model::Model;
use crate::motion::observe::{Continue, Observer, View, notify};
use crate::motion::state::State;
use crate::motion::step::{add_following, external_force};
use crate::motion::summary::{NewtonCounts, Summary};
use crate::problem::Newton;

/// Time that a sudden change takes, over that of the run \[–\].
const SUDDEN: f64 = 1e-9;

/// Follows a body whose materials have viscosity: first to the equilibrium of a sudden load at the
/// start, then to those at the ends of parts of the time, each by [`equilibrate`]. After an error
/// the state is the last equilibrium.
pub(crate) fn follow(
    model: &Model,
    settings: &Newton,
    state: &mut State,
    observer: &mut dyn Observer,
) -> Result<Summary, Error> {
    let times = times(model, settings, state.time);
    let to = |time: f64| Newton { load_end: time, ..*settings };
    let mut all = if acts(model, state) {
        Some(part(model, &to(state.time), state, (0.0, 0.0), observer)?)
    } else {
        notify(model, state, 1.0, 0.0, observer);
        None
    };
    for (n, &time) in times.iter().enumerate() {
        if all.as_ref().is_some_and(|all| all.stopped) {
            break;
        }
        let range = [n, n + 1].map(|n| n as f64 / times.len() as f64);
        let next = part(model, &to(time), state, range.into(), observer)?;
        all = Some(all.map_or(next.clone(), |all| joined(all, next)));
    }
    // Nothing is left to be followed of a run that is at its end.
    all.ok_or(Error::HasRun { time: state.time })
}

/// Whether anything loads or moves the body at the start.
fn acts(model: &Model, state: &State) -> bool {
    let (t, u) = (state.time, &state.displacement);
    let mut force = vec![0.0; model.size()];
    external_force(model, t, &mut force);
    add_following(model, t, u, &mut force);
    let pulls = model.points.blocks.iter().filter_map(|block| block.active.as_ref());
    let pulls = pulls.map(|active| active.tension * active.amplitude.at(t));
    let mut moves = false;
    let forces = &mut Default::default();
    let Model { positions, inertia, constraints, .. } = model;
    constraints.enforce(t, positions, inertia, &mut u.clone(), forces, |_, d| moves |= d != 0.0);
    moves || force.iter().chain(u).copied().chain(pulls).any(|number| number != 0.0)
}

/// The ends of the parts of the time between corners of the amplitudes.
fn times(model: &Model, settings: &Newton, start: f64) -> Vec<f64> {
    let end = settings.load_end;
    let within = |time: &f64| *time > start && *time < end;
    let mut corners = model.corners();
    // What a condition held until its release goes at once.
    let sudden = SUDDEN * (end - start);
    let releases = model.constraints.conditions.iter().filter_map(|condition| condition.release);
    corners.extend(releases.map(|release| release - sudden));
    corners.retain(within);
    corners.extend([start, end]);
    corners.sort_by(f64::total_cmp);
    corners.dedup();
    let parts = |pair: &[f64]| {
        let (from, to) = (pair[0], pair[1]);
        let count = if to - from < 1.5 * sudden { 1 } else { settings.parts };
        let inner = (1..count).map(|n| from + (to - from) * n as f64 / count as f64);
        inner.chain([to]).collect::<Vec<_>>()
    };
    corners.windows(2).flat_map(parts).collect()
}

/// The equilibrium of the next part of the time, which begins and ends at a progress of `range`
/// \[–\]; that of a load at the start takes no time.
fn part(
    model: &Model,
    settings: &Newton,
    state: &mut State,
    range: (f64, f64),
    observer: &mut dyn Observer,
) -> Result<Summary, Error> {
    let kept = state.copy();
    state.extra.interval = settings.load_end - state.time;
    let mut passed = Passed { observer: &mut *observer, range };
    let summary = equilibrate(model, settings, state, &mut passed).map_err(|error| {
        *state = kept;
        with_progress(error, range.0)
    })?;
    state.remember(model, &mut Workspace::new(&model.points));
    let jacobian = summary.smallest_jacobian.jacobian;
    let stop = notify(model, state, jacobian, range.1, observer) == Continue::Stop;
    let stopped = stop || summary.stopped;
    Ok(Summary { stopped, ..summary })
}

/// An error in a part of the time that began at a progress of the run.
fn with_progress(error: Error, reached: f64) -> Error {
    match error {
        Error::NoEquilibrium { iterations, evaluations, residual, indefinite, .. } => {
            Error::NoEquilibrium { reached, iterations, evaluations, residual, indefinite }
        }
        error => error,
    }
}

/// The summary of a run and of the part that follows.
fn joined(all: Summary, next: Summary) -> Summary {
    let newton = all.newton.zip(next.newton).map(|(a, b)| NewtonCounts {
        increments: a.increments + b.increments,
        iterations: a.iterations + b.iterations,
        products: a.products + b.products,
        evaluations: a.evaluations + b.evaluations,
        up_to_round_off: a.up_to_round_off || b.up_to_round_off,
        ..b
    });
    Summary {
        steps: all.steps + next.steps,
        force_evaluations: all.force_evaluations + next.force_evaluations,
        smallest_jacobian: all.smallest_jacobian.or(next.smallest_jacobian),
        newton,
        stability_products: all.stability_products + next.stability_products,
        instability: all.instability.or(next.instability),
        ..next
    }
}

/// Shows an observer how far an iteration is, but not the states on the way to an equilibrium.
struct Passed<'a> {
    observer: &'a mut dyn Observer,
    /// Progress before and after the part \[–\].
    range: (f64, f64),
}

impl Observer for Passed<'_> {
    fn observe(&mut self, _view: &mut View) -> Continue {
        Continue::Yes
    }

    fn iterate(&mut self, progress: f64, corrections: usize) -> Continue {
        let (from, to) = self.range;
        self.observer.iterate(from + progress * (to - from), corrections)
    }
}
