//! The loop over time, and the choice between motion, relaxation and Newton's method.

use crate::error::Error;
use crate::force::internal_force;
use crate::model::Model;
use crate::model::contact::Impacts;
use crate::motion::newton::{equilibrate, follow};
use crate::motion::observe::{Continue, Observer, View, notify};
use crate::motion::relaxation::relax;
use crate::motion::state::State;
use crate::motion::step::{Buffers, Scheme, StepReport, add_following, external_force, step};
use crate::motion::step_control::{StepController, check_divergence};
use crate::motion::summary::{ContactLoss, NewtonFailure, Summary};
use crate::problem::{Motion, Relaxation, StepControl, depends_on_way, refuse};

/// Runs the motion of a problem from `state`, and notifies `observer` after every step.
/// After an error the state is the last one reached, and the observer keeps its records.
pub fn simulate(
    model: &Model,
    motion: &Motion,
    state: &mut State,
    observer: &mut dyn Observer,
) -> Result<Summary, Error> {
    refuse(motion.check())?;
    match motion {
        Motion::Dynamic { end, step, damping } => {
            if model.added_mass == 0.0 && model.inertia != model.lumped_mass {
                return Err(Error::FictitiousMass);
            }
            if step.mass_scaling > 1.0 && model.added_mass == 0.0 {
                return Err(Error::UnscaledMass { factor: step.mass_scaling });
            }
            integrate(model, *end, *step, *damping, state, observer)
        }
        Motion::Static(settings) => {
            refuse_unheld(model, settings.load_end)?;
            solve_static(model, settings, state, observer)
        }
        Motion::Relaxed(settings) => {
            refuse_unheld(model, settings.load_end)?;
            relax(model, settings, state, observer)
        }
        Motion::Newton(settings) => {
            refuse_unheld(model, settings.load_end)?;
            let solve = if model.has_memory() { follow } else { equilibrate };
            solve(model, settings, state, observer)
        }
    }
}

/// Newton's method, and relaxation from the start where that fails or is not the way: a body
/// that sticks to obstacles depends on how the load comes. Where relaxation diverges, the state
/// is the equilibrium at the part of the load that Newton's method came to.
fn solve_static(
    model: &Model,
    settings: &Relaxation,
    state: &mut State,
    observer: &mut dyn Observer,
) -> Result<Summary, Error> {
    if model.has_memory() {
        return follow(model, &settings.newton(), state, observer);
    }
    if depends_on_way(&model.contact.obstacles) {
        return relax(model, settings, state, observer);
    }
    let start = state.copy();
    match equilibrate(model, &settings.newton(), state, observer) {
        Err(Error::NoEquilibrium { reached, iterations, evaluations, .. }) => {
            let equilibrium = std::mem::replace(state, start);
            observer.restart();
            let relaxed = relax(model, settings, state, observer);
            if matches!(relaxed, Err(Error::Diverged { .. } | Error::Inverted { .. })) {
                *state = equilibrium;
                show_again(model, state, reached, observer);
            }
            let mut summary =
                relaxed.map_err(|then| Error::NeitherSolver { reached, then: Box::new(then) })?;
            summary.force_evaluations += evaluations;
            summary.newton_failed = Some(NewtonFailure { reached, iterations });
            Ok(summary)
        }
        solved => solved,
    }
}

/// Shows an observer the equilibrium at a part of the load, in place of what diverged.
fn show_again(model: &Model, state: &State, reached: f64, observer: &mut dyn Observer) {
    let mut buffers = Buffers::new(model, false);
    state.extra.act(model, state.time, &mut buffers.workspace);
    let smallest = internal_force(
        &model.points,
        &state.displacement,
        &mut buffers.workspace,
        &mut buffers.f_int,
    );
    observer.restart();
    notify(model, state, smallest.jacobian, reached, observer);
}

/// Resultant of the loads over the sum of their sizes above which it is not round-off \[–\].
const UNBALANCED: f64 = 1e-6;

/// Component of the direction of a spring from which on it holds \[–\].
const HOLDS: f64 = 1e-3;

