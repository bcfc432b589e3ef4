//! Where differences between clouds tell nothing.

use super::super::record::Recording;
use super::super::solved::Solved;
use super::no_error_bar::NoErrorBar;
use mtled::problem::Cloud;
use mtled_case::reference::Family;
use mtled_case::scene::Case;

/// Error bar over the largest value of the family beyond which none is given \[–\].
const TOO_FAR: f64 = 0.5;

/// Why a run can have no error bar at all.
pub(crate) fn doubt_of_run(case: &Case, solved: &Solved) -> Option<NoErrorBar> {
    if solved.summary.stopped {
        return Some(NoErrorBar::Stopped);
    }
    if matches!(case.problem.recipe.cloud, Cloud::Given { .. }) {
        return Some(NoErrorBar::GivenNodes);
    }
    if solved.simulation.discretisation.bridged.is_some_and(|gap| gap.matters()) {
        return Some(NoErrorBar::BridgedGap);
    }
    let doubts = solved.summary.doubts(&solved.simulation.model);
    (!doubts.is_empty()).then_some(NoErrorBar::InDoubt)
}

/// Why forces, moments and energies have none: they hang on what touches, displacements away
/// from there do not.
pub(crate) fn doubt_of_forces(record: &Recording) -> Option<NoErrorBar> {
    let touches = record.samples.iter().any(|sample| sample.touching > 0);
    touches.then_some(NoErrorBar::Contact)
}

/// The error bar of a quantity whose family has values up to `largest`.
pub(crate) fn judged(
    family: Family,
    size: f64,
    largest: f64,
    doubt: &Option<NoErrorBar>,
) -> Result<f64, NoErrorBar> {
    match doubt {
        Some(doubt) if family != Family::Displacement => Err(doubt.clone()),
        _ if size <= TOO_FAR * largest => Ok(size),
        _ => Err(NoErrorBar::TooFarApart((100.0 * size / largest).min(1e6) as u64)),
    }
}
