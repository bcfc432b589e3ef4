//! Control of the time step during a run, and the check for divergence.
#![allow(non_snake_case)]

use crate::error::Error;
use crate::force::SmallestJacobian;
use crate::model::Model;
use crate::motion::critical_time_step::{CriticalStep, critical_time_step, local_growth};
use crate::motion::state::State;
use crate::motion::step::{Buffers, StepReport, worst_node};
use crate::motion::summary::Summary;
use crate::problem::StepControl;

/// Fails where a quadrature point has inverted, or a displacement is NaN or has
/// changed by more than the size of the body in one step.
pub(crate) fn check_divergence(
    model: &Model,
    state: &State,
    report: &StepReport,
) -> Result<(), Error> {
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

/// Fewest and most steps between two checks of the local growth; a check takes one
/// product with the tangent, counted as one evaluation of the internal force.
const CHECK_INTERVALS: (usize, usize) = (10, 30);
/// Change of the local growth between two checks above which checks become much
/// more frequent; below half of it they become rarer \[–\].
const TARGET_CHANGE: f64 = 0.02;
/// Change of the local growth since the last Lanczos run that triggers the next
/// one \[–\]. Below it the step follows the growth alone.
const CHANGE: f64 = 0.15;

/// Follows the critical time step as the body deforms, and counts evaluations
/// (method book, eq. 17.9).
///
/// Between two Lanczos runs an occasional product with the tangent measures how much
/// the body has stiffened anywhere ([`local_growth`]): the step shrinks with it, and
/// in advance by four times the growth since the last check, for what happens until
/// the next. Once the growth has changed by [`CHANGE`], up or down, or
/// `reevaluate_every` steps have passed, the largest eigenvalue is found again.
pub(crate) struct StepController {
    control: StepControl,
    /// The next time step \[s\].
    pub time_step: f64,
    /// Result of the last Lanczos run; its pattern is updated by every check.
    critical: CriticalStep,
    /// Local growth at the first check after that run and at the latest \[1/s²\].
    growth: Option<(f64, f64)>,
    /// Steps between two checks, and until the next one.
    checks: (usize, usize),
    changed: bool,
    stage: usize,
    since: usize,
    summary: Summary,
}

/// By Lanczos from nothing or from what is known, with the extra stresses of a state and the largest
/// tension that is to come.
fn critical_step(
    model: &Model,
    state: &State,
    known: Option<&CriticalStep>,
    buffers: &mut Buffers,
) -> CriticalStep {
    let (u, t) = (&state.displacement, state.time);
    state.extra.act_at_most(model, t, &mut buffers.workspace);
    let critical = critical_time_step(model, u, t, known, &mut buffers.workspace);
    state.extra.act(model, t, &mut buffers.workspace);
    critical
}

impl StepController {
    pub fn new(
        model: &Model,
        control: StepControl,
        state: &State,
        buffers: &mut Buffers,
    ) -> Result<StepController, Error> {
        let critical = critical_step(model, state, None, buffers);
        let u = &state.displacement;
        // A displacement that is no number ends the run where it is, as diverged.
        let can_step = critical.time_step > 0.0 || !u.iter().all(|u| u.is_finite());
        if !can_step {
            return Err(Error::NoTimeStep { critical: critical.time_step });
        }
        if let Some(fixed) = control.fixed
            && fixed > critical.time_step
        {
            return Err(Error::UnstableStep { fixed, critical: critical.time_step });
        }
        Ok(StepController {
            control,
            time_step: control.fixed.unwrap_or(control.safety_factor * critical.time_step),
            growth: None,
            checks: (CHECK_INTERVALS.0, 1),
            changed: false,
            stage: model.constraints.stage(state.time),
            since: 0,
            summary: Summary {
                steps: 0,
                time: 0.0,
                time_steps: (f64::INFINITY, 0.0),
                critical_time_step: critical.time_step,
                force_evaluations: 0,
                lanczos_evaluations: critical.products,
                smallest_jacobian: SmallestJacobian::NONE,
                relaxation: None,
                newton: None,
                stopped: false,
                newton_failed: None,
                instability: None,
                stability_products: 0,
                contact_loss: None,
            },
            critical,
        })
    }

    /// Goes on as a new one would.
    pub fn renew(&mut self, model: &Model, state: &State, buffers: &mut Buffers) {
        self.critical = critical_step(model, state, None, buffers);
        if self.control.fixed.is_none() {
            self.time_step = self.control.safety_factor * self.critical.time_step;
        }
        self.summary.lanczos_evaluations += self.critical.products;
        self.growth = None;
        self.checks = (CHECK_INTERVALS.0, 1);
        self.changed = false;
        self.stage = model.constraints.stage(state.time);
        self.since = 0;
    }

    /// Runs Lanczos again where that is due, and when conditions are released.
    /// Returns whether the step changed.
    pub fn reevaluate(&mut self, model: &Model, state: &State, buffers: &mut Buffers) -> bool {
        let stage = model.constraints.stage(state.time);
        let due = self.changed || self.since >= self.control.reevaluate_every;
        if self.control.fixed.is_some() || !(due || stage != self.stage) {
            return false;
        }
        self.critical = critical_step(model, state, Some(&self.critical), buffers);
        self.time_step = self.control.safety_factor * self.critical.time_step;
        self.summary.lanczos_evaluations += self.critical.products;
        self.growth = None;
        self.checks.1 = 1;
        self.changed = false;
        self.stage = stage;
        self.since = 0;
        true
    }

    /// Counts a step and checks the local growth where that is due. To be called right
    /// after the step, while its velocity leads back to the previous displacements.
    pub fn record(
        &mut self,
        model: &Model,
        state: &State,
        buffers: &mut Buffers,
        report: &StepReport,
    ) {
        self.since += 1;
        let (low, high) = self.summary.time_steps;
        self.summary.time_steps = (low.min(state.time_step), high.max(state.time_step));
        self.record_jacobian(report.smallest_jacobian);
        self.checks.1 -= 1;
        if self.checks.1 == 0 {
            if self.control.fixed.is_none() {
                self.check_growth(model, state, buffers);
            }
            self.checks.1 = self.checks.0;
        }
    }

    fn check_growth(&mut self, model: &Model, state: &State, buffers: &mut Buffers) {
        // The displacements of the last Lanczos run, if it was in this step.
        let before: Vec<f64> = (state.displacement.iter().zip(&state.velocity))
            .map(|(u, v)| u - state.time_step * v)
            .collect();
        let pattern = &mut self.critical.pattern;
        let growth = local_growth(model, &before, state.time, pattern, &mut buffers.workspace);
        self.summary.lanczos_evaluations += 1;
        let (first, last) = self.growth.unwrap_or((growth, growth));
        self.growth = Some((first, growth));
        let (ratio, change) = (growth / first, (growth - last) / first);
        self.changed |= (ratio - 1.0).abs() > CHANGE;
        let expected = (ratio + 4.0 * change.max(0.0)).max(1.0);
        self.time_step = self.control.safety_factor * self.critical.time_step / expected.sqrt();
        if change.abs() > TARGET_CHANGE {
            self.checks.0 = (self.checks.0 / 4).max(CHECK_INTERVALS.0);
        } else if change.abs() < 0.5 * TARGET_CHANGE {
            self.checks.0 = (self.checks.0 * 2).min(CHECK_INTERVALS.1);
        }
    }

    pub fn record_jacobian(&mut self, smallest: SmallestJacobian) {
        self.summary.smallest_jacobian = self.summary.smallest_jacobian.or(smallest);
    }

    /// The summary; `further` evaluations of the internal force were outside steps.
    pub fn summary(&self, state: &State, further: usize, stopped: bool) -> Summary {
        let (steps, lanczos) = (state.step, self.summary.lanczos_evaluations);
        let force_evaluations = steps + lanczos + further;
        Summary { steps, force_evaluations, time: state.time, stopped, ..self.summary.clone() }
    }
}