/// Refuses a static problem without equilibrium: constant loads push the whole body along
/// an axis on which nothing holds it.
fn refuse_unheld(model: &Model, load_end: f64) -> Result<(), Error> {
    if !model.contact.obstacles.is_empty() {
        return Ok(());
    }
    let mut force = vec![0.0; model.size()];
    external_force(model, load_end, &mut force);
    add_following(model, load_end, &vec![0.0; model.size()], &mut force);
    let held = model.constraints.active(load_end);
    let springs = |axis: usize| model.following.held().any(|(.., along)| along[axis].abs() > HOLDS);
    for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate().take(model.components) {
        let along = || force.iter().skip(axis).step_by(model.components);
        let (sum, sizes): (f64, f64) = (along().sum(), along().map(|f| f.abs()).sum());
        let is_held = held.iter().any(|set| set.component == axis) || springs(axis);
        if !is_held && sum.abs() > UNBALANCED * sizes {
            return Err(Error::NothingHolds { axis: name, force: sum });
        }
    }
    Ok(())
}

/// Fewest steps between two releases: a step ends under the conditions of its end, and what is
/// released within the first one would have held nothing.
const FEWEST_STEPS: f64 = 10.0;
/// Shortest step for that over the end of the motion \[–\]: time has to go on.
const SHORTEST: f64 = 1e-12;

/// The longest step \[s\] at time `t` of a motion since `start` \[s\] that leaves the conditions of
/// `t` some steps to act in.
fn longest_step(model: &Model, start: f64, t: f64) -> f64 {
    let releases = || model.constraints.conditions.iter().filter_map(|c| c.release);
    let next = releases().filter(|release| *release > t).fold(f64::INFINITY, f64::min);
    let last = releases().filter(|release| *release <= t).fold(start, f64::max);
    (next - last) / FEWEST_STEPS
}

fn integrate(
    model: &Model,
    end: f64,
    settings: StepControl,
    damping: f64,
    state: &mut State,
    observer: &mut dyn Observer,
) -> Result<Summary, Error> {
    let mut buffers = Buffers::new(model, observer.tracks_work());
    let mut control = StepController::new(model, settings, state, &mut buffers)?;
    // J at rest is 1; a motion that goes on from a state has that of the state.
    let jacobian = match state.step {
        0 => 1.0,
        _ => {
            let (u, workspace) = (&state.displacement, &mut buffers.workspace);
            internal_force(&model.points, u, workspace, &mut buffers.f_int).jacobian
        }
    };
    let mut stopped = notify(model, state, jacobian, 0.0, observer) == Continue::Stop;
    let began = state.time;
    let mut start = began;
    if !model.contact.obstacles.is_empty() && !state.contact.impacts.is_active() {
        state.contact.impacts = Impacts::new(&state.velocity, model.components);
    }
    while !stopped && state.time < end * (1.0 - 1e-12) {
        control.reevaluate(model, state, &mut buffers);
        let awaited = observer.awaited_time().filter(|time| *time > state.time);
        let remaining = awaited.map_or(end, |time| time.min(end)) - state.time;
        // Whole steps to the end or to a time of the observer: the last one must not be a
        // sliver, and round-off must not halve it.
        let longest = longest_step(model, start, state.time).max(SHORTEST * end);
        let longest = longest.min(control.time_step);
        let time_step = remaining / (remaining / longest - 1e-9).ceil().max(1.0);
        let scheme = Scheme::central_difference(time_step, state.time_step, damping);
        let (now, then) = (state.time, state.time + time_step);
        let report = step(model, &scheme, now, then, state, &mut buffers);
        control.record(model, state, &mut buffers, &report);
        check_divergence(model, state, &report)?;
        let progress = (state.time - began) / (end - began);
        let jacobian = report.smallest_jacobian.jacobian;
        stopped = notify(model, state, jacobian, progress, observer) == Continue::Stop;
        let view = View { model, state, smallest_jacobian: jacobian, progress };
        if observer.checkpoint(&view) {
            start = state.time;
            control.renew(model, state, &mut buffers);
        }
    }
    // A step evaluates J before it moves the nodes: the last state is still to be checked.
    let smallest_jacobian = internal_force(
        &model.points,
        &state.displacement,
        &mut buffers.workspace,
        &mut buffers.f_int,
    );
    control.record_jacobian(smallest_jacobian);
    check_divergence(model, state, &StepReport { smallest_jacobian, largest_increment: 0.0 })?;
    let contact_loss = ContactLoss::of(&state.contact.impacts);
    Ok(Summary { contact_loss, ..control.summary(state, 1, stopped) })
}
