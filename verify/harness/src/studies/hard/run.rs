//! One hard case from its problem to its outcome.
#![allow(non_snake_case)]

use crate::studies::hard::case::{Expected, HardCase};
use crate::studies::workbench::relative_error;
use mtled::Simulation;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::error::Error;
use mtled::force::Workspace;
use mtled::model::Model;
use mtled::model::essential::Reaction;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::motion::energy::Energies;
use mtled::motion::observe::{Continue, Observer, View};
use mtled::motion::summary::CollapsedPoint;
use mtled::problem::Motion;
use mtled_checks::measure::larger;
use mtled_run::run::{Solved, integrate};

/// Outcome of a case.
#[derive(Debug)]
pub(crate) enum CaseOutcome {
    /// It ended without an error.
    Finished(Box<CaseResult>),
    /// It ended with an error, in the set-up or the run.
    Refused { during: &'static str, error: Error },
}

/// What is measured of a finished run.
#[derive(Debug, Clone)]
pub(crate) struct CaseResult {
    pub nodes: usize,
    pub steps: usize,
    /// Smallest J of the run and of its last state \[–\]; NaN if any J is.
    pub smallest_jacobian: f64,
    /// Whether every displacement is finite.
    pub finite: bool,
    /// Difference from the expected result \[–\].
    pub error: Option<f64>,
    /// Rms of the nodal parameters that the field does not show, over their largest rms \[–\].
    pub noise: f64,
    /// The warning of the run about a point that has nearly no volume left.
    pub crushed: Option<CollapsedPoint>,
    /// Most nodes that touched an obstacle at once.
    pub touched: usize,
    /// Residual of the gradients' consistency over that before the correction \[–\].
    pub residual: f64,
}

impl CaseResult {
    /// Whether the solution is finite and no point is inverted.
    pub(crate) fn is_valid(&self) -> bool {
        self.finite && self.smallest_jacobian > 0.0
    }

    /// Whether the solution is wrong: an error of more than 10 %.
    pub(crate) fn is_wrong(&self) -> bool {
        self.error.is_some_and(|error| error.is_nan() || error > 0.1)
    }

    /// Label of the table.
    pub(crate) fn verdict(&self) -> &'static str {
        match (self.is_valid(), self.is_wrong(), self.crushed.is_some()) {
            (false, ..) => "not valid",
            (true, true, true) => "finite, wrong, with a warning",
            (true, true, false) => "finite, wrong",
            (true, false, true) => "finite, with a warning",
            (true, false, false) => "finite",
        }
    }
}

/// The variant of an error without its numbers.
pub(crate) fn name_of(error: &Error) -> String {
    let text = match error {
        Error::Geometry(error) => format!("{error:?}"),
        error => format!("{error:?}"),
    };
    text.split([' ', '{', '(']).next().unwrap_or_default().into()
}

/// Runs a case until it finishes or is refused.
pub(crate) fn run(case: &HardCase) -> CaseOutcome {
    let simulation = match Simulation::new(&case.problem) {
        Ok(simulation) => simulation,
        Err(error) => return CaseOutcome::Refused { during: "set-up", error },
    };
    match finish(case, simulation) {
        Ok(measures) => CaseOutcome::Finished(Box::new(measures)),
        Err(error) => CaseOutcome::Refused { during: "run", error },
    }
}

fn finish(case: &HardCase, mut simulation: Simulation) -> Result<CaseResult, Error> {
    set_duration(case, &mut simulation);
    let mut monitor = Monitor::new(matches!(simulation.problem.motion, Motion::Dynamic { .. }));
    let solved = integrate(simulation, &mut monitor)?;
    let finer = match &case.expected {
        Expected::Finer(problem) => {
            let mut monitor = Monitor::default();
            integrate(Simulation::with_any_recipe(problem)?, &mut monitor)?;
            monitor.force()
        }
        _ => f64::NAN,
    };
    Ok(measure(case, &solved, &monitor, finer))
}

/// Ends a motion after the number of steps that its case asks for.
fn set_duration(case: &HardCase, simulation: &mut Simulation) {
    let Simulation { problem, model, .. } = simulation;
    if let (Some(steps), Motion::Dynamic { end, step, .. }) = (case.steps, &mut problem.motion) {
        let rest = vec![0.0; model.size()];
        let critical =
            critical_time_step(model, &rest, 0.0, None, &mut Workspace::new(&model.points));
        *end = step.safety_factor * critical.time_step * steps as f64;
    }
}

/// Records energies of a motion and the last reactions.
#[derive(Debug, Default)]
struct Monitor {
    is_motion: bool,
    balances: Vec<f64>,
    largest_energy: f64,
    reactions: Vec<Reaction>,
    touched: usize,
    /// Largest root mean square of the nodal parameters so far \[m\].
    size: f64,
}

