//! Error bars from the changes between clouds.
//!
//! An answer f whose error falls with the spacing h as hᵖ has, by Richardson's
//! extrapolation from a cloud r times as coarse, the error |f_r − f|/(rᵖ − 1). On clouds of
//! nodes single differences are accidents: signs change, and a coarser cloud can come out the
//! same by chance. The bar is a factor times the root mean square over the clouds,
//!   e = c √(Σ_r (|f_r − f|/(rᵖ − 1))²/n),
//! p = 2, with a factor c that depends on the dimension, on motion and contact, and on whether
//! anything on the boundary is free: at edges between what is held and what is free stresses are
//! singular.

use super::super::numbers::numbers;
use super::super::record::Recording;
use super::super::solved::Solved;
use super::bars::{ErrorBar, ErrorBars, Indicator};
use super::coarser::{CoarserRun, factors, is_by_newton, solve_coarser};
use super::doubts::{doubt_of_forces, doubt_of_run, judged};
use super::no_error_bar::NoErrorBar;
use crate::machine::cpu_seconds;
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::problem::{Dimension, Problem};
use mtled_case::reference::agreement::rms_of_points;
use mtled_case::reference::{Family, Quantity, quantities};
use mtled_case::scene::Case;

/// The order p \[–\]. An order observed from the clouds of one run is mostly noise.
const ORDER: f64 = 2.0;
/// No bar is shorter than this fraction of the largest value of its family: the tolerance of
/// the coarser solutions \[–\].
const FLOOR: f64 = 2e-5;
/// Coarser clouds that tell the error.
const CLOUDS: usize = 2;

/// Factors of a run \[–\] with which 94 % of the errors of 25 bodies in space lie within, every body
/// counted alike: 0.9 (K + 1)/K of K bodies hold 90 % of the next (hierarchical conformal prediction, Dunn,
/// Wasserman and Ramdas). Of 8 bodies in a plane, 9 that are held all around and 6 in motion 92 % do: they
/// are too few for that (study `error_bars`).
#[derive(Clone, Copy)]
struct Calibration {
    displacement: f64,
    /// Of forces, moments and energies.
    force: f64,
}

/// Solved as the run was, on two clouds that are further away.
const MOTION: Calibration = Calibration { displacement: 4.3, force: 4.1 };
/// Without edges between what is held and what is free, where stresses are singular.
const HELD_ALL_AROUND: Calibration = Calibration { displacement: 1.15, force: 1.5 };
/// For displacements 5.1 would be that of eight bodies, few, and 2.6 that of all bodies: between them.
const IN_A_PLANE: Calibration = Calibration { displacement: 3.5, force: 3.0 };
const IN_SPACE: Calibration = Calibration { displacement: 1.9, force: 4.3 };
/// Longer bars of contact \[–\].
const CONTACT: f64 = 1.5;

impl Calibration {
    fn of(problem: &Problem, solved: &Solved) -> Calibration {
        let known = match problem.dimension {
            _ if !is_by_newton(problem) => return MOTION,
            _ if held_all_around(solved) => return HELD_ALL_AROUND,
            Dimension::PlaneStrain { .. } => IN_A_PLANE,
            Dimension::Three => IN_SPACE,
        };
        let longer = if problem.obstacles.is_empty() { 1.0 } else { CONTACT };
        let Calibration { displacement, force } = known;
        Calibration { displacement: longer * displacement, force: longer * force }
    }

    /// The factor c of a family.
    fn factor(self, family: Family) -> f64 {
        match family {
            Family::Displacement | Family::Centre => self.displacement,
            Family::Force | Family::Moment | Family::StrainEnergy | Family::KineticEnergy => {
                self.force
            }
        }
    }
}

/// Error over difference between clouds, 1/(rᵖ − 1).
fn weight(ratio: f64) -> f64 {
    1.0 / (ratio.powf(ORDER) - 1.0)
}

/// Whether every node of the boundary is held in all directions.
fn held_all_around(solved: &Solved) -> bool {
    let Simulation { discretisation, model, .. } = &solved.simulation;
    let boundary = discretisation.cloud.on_boundary.iter().enumerate().filter(|(_, on)| **on);
    let mut components =
        boundary.flat_map(|(node, _)| (0..model.components).map(move |k| (node, k)));
    components.all(|(node, k)| model.constraints.always_prescribes(node as u32, k))
}

