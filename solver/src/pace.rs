//! What every run does around its steps: follow the critical step, count,
//! look for divergence, show itself.

use crate::critical_time_step::critical_time_step;
use crate::error::Error;
use crate::internal_force::SmallestJacobian;
use crate::model::Model;
use crate::observe::{Continue, Observer, View};
use crate::problem::StepControl;
use crate::state::State;
use crate::step::{Buffers, StepReport, worst_node};

/// What a run took.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    pub steps: usize,
    /// Time reached \[s\].
    pub time: f64,
    /// Smallest and largest step taken \[s\].
    pub time_steps: (f64, f64),
    /// Critical step in the reference configuration \[s\].
    pub critical_time_step: f64,
    /// Evaluations of the internal force spent on finding critical steps.
    pub lanczos_evaluations: usize,
    /// Smallest J seen at any point and step \[–\].
    pub smallest_jacobian: f64,
    /// Estimated error \[m\] and relative residual of a static solution.
    pub relaxation: Option<Convergence>,
    /// What Newton's method took; it has no time steps, which are 0.
    pub newton: Option<NewtonCounts>,
    /// Whether the observer ended the run early.
    pub stopped: bool,
}

/// Work and outcome of Newton's method.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NewtonCounts {
    /// Parts in which the load was applied.
    pub increments: usize,
    /// Corrections, those of increments that failed included.
    pub iterations: usize,
    /// Products with the tangent operator, two evaluations of the internal
    /// force each.
    pub products: usize,
    /// All evaluations of the internal force.
    pub evaluations: usize,
    /// Largest unbalanced nodal force over the largest nodal force \[–\].
    pub residual: f64,
}

/// How well dynamic relaxation has converged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Convergence {
    /// Estimated largest error of a displacement component \[m\].
    pub estimated_error: f64,
    /// Largest unbalanced nodal force over the largest nodal force \[–\].
    pub residual: f64,
}

/// Shows the run to its observer.
pub(crate) fn watch(
    model: &Model,
    state: &State,
    buffers: &mut Buffers,
    smallest_jacobian: f64,
    progress: f64,
    observer: &mut dyn Observer,
) -> Continue {
    observer.observe(&mut View { model, state, buffers, smallest_jacobian, progress })
}

/// Refuses to go on where a point has turned inside out or a displacement is
/// not a number or beyond a thousand times the body's size.
pub(crate) fn check(model: &Model, state: &State, report: &StepReport) -> Result<(), Error> {
    let smallest = report.smallest_jacobian;
    if smallest.jacobian <= 0.0 {
        return Err(Error::Inverted {
            step: state.step,
            time: state.time,
            point: smallest.point,
            position: model.point_positions[smallest.point],
            jacobian: smallest.jacobian,
        });
    }
    if report.largest_increment.is_finite() && report.largest_increment < model.extent {
        return Ok(());
    }
    let (node, position, displacement) = worst_node(model, state);
    Err(Error::Diverged {
        step: state.step,
        time: state.time,
        node,
        position,
        displacement,
        time_step: state.time_step,
    })
}

/// Follows the critical step as the body deforms and counts what is done.
pub(crate) struct Pace {
    control: StepControl,
    /// The step to take next \[s\].
    pub time_step: f64,
    mode: Vec<f64>,
    stage: usize,
    since: usize,
    summary: Summary,
}

impl Pace {
    pub fn new(
        model: &Model,
        control: StepControl,
        state: &State,
        buffers: &mut Buffers,
    ) -> Result<Pace, Error> {
        let critical = critical_time_step(
            model,
            &state.displacement,
            state.time,
            None,
            &mut buffers.workspace,
        );
        if let Some(fixed) = control.fixed
            && fixed > critical.time_step
        {
            return Err(Error::UnstableStep { fixed, critical: critical.time_step });
        }
        Ok(Pace {
            control,
            time_step: control.fixed.unwrap_or(control.safety_factor * critical.time_step),
            mode: critical.mode,
            stage: model.constraints.stage(state.time),
            since: 0,
            summary: Summary {
                steps: 0,
                time: 0.0,
                time_steps: (f64::INFINITY, 0.0),
                critical_time_step: critical.time_step,
                lanczos_evaluations: 2 * critical.products,
                smallest_jacobian: f64::INFINITY,
                relaxation: None,
                newton: None,
                stopped: false,
            },
        })
    }

    /// Finds the critical step anew after some steps, and when conditions are
    /// released. Returns whether the step changed.
    pub fn reevaluate(&mut self, model: &Model, state: &State, buffers: &mut Buffers) -> bool {
        let stage = model.constraints.stage(state.time);
        let due = self.since >= self.control.reevaluate_every || stage != self.stage;
        if self.control.fixed.is_some() || !due {
            return false;
        }
        let start = Some(self.mode.as_slice());
        let critical = critical_time_step(
            model,
            &state.displacement,
            state.time,
            start,
            &mut buffers.workspace,
        );
        self.time_step = self.control.safety_factor * critical.time_step;
        self.mode = critical.mode;
        self.stage = stage;
        self.since = 0;
        self.summary.lanczos_evaluations += 2 * critical.products;
        true
    }

    pub fn record(&mut self, time_step: f64, report: &StepReport) {
        self.since += 1;
        let (low, high) = self.summary.time_steps;
        self.summary.time_steps = (low.min(time_step), high.max(time_step));
        self.see(report.smallest_jacobian);
    }

    pub fn see(&mut self, smallest: SmallestJacobian) {
        self.summary.smallest_jacobian = self.summary.smallest_jacobian.min(smallest.jacobian);
    }

    pub fn summary(&self, state: &State, stopped: bool) -> Summary {
        Summary { steps: state.step, time: state.time, stopped, ..self.summary.clone() }
    }
}
