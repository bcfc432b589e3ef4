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

/// The difference over all quantities of a group; None where there are none or all vanish, as
/// moments do by symmetry, and the reaction of a support around the whole body does: within the
/// error bar of the reference.
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
    let error = rms_of_points(&errors, 1);
    (largest > zero && largest > error).then(|| Difference {
        rms: rms_of_points(&all, components) / largest,
        max: max / largest,
        bar: error / largest,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::ReferenceSolution;
    use crate::bundled::CASES;
    use crate::scene::parse_case;
    use std::path::Path;

    #[test]
    fn the_reaction_of_a_support_around_the_whole_body_is_not_compared() {
        let (name, text) = CASES.iter().find(|(name, _)| *name == "smooth_compressible").unwrap();
        let case = parse_case(text, name, Path::new(".")).unwrap();
        let reference = ReferenceSolution::bundled(&case).unwrap();
        let computed: Vec<Vec<f64>> =
            reference.quantities.iter().map(|known| known.values.clone()).collect();
        let of = |group| difference(&case, group, &reference.quantities, &computed);
        assert_eq!(of(Group::Force), None);
        assert_eq!(of(Group::StrainEnergy).map(|known| known.rms), Some(0.0));
    }
}
