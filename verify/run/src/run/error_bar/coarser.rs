//! The same case on a coarser cloud.

use super::super::interrupt::interrupted;
use super::super::record::{Recorder, Recording};
use super::super::solved::integrate;
use super::super::work::Work;
use super::no_error_bar::NoErrorBar;
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::error::Error;
use mtled::model::zero_energy::tested_points;
use mtled::problem::{Motion, Newton, Problem};
use mtled_case::scene::Case;

/// Spacings that are asked for, over that of the run, where Newton's method solves the coarser clouds
/// \[–\]: the first two that can be solved tell the error. A third in space would double the price, for 52 in
/// place of 51 bars of 100 that are within a factor of 3 of the error (study `error_bars`).
const BY_NEWTON: [f64; 3] = [2.0, 2.4, 1.7];
const BY_NEWTON_IN_A_PLANE: [f64; 3] = [1.7, 2.4, 2.0];
/// The same, where the coarser clouds are solved as the run was \[–\].
const AS_THE_RUN: [f64; 3] = [2.0, 2.8, 2.4];
/// Residual of Newton's method on coarser clouds \[–\].
const TOLERANCE: f64 = 1e-3;
/// A lattice that leaves a part of the body with few points is made this much coarser once,
/// which costs less than the test for zero-energy modes \[–\].
const OTHER_FIT: f64 = 1.06;
/// A cloud is coarser whose spacing is at least this much larger: few spacings along an edge are
/// whole numbers \[–\].
const LEAST_RATIO: f64 = 1.2;

/// A coarser cloud that was solved.
#[derive(Debug, Clone, PartialEq)]
pub struct CoarserCloud {
    /// Mean spacing of its nodes over that of the run \[–\].
    pub ratio: f64,
    /// Number of its nodes.
    pub nodes: usize,
    /// What its solution took.
    pub work: Work,
}

/// A coarser cloud with its answers.
#[derive(Debug)]
pub(crate) struct CoarserRun {
    pub cloud: CoarserCloud,
    /// Its last sample.
    pub recording: Recording,
    /// Its displacement at the positions that were asked for \[position\]\[x, y, z\] \[m\]; none
    /// where its nodes do not reach one of them.
    pub displacement: Option<Vec<f64>>,
}

/// Spacings of the coarser clouds of a problem over that of the run, in the order in which to try them \[–\].
pub(crate) fn factors(problem: &Problem) -> &'static [f64] {
    match by_newton(problem) {
        Some(_) if problem.dimension.components() == 2 => &BY_NEWTON_IN_A_PLANE,
        Some(_) => &BY_NEWTON,
        None => &AS_THE_RUN,
    }
}

/// Whether the coarser clouds are solved by Newton's method.
pub(crate) fn is_by_newton(problem: &Problem) -> bool {
    by_newton(problem).is_some()
}

/// Newton's method, where it is what solves the run or takes the place of a relaxation without
/// contact.
fn by_newton(problem: &Problem) -> Option<Motion> {
    let relaxed = matches!(problem.motion, Motion::Relaxed(_)) && problem.obstacles.is_empty();
    let serves = problem.by_newton() || relaxed;
    let load_end = problem.motion.end();
    serves.then_some(Motion::Newton(Newton { load_end, tolerance: TOLERANCE, ..Newton::default() }))
}

/// Solves a case whose nodes are `spacing` \[m\] apart with every length of its recipe multiplied by
/// `factor`; nothing of its discretisation is kept.
pub(crate) fn solve_coarser(
    case: &Case,
    (spacing, factor): (f64, f64),
    positions: Option<&[Vector3]>,
) -> Result<CoarserRun, NoErrorBar> {
    let refused = |error: Error| NoErrorBar::Coarser(error.to_string());
    let mut coarser = case.clone();
    coarser.problem.recipe.scale_lengths(factor);
    coarser.problem.motion = by_newton(&case.problem).unwrap_or(coarser.problem.motion);
    coarser.outputs.history = 1;
    let simulation = fitted(&mut coarser.problem).map_err(refused)?;
    // Lattices have whole numbers of spacings along an edge.
    let ratio = simulation.discretisation.cloud.mean_spacing() / spacing;
    if ratio < LEAST_RATIO {
        return Err(NoErrorBar::NotCoarser);
    }
    let mut recorder = Recorder::new(&coarser, &simulation, 0).map_err(refused)?;
    let solved = integrate(simulation, &mut recorder).map_err(refused)?;
    if solved.summary.stopped || interrupted() {
        return Err(NoErrorBar::CoarserStopped);
    }
    let model = &solved.simulation.model;
    if let Some(doubt) = solved.summary.doubts(model).first() {
        return Err(NoErrorBar::Coarser(doubt.clone()));
    }
    let nodes = model.positions.len();
    let cloud = CoarserCloud { ratio, nodes, work: Work::of(&solved) };
    let at = |positions: &[Vector3]| solved.simulation.displacements_at(positions).ok();
    let displacement = positions
        .and_then(at)
        .map(|values| values.iter().flat_map(|value| value.iter().copied()).collect());
    Ok(CoarserRun { cloud, recording: recorder.finish(), displacement })
}

/// A discretisation without zero-energy modes.
fn fitted(problem: &mut Problem) -> Result<Simulation, Error> {
    let first = Simulation::with_any_recipe(problem)?;
    if tested_points(&first.discretisation) == 0.0 {
        return Ok(first);
    }
    let mut other = problem.clone();
    other.recipe.scale_lengths(OTHER_FIT);
    match Simulation::with_any_recipe(&other) {
        Ok(second) if tested_points(&second.discretisation) == 0.0 => {
            *problem = other;
            Ok(second)
        }
        _ => {
            first.refuse_zero_energy_modes()?;
            Ok(first)
        }
    }
}
