//! Error bars from the changes between clouds.
//!
//! An answer f whose error falls with the spacing h as hᵖ has, by Richardson's
//! extrapolation from a cloud r times as coarse, the error |f_r − f|/(rᵖ − 1). On clouds of
//! nodes single differences are accidents: signs change, and a coarser cloud can come out the
//! same by chance. The bar is a factor times the root mean square over the clouds,
//!   e = c √(Σ_r (|f_r − f|/(rᵖ − 1))²/n),
//! with one order p for all and a factor c of each family of quantities.

use super::super::numbers::numbers;
use super::super::record::Recording;
use super::super::solve::Solved;
use super::bars::{ErrorBar, ErrorBars, Indicator};
use super::coarser::{CoarserRun, ratios, solve_coarser};
use super::doubts::{doubt_of_forces, doubt_of_run, judged};
use super::no_error_bar::NoErrorBar;
use crate::machine::cpu_seconds;
use crate::reference::agreement::rms_of_points;
use crate::reference::{Family, Quantity, quantities};
use crate::scene::Case;
use mtled::algebra::tensor::Vector3;
use mtled::problem::{Motion, Problem};

/// The order p \[–\]. An order observed from the clouds of one run is mostly noise.
const ORDER: f64 = 1.6;
/// No bar is shorter than this fraction of the largest value of its family: the tolerance of
/// the coarser solutions \[–\].
const FLOOR: f64 = 2e-5;
/// Coarser clouds without which there is no bar.
const FEWEST: usize = 2;

/// Longer bars of motions and of contact, whose coarser clouds are two and further away \[–\].
const AS_THE_RUN: f64 = 1.5;

/// The factor c of a family \[–\], set on bundled cases and made-up bodies (study `error_bars`).
fn factor(family: Family, problem: &Problem) -> f64 {
    let factor = match family {
        Family::Displacement | Family::Centre | Family::Force => 1.35,
        Family::Moment | Family::StrainEnergy | Family::KineticEnergy => 1.3,
    };
    let longer = matches!(problem.motion, Motion::Dynamic { .. }) || !problem.obstacles.is_empty();
    if longer { AS_THE_RUN * factor } else { factor }
}

/// Error over difference between clouds, 1/(rᵖ − 1) \[–\].
fn weight(ratio: f64) -> f64 {
    1.0 / (ratio.powf(ORDER) - 1.0)
}

/// Estimates the error of the discretisation of every answer of a finished run by solving the
/// case on coarser clouds, which takes a fraction of its time. `indicates` asks for
/// [`ErrorBars::indicator`].
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
    let nodes = &solved.prepared.discretisation.cloud.positions;
    let mut runs = coarser_runs(case, indicates.then_some(nodes))?;
    let indicator = runs[0].displacement.take().map(|coarser_displacement| Indicator {
        coarser_displacement,
        factor: factor(Family::Displacement, &case.problem) * weight(runs[0].cloud.ratio),
    });
    Ok(ErrorBars {
        bars: bars(case, solved, record, &runs),
        clouds: runs.iter().map(|run| run.cloud.clone()).collect(),
        indicator,
        cpu_seconds: cpu_seconds() - start,
    })
}

/// The coarser clouds that can be solved, the finest first, with its displacement at the nodes of
/// the run.
fn coarser_runs(case: &Case, nodes: Option<&Vec<Vector3>>) -> Result<Vec<CoarserRun>, NoErrorBar> {
    let (mut runs, mut failure): (Vec<CoarserRun>, _) = (Vec::new(), None);
    for &ratio in ratios(&case.problem) {
        let positions = nodes.filter(|_| runs.is_empty()).map(Vec::as_slice);
        match solve_coarser(case, ratio, positions) {
            Ok(run) => runs.push(run),
            Err(NoErrorBar::CoarserStopped) => return Err(NoErrorBar::CoarserStopped),
            Err(reason) => failure = Some(reason),
        }
    }
    match (runs.len() < FEWEST, failure) {
        (true, Some(reason)) => Err(reason),
        _ => Ok(runs),
    }
}

fn bars(case: &Case, solved: &Solved, record: &Recording, runs: &[CoarserRun]) -> Vec<ErrorBar> {
    let doubt = doubt_of_forces(case, solved, record);
    let answered = quantities(case).into_iter().filter(|q| q.family != Family::Centre);
    let bar = |quantity: Quantity| {
        let largest = largest(case, record, quantity.family);
        let spread = spread(case, record, runs, &quantity)?.hypot(FLOOR * largest);
        let size = judged(
            quantity.family,
            factor(quantity.family, &case.problem) * spread,
            largest,
            &doubt,
        );
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
