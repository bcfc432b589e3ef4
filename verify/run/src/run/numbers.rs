//! The numbers of a quantity in a sample.

use super::record::{Recording, Sample};
use mtled::algebra::tensor::Vector3;
use mtled_case::reference::{Family, Quantity};
use mtled_case::scene::Case;

/// The numbers of a quantity in one sample, in the unit of its family; None where it was
/// not recorded.
pub fn numbers(
    case: &Case,
    recording: &Recording,
    quantity: &Quantity,
    sample: &Sample,
) -> Option<Vec<f64>> {
    let name = quantity.name.split_once('/').map_or("", |(_, name)| name);
    let probe = || case.probes.iter().position(|probe| probe.name == name);
    let condition = || case.problem.conditions.iter().position(|c| c.name == name);
    let flat = |vectors: &[Vector3]| vectors.iter().flat_map(|v| [v.x, v.y, v.z]).collect();
    match quantity.family {
        Family::Displacement => probe().map(|index| flat(&sample.displacements[index])),
        Family::Centre => probe().map(|index| flat(&recording.references[index])),
        Family::Force => condition().map(|index| flat(&[sample.reactions[index].force])),
        Family::Moment => condition().map(|index| flat(&[sample.reactions[index].moment])),
        Family::StrainEnergy => Some(vec![sample.energies.strain]),
        Family::KineticEnergy => Some(vec![sample.energies.kinetic]),
    }
}
