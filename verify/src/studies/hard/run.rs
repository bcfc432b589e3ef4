//! One hard case from its problem to what became of it.
#![allow(non_snake_case)]

use crate::run::{Prepared, Solved, march, prepare, prepare_to_run};
use crate::studies::workbench::relative_error;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::error::Error;
use mtled::model::Model;
use mtled::model::essential::Reaction;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::motion::energy::Energies;
use mtled::motion::internal_force::Workspace;
use mtled::motion::observe::{Continue, Observer, View};
use mtled::motion::simulate::Crushed;
use mtled::problem::{Motion, Problem};
use mtled_checks::study::shorthand::larger;
use mtled_checks::study::{Bound, Kind};

/// What a run may be compared with.
#[derive(Debug, Clone)]
pub enum Truth {
    /// The same right Cauchy–Green tensor C = FᵀF everywhere.
    Homogeneous(Matrix3),
    /// Vertical force \[N\] of the last condition.
    Force(f64),
    /// Moment about the vertical through the origin \[N·m\] of the last condition.
    Moment(f64),
    /// The vertical force of the same body on a finer cloud.
    Finer(Box<Problem>),
    /// The body is back in its shape of rest, C = I.
    Rest,
    /// The balance of all energies stays what it was.
    Balance,
    Unknown,
}

impl Truth {
    /// What the error of a case is measured by.
    pub fn words(&self) -> String {
        let words = match self {
            Truth::Homogeneous(_) => "uniaxial closed form, largest error of C",
            Truth::Force(_) => "reaction of three-field finite elements",
            Truth::Moment(_) => "moment of the incompressible closed form",
            Truth::Finer(_) => "reaction on a finer cloud",
            Truth::Rest => "shape at rest, largest error of C",
            Truth::Balance => "energy balance, over the largest energy",
            Truth::Unknown => "–",
        };
        words.into()
    }
}

/// A bound on the error of a case.
#[derive(Debug, Clone, Copy)]
pub struct Limit {
    pub kind: Kind,
    pub bound: Bound,
    pub source: &'static str,
}

/// A problem that is hard, and what its answer can be measured by.
#[derive(Debug, Clone)]
pub struct HardCase {
    pub id: &'static str,
    pub words: &'static str,
    pub problem: Problem,
    pub truth: Truth,
    pub limit: Option<Limit>,
    /// How it is known to end: "finite", or the names of errors.
    pub ends: &'static [&'static str],
    /// Whether the truth is the only equilibrium; beyond buckling it is not.
    pub unique: bool,
    /// What a reader should know of it.
    pub remark: &'static str,
    /// Steps of a motion, whose end is then set by the critical step at rest.
    pub steps: Option<usize>,
}

/// What became of a case.
#[derive(Debug)]
pub enum Outcome {
    Finished(Box<Measures>),
    Refused { during: &'static str, error: Error },
}

/// What a finished run shows.
#[derive(Debug, Clone)]
pub struct Measures {
    pub nodes: usize,
    pub steps: usize,
    /// Smallest J of the run and of its last state \[–\]; NaN if one is.
    pub smallest_jacobian: f64,
    /// Whether every displacement is a finite number.
    pub finite: bool,
    /// Against the truth \[–\].
    pub error: Option<f64>,
    pub noise: f64,
    /// What the run says about a point that lost its volume.
    pub crushed: Option<Crushed>,
    /// Most nodes that touched an obstacle at once.
    pub touched: usize,
    /// Of the gradients' consistency, over its size before the correction \[–\].
    pub residual: f64,
}

impl Measures {
    /// Whether the body is finite and nowhere inside out.
    pub fn is_sound(&self) -> bool {
        self.finite && self.smallest_jacobian > 0.0
    }

    /// Whether the answer is known to be none: an error of more than 10 %.
    pub fn is_far(&self) -> bool {
        self.error.is_some_and(|error| error.is_nan() || error > 0.1)
    }

    /// In a word, for the table.
    pub fn verdict(&self) -> &'static str {
        match (self.is_sound(), self.is_far(), self.crushed.is_some()) {
            (false, ..) => "not sound",
            (true, true, true) => "finite, far from the truth, with a warning",
            (true, true, false) => "finite, far from the truth",
            (true, false, true) => "finite, with a warning",
            (true, false, false) => "finite",
        }
    }
}

/// The variant of an error without its numbers.
pub fn name_of(error: &Error) -> String {
    let text = match error {
        Error::Geometry(error) => format!("{error:?}"),
        error => format!("{error:?}"),
    };
    text.split([' ', '{', '(']).next().unwrap_or_default().into()
}

/// Runs a case to its end or to its refusal.
pub fn run(case: &HardCase) -> Outcome {
    let prepared = match prepare_to_run(&case.problem) {
        Ok(prepared) => prepared,
        Err(error) => return Outcome::Refused { during: "set-up", error },
    };
    match finish(case, prepared) {
        Ok(measures) => Outcome::Finished(Box::new(measures)),
        Err(error) => Outcome::Refused { during: "run", error },
    }
}

