//! Agreement of two codes within their error bars, and the reference value.

use super::format::{Mesh, ReferenceFile, Solution};
use super::quantity::{Family, Quantity, is_dynamic, quantities, size_of};
use super::read::MESHES;
use super::richardson::{Estimate, estimate, rms};
use crate::scene::Case;
use std::collections::BTreeMap;

/// Order of quadratic elements in the displacement \[–\].
const ORDER_OF_DISPLACEMENTS: f64 = 3.0;
/// Order of quadratic elements in energies, reactions and volumes \[–\].
const ORDER_OF_FUNCTIONALS: f64 = 4.0;
/// Order of the schemes in time, refined together with the mesh \[–\].
const ORDER_IN_TIME: f64 = 2.0;

/// The values of two codes for one quantity.
#[derive(Debug, Clone)]
pub struct Agreement {
    /// What is compared.
    pub quantity: Quantity,
    /// By the order of the solutions of the file.
    pub estimates: Vec<Estimate>,
    /// rms of the difference over points and instants, in the unit.
    pub difference: f64,
    /// rms of the error bars per code, in the unit.
    pub bars: Vec<f64>,
    /// Size of quantities of this family in the case, in the unit.
    pub scale: f64,
}

impl Agreement {
    /// |a − b| over the sum of the error bars \[–\]; at most 1 in agreement.
    pub fn ratio(&self) -> f64 {
        self.difference / self.bars.iter().sum::<f64>()
    }

    /// rms of the lengths of a code's values over points and instants, in the
    /// unit.
    pub fn magnitude(&self, solution: usize) -> f64 {
        let values = &self.estimates[solution].values;
        rms_of_points(values, self.quantity.family.components())
    }

    /// Whether the codes differ by no more than their error bars.
    pub fn agrees(&self) -> bool {
        self.ratio() <= 1.0
    }

    /// The solution with the shorter error bar.
    pub fn better(&self) -> usize {
        (0..self.bars.len()).min_by(|&a, &b| self.bars[a].total_cmp(&self.bars[b])).unwrap_or(0)
    }

    /// The better value; its bar is not shorter than the difference of the
    /// codes.
    pub fn reference(&self) -> ReferenceValues {
        let better = &self.estimates[self.better()];
        let other = &self.estimates[self.estimates.len() - 1 - self.better()];
        let bars = (better.errors.iter().zip(&better.values).zip(&other.values))
            .map(|((bar, a), b)| bar.max((a - b).abs()));
        ReferenceValues {
            quantity: self.quantity.clone(),
            values: better.values.clone(),
            errors: bars.collect(),
            error: self.bars[self.better()].max(self.difference),
            scale: self.scale,
        }
    }
}

/// The reference value of a quantity.
#[derive(Debug, Clone)]
pub struct ReferenceValues {
    /// What is measured.
    pub quantity: Quantity,
    /// Instant by instant.
    pub values: Vec<f64>,
    /// Error bars.
    pub errors: Vec<f64>,
    /// rms of the error over points and instants, in the unit.
    pub error: f64,
    /// Size of quantities of this family in the case, in the unit.
    pub scale: f64,
}

impl ReferenceValues {
    /// The numbers of one instant.
    pub fn instant(&self, index: usize) -> &[f64] {
        let index = if self.quantity.changes { index } else { 0 };
        &self.values[index * self.quantity.width..][..self.quantity.width]
    }

    /// The error bars of one instant.
    pub fn bars(&self, index: usize) -> &[f64] {
        let index = if self.quantity.changes { index } else { 0 };
        &self.errors[index * self.quantity.width..][..self.quantity.width]
    }
}

/// Compares the two codes of a reference, quantity by quantity.
pub fn agreements(case: &Case, file: &ReferenceFile) -> Vec<Agreement> {
    let scales = scales(case, file);
    let compare = |quantity: Quantity| {
        let scale = scales[&quantity.family];
        let highest = highest_order(case, quantity.family);
        let estimates: Vec<Estimate> = (file.solutions.iter())
            .map(|solution| extrapolated(solution, &quantity, highest, scale))
            .collect();
        let components = quantity.family.components();
        let differences: Vec<f64> =
            (estimates[0].values.iter().zip(&estimates[1].values)).map(|(a, b)| a - b).collect();
        Agreement {
            difference: rms_of_points(&differences, components),
            bars: estimates.iter().map(|e| rms_of_points(&e.errors, components)).collect(),
            estimates,
            quantity,
            scale,
        }
    };
    quantities(case).into_iter().map(compare).collect()
}

/// Root of the mean square length of vectors of `components` numbers.
pub fn rms_of_points(numbers: &[f64], components: usize) -> f64 {
    rms(numbers) * (components as f64).sqrt()
}

fn highest_order(case: &Case, family: Family) -> f64 {
    match family {
        Family::Centre => ORDER_OF_FUNCTIONALS,
        _ if is_dynamic(case) => ORDER_IN_TIME,
        Family::Displacement => ORDER_OF_DISPLACEMENTS,
        _ => ORDER_OF_FUNCTIONALS,
    }
}

/// Extrapolates the three finest meshes.
fn extrapolated(solution: &Solution, quantity: &Quantity, highest: f64, scale: f64) -> Estimate {
    let meshes = &solution.meshes[solution.meshes.len() - MESHES..];
    let [coarse, medium, fine] = [0, 1, 2].map(|n| meshes[n].values[&quantity.name].flat());
    let sizes = [2, 1, 0].map(|n| meshes[n].size_m);
    estimate([&fine, &medium, &coarse], sizes, highest, scale)
}

/// The sizes of the families on the finest meshes.
pub(crate) fn scales(case: &Case, file: &ReferenceFile) -> BTreeMap<Family, f64> {
    let finest = || file.solutions.iter().filter_map(|solution| solution.meshes.last());
    let of_mesh = |mesh: &Mesh| {
        let values = |quantity: Quantity| (quantity.family, mesh.values[&quantity.name].flat());
        quantities(case).into_iter().map(values).collect::<Vec<_>>()
    };
    sizes_of_families(case, finest().flat_map(of_mesh))
}

/// The largest value of each family; for families that may vanish by symmetry at least the size
/// of the body (centres), the force that does the strain energy over the largest displacement
/// (reactions), or the size of the forces times that of the body (moments).
pub fn sizes_of_families(
    case: &Case,
    values: impl Iterator<Item = (Family, Vec<f64>)>,
) -> BTreeMap<Family, f64> {
    let mut largest: BTreeMap<Family, f64> = BTreeMap::new();
    for (family, values) in values {
        let entry = largest.entry(family).or_default();
        *entry = values.iter().fold(*entry, |a, b| a.max(b.abs()));
    }
    let of = |family: Family| largest.get(&family).copied().unwrap_or(0.0);
    let size = size_of(case);
    let (energy, displacement) = (of(Family::StrainEnergy), of(Family::Displacement));
    let working = if displacement > 0.0 { energy / displacement } else { 0.0 };
    let force = of(Family::Force).max(working);
    for (family, least) in
        [(Family::Centre, size), (Family::Force, force), (Family::Moment, force * size)]
    {
        if let Some(entry) = largest.get_mut(&family) {
            *entry = entry.max(least);
        }
    }
    largest
}
