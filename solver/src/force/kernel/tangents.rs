//! ∂P/∂F at the points of a block, for laws that cost more than a product with it.

use super::points::stresses;
use crate::algebra::lanes::{LANES, Lanes, Parts, SimdBlock};
use crate::force::layout::Block;
use crate::material::ConstitutiveLaw;
use fearless_simd::Simd;
use std::ops::Range;

/// Derivatives at the same displacements after which ∂P/∂F is computed, from nine more of the law.
const WORTH: usize = 9;
/// Entries of ∂P/∂F.
const ENTRIES: usize = 81;

/// The tangents of the law at the points of a block, once they are worth their computation.
#[derive(Debug, Default)]
pub(super) struct Tangents {
    /// ∂P_ij/∂F_kl \[group\]\[kl\]\[ij\] \[Pa\].
    values: Vec<SimdBlock>,
    /// Derivatives since the block was linearised.
    derivatives: usize,
}

impl Tangents {
    /// The block has been linearised elsewhere.
    pub fn clear(&mut self) {
        self.values.clear();
        self.derivatives = 0;
    }

    /// Counts a derivative, and says whether the tangents are to be used for it.
    pub fn are_worth(&mut self, block: &Block) -> bool {
        // What acts beside a law needs its stress too.
        if !block.law.is_costly() || block.has_extra_stress() {
            return false;
        }
        self.derivatives += 1;
        self.derivatives > WORTH
    }

    /// dP = ∂P/∂F : dF of the groups of a chunk, which come one after the other; dF stands in the
    /// slopes of the deformation, dP goes into those of the stress.
    #[inline(always)]
    pub fn multiply<S: Simd, R: Lanes<S>, L: ConstitutiveLaw>(
        &mut self,
        simd: S,
        (law, frames): (&L, &[[SimdBlock; 9]]),
        groups: Range<usize>,
        (deformation, stress, jacobians): (
            &mut Parts<SimdBlock>,
            &mut Parts<SimdBlock>,
            &mut Parts<SimdBlock>,
        ),
    ) {
        let count = groups.len();
        if self.values.len() < ENTRIES * groups.end {
            self.values.resize(ENTRIES * groups.end, SimdBlock::default());
            let asked = deformation.slopes[..9 * count].to_vec();
            for column in 0..9 {
                for (entry, slope) in deformation.slopes[..9 * count].iter_mut().enumerate() {
                    let one = if entry % 9 == column { 1.0 } else { 0.0 };
                    *slope = SimdBlock([one; LANES]);
                }
                let results = (&mut *stress, &mut *jacobians, false);
                stresses::<S, R, L, 3>(simd, (law, frames), count, deformation, None, results);
                for group in 0..count {
                    let start = ENTRIES * (groups.start + group) + 9 * column;
                    self.values[start..start + 9]
                        .copy_from_slice(&stress.slopes[9 * group..9 * group + 9]);
                }
            }
            deformation.slopes[..9 * count].copy_from_slice(&asked);
        }
        let tangents = &self.values[ENTRIES * groups.start..ENTRIES * groups.end];
        simd.vectorize(
            #[inline(always)]
            || {
                for (group, tangent) in tangents.chunks_exact(ENTRIES).enumerate() {
                    let changes = &deformation.slopes[9 * group..9 * group + 9];
                    let mut sums = [SimdBlock::default(); 9];
                    for (change, column) in changes.iter().zip(tangent.chunks_exact(9)) {
                        for (sum, entry) in sums.iter_mut().zip(column) {
                            for lane in 0..LANES {
                                sum.0[lane] += entry.0[lane] * change.0[lane];
                            }
                        }
                    }
                    stress.slopes[9 * group..9 * group + 9].copy_from_slice(&sums);
                }
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::WORTH;
    use crate::algebra::random::Random;
    use crate::algebra::tensor::Vector3;
    use crate::discretisation::Discretisation;
    use crate::force::forces::{Workspace, linearise, linearised_stiffness_times};
    use crate::force::layout::PackedPoints;
    use crate::geometry::Shape;
    use crate::material::VolumetricTerm;
    use crate::material::{ElasticConstants, Law, Material, Ogden, OgdenTerm, OgdenTerms};
    use crate::problem::{Dimension, Problem, Recipe};

    /// The largest difference between the first derivative and the last of some at the same
    /// displacements, over the largest entry.
    fn difference(poisson_ratio: f64, dimension: Dimension) -> f64 {
        let terms = [(800.0, 1.3), (40.0, -4.7)].map(|(mu, alpha)| OgdenTerm { mu, alpha });
        let terms = OgdenTerms::new(&terms).unwrap();
        let mu = terms.shear_modulus();
        let constants = ElasticConstants::from_shear_poisson(mu, poisson_ratio).unwrap();
        let term = VolumetricTerm::Quadratic;
        let law = Law::Ogden(Ogden::new(terms, constants.bulk_modulus, term).unwrap());
        let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(0.05) };
        let material = Material { density: 1000.0, law };
        let mut problem = Problem::new(body, material, Recipe::with_spacing(0.01));
        problem.dimension = dimension;
        let discretisation = Discretisation::new(&problem).unwrap();
        let points = PackedPoints::new(&problem, &discretisation).unwrap();
        let size = points.components * discretisation.cloud.positions.len();
        let mut random = Random(7);
        let mut field = || -> Vec<f64> { (0..size).map(|_| 1e-3 * random.vector(1).x).collect() };
        let (u, v) = (field(), field());
        let mut workspace = Workspace::new(&points);
        linearise(&points, &u, &mut workspace);
        let mut product = || {
            let mut product = vec![0.0; size];
            linearised_stiffness_times(&points, &v, None, &mut workspace, &mut product);
            product
        };
        let first = product();
        let all: Vec<Vec<f64>> = (0..WORTH + 2).map(|_| product()).collect();
        let last = &all[WORTH + 1];
        let largest = first.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let differences = first.iter().zip(last).map(|(a, b)| (a - b).abs());
        assert_ne!(&first, last, "the tangents were not used");
        differences.fold(0.0, f64::max) / largest
    }

    #[test]
    fn products_with_kept_tangents_are_those_of_the_law() {
        let plane = Dimension::PlaneStrain { thickness: 0.01, z: 0.025 };
        for poisson_ratio in [0.3, 0.49] {
            for dimension in [Dimension::Three, plane] {
                let difference = difference(poisson_ratio, dimension);
                assert!(difference < 1e-13, "{poisson_ratio}: {difference}");
            }
        }
    }
}