impl Monitor {
    fn new(is_motion: bool) -> Monitor {
        Monitor { is_motion, ..Monitor::default() }
    }

    fn record(&mut self, e: &Energies) {
        self.balances.push(e.balance());
        let works = [e.kinetic, e.strain, e.external_work, e.constraint_work, e.damping_loss];
        self.largest_energy = works.iter().map(|w| w.abs()).fold(self.largest_energy, larger);
    }

    /// Vertical force of the last condition \[N\].
    fn force(&self) -> f64 {
        self.reactions.last().map_or(f64::NAN, |reaction| reaction.force.z)
    }

    /// Moment of the last condition about the vertical \[N·m\].
    fn moment(&self) -> f64 {
        self.reactions.last().map_or(f64::NAN, |reaction| reaction.moment.z)
    }

    /// Largest change of the energy balance over the largest energy \[–\].
    fn drift(&self) -> f64 {
        let first = self.balances.first().copied().unwrap_or(f64::NAN);
        let change = self.balances.iter().map(|b| (b - first).abs()).fold(0.0, larger);
        change / self.largest_energy
    }
}

impl Observer for Monitor {
    fn observe(&mut self, view: &mut View) -> Continue {
        self.touched = self.touched.max(view.state.contact.touching.len());
        if view.state.step.is_multiple_of(10) {
            let u = &view.state.displacement;
            self.size = larger(self.size, root_mean_square(u.iter().copied(), view.model));
            if self.is_motion {
                let energies = view.energies();
                self.record(&energies);
            }
        }
        if view.progress >= 1.0 - 1e-9 {
            self.reactions = view.reactions(&Vector3::zeros());
        }
        Continue::Yes
    }

    fn tracks_work(&self) -> bool {
        self.is_motion
    }
}

fn measure(case: &HardCase, solved: &Solved, monitor: &Monitor, finer: f64) -> CaseResult {
    let u = &solved.simulation.state.displacement;
    let (model, discretisation) = (&solved.simulation.model, &solved.simulation.discretisation);
    let rows = &discretisation.supports;
    let smallest = |a: f64, J: f64| if J.is_nan() || J < a { J } else { a };
    let last = (0..rows.len())
        .map(|q| rows.deformation_gradient(q, u, model.components).determinant())
        .fold(f64::INFINITY, smallest);
    let error = match &case.expected {
        Expected::Homogeneous(C) => Some(deviation(solved, C) / (C - Matrix3::identity()).amax()),
        Expected::Rest => Some(deviation(solved, &Matrix3::identity())),
        Expected::Force(exact) => Some(relative_error(monitor.force(), *exact)),
        Expected::Finer(_) => Some(relative_error(monitor.force(), finer)),
        Expected::Moment(exact) => Some(relative_error(monitor.moment(), *exact)),
        Expected::Balance => Some(monitor.drift()),
        Expected::Unknown => None,
    };
    CaseResult {
        nodes: model.positions.len(),
        steps: solved.summary.steps,
        smallest_jacobian: smallest(solved.summary.smallest_jacobian.jacobian, last),
        finite: u.iter().all(|u| u.is_finite()),
        error,
        noise: noise(solved) / monitor.size,
        crushed: solved.summary.collapsed_point(model),
        touched: monitor.touched,
        residual: discretisation.correction.map_or(f64::NAN, |correction| correction.residual),
    }
}

/// Largest |FᵀF − C| over the quadrature points \[–\].
fn deviation(solved: &Solved, C: &Matrix3) -> f64 {
    let rows = &solved.simulation.discretisation.supports;
    let components = solved.simulation.model.components;
    let at = |q: usize| {
        let F = rows.deformation_gradient(q, &solved.simulation.state.displacement, components);
        (F.transpose() * F - C).amax()
    };
    (0..rows.len()).map(at).fold(0.0, larger)
}

/// Root mean square over the nodes of u_a − Σ φ_b(X_a) u_b \[m\], the part of the nodal parameters
/// that the field does not show: 0 for an affine field, O(h²) for a smooth one, nearly all of one
/// that changes its sign from node to node, as spurious modes do.
fn noise(solved: &Solved) -> f64 {
    let (model, u) = (&solved.simulation.model, &solved.simulation.state.displacement);
    let Ok(rows) = solved.simulation.discretisation.rows_at(&model.positions) else {
        return f64::NAN;
    };
    let hidden = (0..model.positions.len()).flat_map(|node| {
        let field = rows.interpolate(node, u, model.components);
        (0..model.components).map(move |k| u[model.components * node + k] - field[k])
    });
    root_mean_square(hidden, model)
}

/// √(Σ v²/nodes).
fn root_mean_square(values: impl Iterator<Item = f64>, model: &Model) -> f64 {
    (values.map(|v| v * v).sum::<f64>() / model.positions.len() as f64).sqrt()
}
