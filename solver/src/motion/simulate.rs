//! The loop over time, and the choice between motion, relaxation and Newton's method.

use crate::error::Error;
use crate::model::Model;
use crate::motion::equilibrium::equilibrate;
use crate::motion::internal_force::internal_force;
use crate::motion::observe::{Continue, Observer};
pub use crate::motion::pace::{Convergence, Crushed, NewtonCounts, Summary};
use crate::motion::pace::{Pace, check, watch};
use crate::motion::relaxation::relax;
use crate::motion::state::State;
use crate::motion::step::{Buffers, Scheme, StepReport, step};
use crate::problem::{Motion, StepControl};

/// Marches `state` through the motion of a problem while `observer` watches.
/// After an error the state and the observer keep what they had.
pub fn simulate(
    model: &Model,
    motion: &Motion,
    state: &mut State,
    observer: &mut dyn Observer,
) -> Result<Summary, Error> {
    match motion {
        Motion::Dynamic { end, step, damping } => {
            if model.added_mass == 0.0 && model.inertia != model.lumped_mass {
                return Err(Error::FictitiousMass);
            }
            march(model, *end, *step, *damping, state, observer)
        }
        Motion::Static(settings) => relax(model, settings, state, observer),
        Motion::Equilibrium(settings) => equilibrate(model, settings, state, observer),
    }
}

fn march(
    model: &Model,
    end: f64,
    control: StepControl,
    damping: f64,
    state: &mut State,
    observer: &mut dyn Observer,
) -> Result<Summary, Error> {
    let mut buffers = Buffers::new(model, observer.tracks_work());
    let mut pace = Pace::new(model, control, state, &mut buffers)?;
    let mut stopped = watch(model, state, &mut buffers, 1.0, 0.0, observer) == Continue::Stop;
    while !stopped && state.time < end * (1.0 - 1e-12) {
        pace.reevaluate(model, state, &mut buffers);
        let remaining = end - state.time;
        // Whole steps to the end: the last one must not be a sliver, and
        // round-off must not halve it.
        let time_step = remaining / (remaining / pace.time_step - 1e-9).ceil().max(1.0);
        let scheme = Scheme::central_difference(time_step, state.time_step, damping);
        let (now, then) = (state.time, state.time + time_step);
        let report = step(model, &scheme, now, then, state, &mut buffers);
        pace.record(model, state, &mut buffers, &report);
        check(model, state, &report)?;
        let progress = state.time / end;
        let jacobian = report.smallest_jacobian.jacobian;
        stopped = watch(model, state, &mut buffers, jacobian, progress, observer) == Continue::Stop;
    }
    // A step sees the points before it moves them: look at the last ones too.
    let smallest_jacobian =
        internal_force(model, &state.displacement, &mut buffers.workspace, &mut buffers.f_int);
    pace.see(smallest_jacobian);
    check(model, state, &StepReport { smallest_jacobian, largest_increment: 0.0 })?;
    Ok(pace.summary(state, 1, stopped))
}