/// Estimates the error of the discretisation of every answer of a finished run by solving the
/// case on coarser clouds, which takes a fraction of its time. `indicates` asks for
/// `ErrorBars::indicator`.
pub fn error_bars(
    case: &Case,
    solved: &Solved,
    record: &Recording,
    indicates: bool,
) -> Result<ErrorBars, NoErrorBar> {
    if let Some(doubt) = doubt_of_run(case, solved) {
        return Err(doubt);
    }
    let start = cpu_seconds();
    let calibration = Calibration::of(&case.problem, solved);
    let cloud = &solved.simulation.discretisation.cloud;
    let mut runs = coarser_runs(case, cloud.mean_spacing(), indicates.then_some(&cloud.positions))?;
    let indicator = runs.iter_mut().find_map(|run| {
        let coarser_displacement = run.displacement.take()?;
        let factor = calibration.displacement * weight(run.cloud.ratio);
        Some(Indicator { coarser_displacement, factor })
    });
    Ok(ErrorBars {
        bars: bars(case, record, &runs, calibration),
        clouds: runs.iter().map(|run| run.cloud.clone()).collect(),
        indicator,
        cpu_seconds: cpu_seconds() - start,
    })
}

/// The first coarser clouds that can be solved, the finest first; one has its displacement at the nodes of
/// the run, which are `spacing` \[m\] apart.
fn coarser_runs(
    case: &Case,
    spacing: f64,
    nodes: Option<&Vec<Vector3>>,
) -> Result<Vec<CoarserRun>, NoErrorBar> {
    let (mut runs, mut failure): (Vec<CoarserRun>, _) = (Vec::new(), None);
    for &factor in factors(&case.problem) {
        let positions = nodes.filter(|_| runs.is_empty()).map(Vec::as_slice);
        match solve_coarser(case, (spacing, factor), positions) {
            Ok(run) => runs.push(run),
            Err(NoErrorBar::CoarserStopped) => return Err(NoErrorBar::CoarserStopped),
            Err(reason) => failure = Some(reason),
        }
        if runs.len() == CLOUDS {
            runs.sort_by(|a, b| a.cloud.ratio.total_cmp(&b.cloud.ratio));
            return Ok(runs);
        }
    }
    Err(failure.unwrap_or(NoErrorBar::NotCoarser))
}

fn bars(
    case: &Case,
    record: &Recording,
    runs: &[CoarserRun],
    calibration: Calibration,
) -> Vec<ErrorBar> {
    let doubt = doubt_of_forces(record);
    let answered = quantities(case).into_iter().filter(|q| q.family != Family::Centre);
    let mut largest_of: Vec<(Family, f64)> = Vec::new();
    let bar = |quantity: Quantity| {
        let family = quantity.family;
        let known = largest_of.iter().find(|(other, _)| *other == family).map(|(_, size)| *size);
        let largest = known.unwrap_or_else(|| {
            let size = largest(case, record, family);
            largest_of.push((family, size));
            size
        });
        let spread = spread(case, record, runs, &quantity)?.hypot(FLOOR * largest);
        let size = calibration.factor(quantity.family) * spread;
        let size = judged(quantity.family, size, largest, &doubt);
        Some(ErrorBar { quantity, size })
    };
    answered.filter_map(bar).collect()
}

/// √(Σ_r (|f_r − f|/(rᵖ − 1))²/n) at the end of the run, in the unit of the quantity.
fn spread(
    case: &Case,
    record: &Recording,
    runs: &[CoarserRun],
    quantity: &Quantity,
) -> Option<f64> {
    let last = |record: &Recording| numbers(case, record, quantity, record.samples.last()?);
    let own = last(record)?;
    let mut squares = 0.0;
    for run in runs {
        let other = last(&run.recording)?;
        let change: Vec<f64> = own.iter().zip(&other).map(|(a, b)| a - b).collect();
        let length = rms_of_points(&change, quantity.family.components());
        squares += (weight(run.cloud.ratio) * length).powi(2);
    }
    Some((squares / runs.len() as f64).sqrt())
}

/// The largest value of a family during the run, root mean square over the positions of a
/// lattice, in the unit of the family.
fn largest(case: &Case, record: &Recording, family: Family) -> f64 {
    let of_family: Vec<Quantity> =
        quantities(case).into_iter().filter(|quantity| quantity.family == family).collect();
    let sizes = record.samples.iter().flat_map(|sample| {
        let size = |quantity: &Quantity| {
            let values = numbers(case, record, quantity, sample)?;
            Some(rms_of_points(&values, family.components()))
        };
        of_family.iter().filter_map(size)
    });
    sizes.fold(0.0, f64::max)
}
