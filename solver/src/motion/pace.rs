//! What every run does around its steps: follow the critical step, count,
//! look for divergence, show itself.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::error::Error;
use crate::model::Model;
use crate::motion::critical_time_step::{CriticalStep, critical_time_step, local_growth};
use crate::motion::internal_force::SmallestJacobian;
use crate::motion::observe::{Continue, Observer, View};
use crate::motion::state::State;
use crate::motion::step::{Buffers, StepReport, worst_node};
use crate::problem::StepControl;

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
    /// Evaluations of the internal force, all together.
    pub force_evaluations: usize,
    /// Those of them that were spent on finding critical steps.
    pub lanczos_evaluations: usize,
    /// Smallest J seen at any point and step \[–\].
    pub smallest_jacobian: SmallestJacobian,
    /// Estimated error \[m\] and relative residual of a static solution.
    pub relaxation: Option<Convergence>,
    /// What Newton's method took; it has no time steps, which are 0.
    pub newton: Option<NewtonCounts>,
    /// Whether the observer ended the run early.
    pub stopped: bool,
}

/// J of a nearly incompressible point below which a finished run is in doubt \[–\].
const CRUSHED: f64 = 0.3;

/// A nearly incompressible point that has lost most of its volume: the body has
/// folded there between its nodes, and the forces balance all the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crushed {
    pub point: usize,
    /// Reference position \[m\].
    pub position: Vector3,
    pub jacobian: f64,
}

impl std::fmt::Display for Crushed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Crushed { point, position: X, jacobian } = self;
        write!(
            f,
            "J fell to {jacobian:.3} at quadrature point {point} at ({:.6}, {:.6}, {:.6} m), whose material hardly \
             changes its volume: the body has folded between its nodes or is crushed at an edge, and what \
             stands around is not to be trusted; use a finer cloud, or load it less",
            X.x, X.y, X.z
        )
    }
}

impl Summary {
    /// The point that casts doubt on a finished run, if there is one.
    pub fn crushed(&self, model: &Model) -> Option<Crushed> {
        let SmallestJacobian { jacobian, point } = self.smallest_jacobian;
        let block = model.blocks.iter().find(|block| block.points.contains(&point))?;
        let resists = block.law.projected_share() > 0.0;
        (resists && jacobian < CRUSHED).then(|| Crushed {
            point,
            position: model.point_positions[point],
            jacobian,
        })
    }
}

/// Work and outcome of Newton's method.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NewtonCounts {
    /// Parts in which the load was applied.
    pub increments: usize,
    /// Corrections, those of increments that failed included.
    pub iterations: usize,
    /// Products with the tangent operator; each takes 1.3 to 1.8 times as long as
    /// an evaluation of the internal force and is counted as one.
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

/// Fewest and most steps between two looks at the tangent; a look takes one
/// product with it, counted as one evaluation of the internal force.
const LOOKS: (usize, usize) = (10, 30);
/// Change of the local growth from look to look above which looks become much
/// more frequent; below half of it they become rarer \[–\].
const WANTED_CHANGE: f64 = 0.02;
/// Change of the local growth since the last Lanczos run that has the next one
/// made \[–\]. Below it the step follows the growth by itself.
const CHANGE: f64 = 0.15;

/// Follows the critical step as the body deforms and counts what is done.
///
/// Between two Lanczos runs one product with the tangent now and then tells
/// how much the body has stiffened anywhere ([`local_growth`]): the step shrinks
/// with it, and by four times as much again as since the last look, for what happens
/// until the next. Once the growth has changed by [`CHANGE`], up or down, or
/// `reevaluate_every` steps have passed, the largest eigenvalue is found again.
pub(crate) struct Pace {
    control: StepControl,
    /// The step to take next \[s\].
    pub time_step: f64,
    /// Of the last Lanczos run; its pattern is kept up.
    critical: CriticalStep,
    /// Local growth at the first look after that run and at the last \[1/s²\].
    growth: Option<(f64, f64)>,
    /// Steps from one look to the next, and until the next.
    looks: (usize, usize),
    changed: bool,
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
        let (u, t) = (&state.displacement, state.time);
        let critical = critical_time_step(model, u, t, None, &mut buffers.workspace);
        if let Some(fixed) = control.fixed
            && fixed > critical.time_step
        {
            return Err(Error::UnstableStep { fixed, critical: critical.time_step });
        }
        Ok(Pace {
            control,
            time_step: control.fixed.unwrap_or(control.safety_factor * critical.time_step),
            growth: None,
            looks: (LOOKS.0, 1),
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
            },
            critical,
        })
    }

    /// Finds the critical step anew where it is due, and when conditions are
    /// released. Returns whether the step changed.
    pub fn reevaluate(&mut self, model: &Model, state: &State, buffers: &mut Buffers) -> bool {
        let stage = model.constraints.stage(state.time);
        let due = self.changed || self.since >= self.control.reevaluate_every;
        if self.control.fixed.is_some() || !(due || stage != self.stage) {
            return false;
        }
        let (u, t) = (&state.displacement, state.time);
        self.critical =
            critical_time_step(model, u, t, Some(&self.critical), &mut buffers.workspace);
        self.time_step = self.control.safety_factor * self.critical.time_step;
        self.summary.lanczos_evaluations += self.critical.products;
        self.growth = None;
        self.looks.1 = 1;
        self.changed = false;
        self.stage = stage;
        self.since = 0;
        true
    }

    /// Counts a step and looks at the tangent now and then. To be called right
    /// after the step, while its velocity leads back to where it came from.
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
        self.see(report.smallest_jacobian);
        self.looks.1 -= 1;
        if self.looks.1 == 0 {
            if self.control.fixed.is_none() {
                self.look(model, state, buffers);
            }
            self.looks.1 = self.looks.0;
        }
    }

    fn look(&mut self, model: &Model, state: &State, buffers: &mut Buffers) {
        // Where the last Lanczos run was, if it was just now.
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
        if change.abs() > WANTED_CHANGE {
            self.looks.0 = (self.looks.0 / 4).max(LOOKS.0);
        } else if change.abs() < 0.5 * WANTED_CHANGE {
            self.looks.0 = (self.looks.0 * 2).min(LOOKS.1);
        }
    }

    pub fn see(&mut self, smallest: SmallestJacobian) {
        self.summary.smallest_jacobian = self.summary.smallest_jacobian.or(smallest);
    }

    /// Sums up; `further` evaluations of the internal force were outside steps.
    pub fn summary(&self, state: &State, further: usize, stopped: bool) -> Summary {
        let (steps, lanczos) = (state.step, self.summary.lanczos_evaluations);
        let force_evaluations = steps + lanczos + further;
        Summary { steps, force_evaluations, time: state.time, stopped, ..self.summary.clone() }
    }
}
