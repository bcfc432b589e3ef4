//! Difference of computed values from a reference solution.

use super::group::Group;
use crate::reference::ReferenceValues;
use crate::reference::agreement::rms_of_points;
use crate::scene::Case;

/// Values below this fraction of the scale of their family count as zero \[–\].
const ZERO: f64 = 1e-6;

/// Difference from a reference solution over the largest value of its kind in the
/// case \[–\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Root mean square over points and instants.
    pub rms: f64,
    /// Largest difference of a vector.
    pub max: f64,
    /// Error bar of the reference, root mean square.
    pub bar: f64,
}

/// The difference over all quantities of a group; None where there are none or all
/// vanish, as moments do by symmetry.
pub fn difference(
    case: &Case,
    group: Group,
    reference: &[ReferenceValues],
    computed: &[Vec<f64>],
) -> Option<Difference> {
    let components = group.family().components();
    let (mut all, mut errors) = (Vec::new(), Vec::new());
    let (mut largest, mut max, mut zero) = (0.0f64, 0.0f64, 0.0f64);
    for (reference, computed) in reference.iter().zip(computed) {
        if !group.holds(case, &reference.quantity) {
            continue;
        }
        let length = |vector: &[f64]| vector.iter().map(|v| v * v).sum::<f64>().sqrt();
        let differences: Vec<f64> =
            computed.iter().zip(&reference.values).map(|(a, b)| a - b).collect();
        zero = zero.max(ZERO * reference.scale);
        largest = reference.values.chunks(components).map(length).fold(largest, f64::max);
        max = differences.chunks(components).map(length).fold(max, f64::max);
        errors.extend(std::iter::repeat_n(reference.error, differences.len() / components));
        all.extend(differences);
    }
    (largest > zero).then(|| Difference {
        rms: rms_of_points(&all, components) / largest,
        max: max / largest,
        bar: rms_of_points(&errors, 1) / largest,
    })
}