fn finish(case: &HardCase, prepared: Prepared) -> Result<Measures, Error> {
    let problem = with_steps(case, &prepared);
    let mut watcher = Watcher::new(matches!(problem.motion, Motion::Dynamic { .. }));
    let solved = march(&problem, prepared, &mut watcher)?;
    let finer = match &case.truth {
        Truth::Finer(problem) => {
            let mut watcher = Watcher::default();
            march(problem, prepare(problem)?, &mut watcher)?;
            watcher.force()
        }
        _ => f64::NAN,
    };
    Ok(measure(case, &solved, &watcher, finer))
}

/// The problem with the end of its motion set.
fn with_steps(case: &HardCase, prepared: &Prepared) -> Problem {
    let mut problem = case.problem.clone();
    if let (Some(steps), Motion::Dynamic { end, step, .. }) = (case.steps, &mut problem.motion) {
        let model = &prepared.model;
        let rest = vec![0.0; model.size()];
        let critical = critical_time_step(model, &rest, 0.0, None, &mut Workspace::new(model));
        *end = step.safety_factor * critical.time_step * steps as f64;
    }
    problem
}

/// Keeps energies of a motion and the last reactions.
#[derive(Debug, Default)]
struct Watcher {
    moves: bool,
    balances: Vec<f64>,
    largest_energy: f64,
    reactions: Vec<Reaction>,
    touched: usize,
    /// Largest root mean square of the nodal parameters so far \[m\].
    size: f64,
}

impl Watcher {
    fn new(moves: bool) -> Watcher {
        Watcher { moves, ..Watcher::default() }
    }

    fn keep(&mut self, e: &Energies) {
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

impl Observer for Watcher {
    fn observe(&mut self, view: &mut View) -> Continue {
        self.touched = self.touched.max(view.state.contact.touching.len());
        if view.state.step.is_multiple_of(10) {
            let u = &view.state.displacement;
            self.size = larger(self.size, root_mean_square(u.iter().copied(), view.model));
            if self.moves {
                let energies = view.energies();
                self.keep(&energies);
            }
        }
        if view.progress >= 1.0 - 1e-9 {
            self.reactions = view.reactions(&Vector3::zeros());
        }
        Continue::Yes
    }

    fn tracks_work(&self) -> bool {
        self.moves
    }
}

fn measure(case: &HardCase, solved: &Solved, watcher: &Watcher, finer: f64) -> Measures {
    let u = &solved.state.displacement;
    let (model, discretisation) = (&solved.prepared.model, &solved.prepared.discretisation);
    let rows = &discretisation.supports;
    let smallest = |a: f64, J: f64| if J.is_nan() || J < a { J } else { a };
    let now = (0..rows.len())
        .map(|q| rows.deformation_gradient(q, u, model.components).determinant())
        .fold(f64::INFINITY, smallest);
    let error = match &case.truth {
        Truth::Homogeneous(C) => Some(deviation(solved, C) / (C - Matrix3::identity()).amax()),
        Truth::Rest => Some(deviation(solved, &Matrix3::identity())),
        Truth::Force(exact) => Some(relative_error(watcher.force(), *exact)),
        Truth::Finer(_) => Some(relative_error(watcher.force(), finer)),
        Truth::Moment(exact) => Some(relative_error(watcher.moment(), *exact)),
        Truth::Balance => Some(watcher.drift()),
        Truth::Unknown => None,
    };
    Measures {
        nodes: model.positions.len(),
        steps: solved.summary.steps,
        smallest_jacobian: smallest(solved.summary.smallest_jacobian.jacobian, now),
        finite: u.iter().all(|u| u.is_finite()),
        error,
        noise: noise(solved) / watcher.size,
        crushed: solved.summary.crushed(model),
        touched: watcher.touched,
        residual: discretisation.correction.map_or(f64::NAN, |correction| correction.residual),
    }
}

/// Largest |FᵀF − C| over the quadrature points \[–\].
fn deviation(solved: &Solved, C: &Matrix3) -> f64 {
    let rows = &solved.prepared.discretisation.supports;
    let components = solved.prepared.model.components;
    let at = |q: usize| {
        let F = rows.deformation_gradient(q, &solved.state.displacement, components);
        (F.transpose() * F - C).amax()
    };
    (0..rows.len()).map(at).fold(0.0, larger)
}

/// Root mean square over the nodes of u_a − Σ φ_b(X_a) u_b \[m\], the part of
/// the nodal parameters that the field does not show: nothing of an affine
/// field, O(h²) of a smooth one, nearly all of one that changes its sign from
/// node to node, as spurious modes do.
fn noise(solved: &Solved) -> f64 {
    let (model, u) = (&solved.prepared.model, &solved.state.displacement);
    let Ok(rows) = solved.prepared.discretisation.rows_at(&model.positions) else {
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
