//! A truth made of the solver's own runs on finer and finer clouds, where nobody
//! has given one.

use super::Truth;
use crate::reference::agreement::rms_of_points;
use crate::reference::{Agreed, Family, Quantity, quantities, size_of};
use crate::scene::Case;
use mtled_checks::report::four_digits;
use std::collections::BTreeMap;

/// The order in which displacements of this method fall with the spacing, at least,
/// on bodies with held edges (study "manufactured", bonded cubes) \[–\].
const ORDER: f64 = 1.0;

/// The values of the finest of some runs, each (spacing \[m\], values), with what the
/// last refinement by r leaves at the order 1, |f₁ − f₂|/(r − 1), for an error bar.
/// The finest comes first. None with fewer than two runs.
pub fn extrapolated(case: &Case, runs: &[(f64, Vec<Vec<f64>>)], times: &[f64]) -> Option<Truth> {
    let [(fine, finest), (coarse, coarser), ..] = runs else { return None };
    let share = 1.0 / ((coarse / fine).powf(ORDER) - 1.0);
    let scales = scales(case, finest);
    let known = |((quantity, values), before): ((Quantity, &Vec<f64>), &Vec<f64>)| {
        let errors: Vec<f64> =
            values.iter().zip(before).map(|(a, b)| share * (a - b).abs()).collect();
        Agreed {
            error: rms_of_points(&errors, quantity.family.components()),
            scale: scales.get(&quantity.family).copied().unwrap_or(0.0),
            values: values.clone(),
            errors,
            quantity,
        }
    };
    Some(Truth {
        times: times.to_vec(),
        quantities: quantities(case).into_iter().zip(finest).zip(coarser).map(known).collect(),
        source: format!(
            "own run with a spacing of {} m; its error bar is what the refinement from \
             {} m leaves at order 1",
            four_digits(*fine),
            four_digits(*coarse)
        ),
    })
}

/// The largest number of each family; moments against the largest force times the
/// size of the body.
fn scales(case: &Case, values: &[Vec<f64>]) -> BTreeMap<Family, f64> {
    let mut largest: BTreeMap<Family, f64> = BTreeMap::new();
    for (quantity, values) in quantities(case).iter().zip(values) {
        let entry = largest.entry(quantity.family).or_default();
        *entry = values.iter().fold(*entry, |a, b| a.max(b.abs()));
    }
    let size = size_of(case);
    let force = largest.get(&Family::Force).copied().unwrap_or(0.0);
    for (family, least) in [(Family::Centre, size), (Family::Moment, force * size)] {
        if let Some(entry) = largest.get_mut(&family) {
            *entry = entry.max(least);
        }
    }
    largest
}
