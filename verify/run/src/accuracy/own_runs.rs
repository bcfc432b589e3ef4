//! A reference solution from runs of this solver on finer clouds, where there is no
//! other.

use super::reference_solution::ReferenceSolution;
use mtled_case::reference::agreement::{rms_of_points, sizes_of_families};
use mtled_case::reference::{Family, Quantity, ReferenceValues, quantities};
use mtled_case::scene::Case;
use mtled_checks::report::four_digits;
use std::collections::BTreeMap;

/// Smallest order of convergence of displacements on bodies with bonded faces (study
/// "manufactured", bonded cubes) \[–\].
const ORDER: f64 = 1.0;

/// The values of the finest run, with the error bar |f₁ − f₂|/(r − 1) of order 1 after
/// the last refinement by r. Runs are (spacing \[m\], values), the finest first. None
/// with fewer than two runs.
pub fn from_own_runs(
    case: &Case,
    runs: &[(f64, Vec<Vec<f64>>)],
    times: &[f64],
) -> Option<ReferenceSolution> {
    let [(fine, finest), (coarse, coarser), ..] = runs else { return None };
    let factor = 1.0 / ((coarse / fine).powf(ORDER) - 1.0);
    let scales = scales(case, finest);
    let value = |((quantity, values), before): ((Quantity, &Vec<f64>), &Vec<f64>)| {
        let errors: Vec<f64> =
            values.iter().zip(before).map(|(a, b)| factor * (a - b).abs()).collect();
        ReferenceValues {
            error: rms_of_points(&errors, quantity.family.components()),
            scale: scales.get(&quantity.family).copied().unwrap_or(0.0),
            values: values.clone(),
            errors,
            quantity,
        }
    };
    Some(ReferenceSolution {
        times: times.to_vec(),
        quantities: quantities(case).into_iter().zip(finest).zip(coarser).map(value).collect(),
        source: format!(
            "own run with a spacing of {} m; its error bar follows from the refinement from \
             {} m with order 1",
            four_digits(*fine),
            four_digits(*coarse)
        ),
        disagreements: Vec::new(),
    })
}

/// The sizes of the families of a run.
pub(super) fn scales(case: &Case, values: &[Vec<f64>]) -> BTreeMap<Family, f64> {
    let families = quantities(case).into_iter().map(|quantity| quantity.family);
    sizes_of_families(case, families.zip(values.iter().cloned()))
}
