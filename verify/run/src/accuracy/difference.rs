//! Difference of computed values from a reference solution.

use super::group::Group;
use mtled_case::reference::ReferenceValues;
use mtled_case::reference::agreement::rms_of_points;
use mtled_case::scene::Case;

/// Values below this fraction of the scale of their family count as zero \[–\].
const ZERO: f64 = 1e-6;

/// Difference from a reference solution over the largest value of its kind in the
/// case, or over what is large there where all of them vanish \[–\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Root mean square over points and instants.
    pub rms: f64,
    /// Largest difference of a vector.
    pub max: f64,
    /// Error bar of the reference, root mean square.
    pub bar: f64,
}

/// The difference over all quantities of a group. Values that vanish within the error bar of the
/// reference, as moments do by symmetry, and the reaction of a support around the whole body,
/// give no scale: that is the size of their family (see
/// [`sizes_of_families`](mtled_case::reference::agreement::sizes_of_families)). None where there are no
/// quantities, or nothing is larger than the error bar.
pub fn difference(
    case: &Case,
    group: Group,
    reference: &[ReferenceValues],
    computed: &[Vec<f64>],
) -> Option<Difference> {
    let components = group.family().components();
    let (mut all, mut errors) = (Vec::new(), Vec::new());
    let (mut largest, mut max, mut size) = (0.0f64, 0.0f64, 0.0f64);
    for (reference, computed) in reference.iter().zip(computed) {
        if !group.holds(case, &reference.quantity) {
            continue;
        }
        let length = |vector: &[f64]| vector.iter().map(|v| v * v).sum::<f64>().sqrt();
        let differences: Vec<f64> =
            computed.iter().zip(&reference.values).map(|(a, b)| a - b).collect();
        size = size.max(reference.scale);
        largest = reference.values.chunks(components).map(length).fold(largest, f64::max);
        max = differences.chunks(components).map(length).fold(max, f64::max);
        errors.extend(std::iter::repeat_n(reference.error, differences.len() / components));
        all.extend(differences);
    }
    let error = rms_of_points(&errors, 1);
    let scale = if largest > ZERO * size && largest > error { largest } else { size };
    (scale > error).then(|| Difference {
        rms: rms_of_points(&all, components) / scale,
        max: max / scale,
        bar: error / scale,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::ReferenceSolution;
    use mtled_case::bundled::CASES;
    use mtled_case::reference::Family;
    use mtled_case::scene::parse_case;
    use std::path::Path;

    #[test]
    fn a_force_where_none_should_be_is_seen() {
        let (name, text) = CASES.iter().find(|(name, _)| *name == "smooth_compressible").unwrap();
        let case = parse_case(text, name, Path::new(".")).unwrap();
        let reference = ReferenceSolution::bundled(&case).unwrap();
        let mut computed: Vec<Vec<f64>> =
            reference.quantities.iter().map(|known| known.values.clone()).collect();
        let force = |values: &[Vec<f64>]| {
            difference(&case, Group::Force, &reference.quantities, values).unwrap().rms
        };
        assert_eq!(force(&computed), 0.0);
        let of = |family| {
            reference.quantities.iter().position(|known| known.quantity.family == family).unwrap()
        };
        let (reaction, energy, lattice) =
            (of(Family::Force), of(Family::StrainEnergy), of(Family::Displacement));
        let largest = |values: &[f64]| values.iter().fold(0.0f64, |most, v| most.max(v.abs()));
        let working = largest(&computed[energy]) / largest(&computed[lattice]);
        computed[reaction].iter_mut().for_each(|force| *force = 0.0);
        computed[reaction][0] = 0.1 * working;
        assert!((force(&computed) - 0.1).abs() < 1e-3, "{}", force(&computed));
    }
}
