//! Strains at the end of a run: those that a law is not made for, and the volume of patches.
#![allow(non_snake_case)]

use crate::algebra::tensor::Matrix3;
use crate::discretisation::{Discretisation, Warning};
use crate::material::Law;
use crate::model::Model;

/// Strain above which the linear law differs from every other by more than itself: a rotation by
/// 0.3 has as much \[–\].
const LARGE_STRAIN: f64 = 0.05;
/// J of a point below which hardly a tissue has been measured \[–\].
const CRUSHED: f64 = 0.3;

/// Warnings of linear laws at large strains, and of compressible parts that have lost most of
/// their volume. [`Summary::collapsed_point`](crate::motion::summary::Summary::collapsed_point)
/// is that of parts that resist a change of volume.
pub fn strain_warnings(model: &Model, discretisation: &Discretisation, u: &[f64]) -> Vec<Warning> {
    let (mut strained, mut crushed) = ((LARGE_STRAIN, None), (CRUSHED, None));
    for block in &model.points.blocks {
        let is_linear = matches!(block.law, Law::LinearElastic(_));
        if !is_linear && block.law.projected_fraction() > 0.0 {
            continue;
        }
        for point in block.points.clone() {
            let F = discretisation.supports.deformation_gradient(point, u, model.components);
            if is_linear {
                let strain = small_strain(&F);
                if strain > strained.0 {
                    strained = (strain, Some(point));
                }
            } else if F.determinant() < crushed.0 {
                crushed = (F.determinant(), Some(point));
            }
        }
    }
    let position = |point: usize| model.point_positions[point];
    let linear = strained
        .1
        .map(|point| Warning::LargeLinearStrain { position: position(point), strain: strained.0 });
    let lost = crushed
        .1
        .map(|point| Warning::LostVolume { position: position(point), jacobian: crushed.0 });
    linear.into_iter().chain(lost).collect()
}

/// The largest principal value of ½(∇u + ∇uᵀ) in size, which sees rotations too \[–\].
fn small_strain(F: &Matrix3) -> f64 {
    let strain = (F + F.transpose()) * 0.5 - Matrix3::identity();
    strain.symmetric_eigenvalues().iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

/// The smallest mean of J over a patch of the parts whose change of volume is projected on
/// patches (method book, eq. 3.13): the volume there, of which J at a point says little \[–\].
pub fn smallest_patch_jacobian(
    model: &Model,
    discretisation: &Discretisation,
    u: &[f64],
) -> Option<f64> {
    let projected = |point: usize| {
        let block = model.points.blocks.iter().find(|block| block.points.contains(&point));
        block.is_some_and(|block| block.law.projected_fraction() > 0.0)
    };
    let patches = discretisation.patches.windows(2).map(|ends| ends[0]..ends[1]);
    let means = patches.filter(|patch| !patch.is_empty() && projected(patch.start)).map(|patch| {
        let (mut now, mut before) = (0.0, 0.0);
        for point in patch {
            let weight = discretisation.quadrature.weights[point];
            let F = discretisation.supports.deformation_gradient(point, u, model.components);
            now += weight * F.determinant();
            before += weight;
        }
        now / before
    });
    means.reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::tensor::Vector3;
    use crate::geometry::Shape;
    use crate::material::{ElasticConstants, LinearElastic, Material, NeoHookeanLogJ};
    use crate::problem::{Problem, Recipe};
    use crate::simulation::Simulation;

    /// A cube whose nodes are moved to `F` X.
    fn stretched(law: Law, F: &Matrix3) -> Simulation {
        let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(0.04) };
        let material = Material { density: 1000.0, law };
        let mut simulation =
            Simulation::new(&Problem::new(body, material, Recipe::with_spacing(0.01))).unwrap();
        let positions = simulation.model.positions.clone();
        for (u, X) in simulation.state.displacement.chunks_mut(3).zip(&positions) {
            let moved = F * X - X;
            u.copy_from_slice(moved.as_slice());
        }
        simulation
    }

    fn warnings(law: Law, F: &Matrix3) -> Vec<Warning> {
        let Simulation { model, discretisation, state, .. } = stretched(law, F);
        strain_warnings(&model, &discretisation, &state.displacement)
    }

    fn constants(poisson_ratio: f64) -> ElasticConstants {
        ElasticConstants::from_young_poisson(3000.0, poisson_ratio).unwrap()
    }

    fn along_x(stretch: f64) -> Matrix3 {
        Matrix3::from_diagonal(&Vector3::new(stretch, 1.0, 1.0))
    }

    #[test]
    fn a_linear_law_is_warned_of_beyond_a_strain_of_five_per_cent_and_not_below() {
        let law = Law::LinearElastic(LinearElastic::new(constants(0.3)));
        assert!(warnings(law, &along_x(1.04)).is_empty());
        let found = warnings(law, &along_x(0.4));
        let [Warning::LargeLinearStrain { strain, .. }] = found[..] else { panic!("{found:?}") };
        assert!((strain - 0.6).abs() < 1e-9, "{strain}");
        assert!(found[0].to_string().contains("0.600"), "{}", found[0]);
        // A rotation by 0.4 is a strain of 1 − cos 0.4 to this law.
        let (sine, cosine) = 0.4f64.sin_cos();
        let turned = Matrix3::new(cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0);
        assert_eq!(warnings(law, &turned).len(), 1);
    }

    #[test]
    fn compressible_tissue_that_has_lost_seven_tenths_of_its_volume_is_warned_of() {
        let law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants(0.3)));
        assert!(warnings(law, &along_x(0.31)).is_empty());
        let found = warnings(law, &along_x(0.2));
        let [Warning::LostVolume { jacobian, .. }] = found[..] else { panic!("{found:?}") };
        assert!((jacobian - 0.2).abs() < 1e-9, "{jacobian}");
    }

    #[test]
    fn the_volume_of_patches_is_that_of_projected_parts_alone() {
        let of = |poisson_ratio: f64| {
            let law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants(poisson_ratio)));
            let Simulation { model, discretisation, state, .. } = stretched(law, &along_x(0.9));
            smallest_patch_jacobian(&model, &discretisation, &state.displacement)
        };
        assert_eq!(of(0.3), None);
        assert!((of(0.49).unwrap() - 0.9).abs() < 1e-9);
    }
}
