//! Inverses of symmetric matrices that may have empty directions.
#![allow(non_snake_case)]

use nalgebra::allocator::Allocator;
use nalgebra::{Const, DefaultAllocator, DimDiff, DimSub, SMatrix, U1};

/// A⁺ of a symmetric matrix without negative eigenvalues, in which a direction with an eigenvalue
/// of at most `empty` stays empty. By its eigenvectors: a singular value decomposition of such a
/// matrix, with an empty direction and two alike, was seen to end 0.5 % beside it.
pub(crate) fn pseudo_inverse<const N: usize>(
    A: SMatrix<f64, N, N>,
    empty: f64,
) -> SMatrix<f64, N, N>
where
    Const<N>: DimSub<U1>,
    DefaultAllocator: Allocator<DimDiff<Const<N>, U1>>,
{
    let mut eigen = A.symmetric_eigen();
    eigen.eigenvalues.apply(|value| *value = if *value > empty { 1.0 / *value } else { 0.0 });
    eigen.recompose()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::random::Random;
    use nalgebra::{Matrix4, Vector4};

    /// Σ p pᵀ over the corners of a flat or a full block, turned and displaced by a hair, whose
    /// moments are alike or empty.
    fn moments(random: &mut Random, flat: bool, hair: f64) -> Matrix4<f64> {
        let axis = nalgebra::Unit::new_normalize(random.vector(3));
        let turned = nalgebra::Rotation3::from_axis_angle(&axis, random.vector(3).x);
        let mut sum = Matrix4::zeros();
        for corner in 0..8usize {
            let sign = |axis: usize| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
            let thickness = if flat { 0.0 } else { 1.0 };
            let X = nalgebra::Vector3::new(sign(0), sign(1), thickness * sign(2));
            let X = turned * X + hair * random.vector(3);
            let p = Vector4::new(1.0, X.x, X.y, X.z);
            sum += p * p.transpose() / 8.0;
        }
        sum
    }

    #[test]
    fn a_matrix_times_its_pseudo_inverse_times_itself_is_the_matrix() {
        let mut random = Random(11);
        for turn in 0..4000 {
            let hair = [0.0, 1e-16, 1e-12, 1e-9][turn % 4];
            let A = moments(&mut random, turn % 8 < 4, hair);
            let again = A * pseudo_inverse(A, 1e-12) * A;
            assert!((again - A).amax() < 1e-9, "{turn}: {A} {again}");
        }
    }

    #[test]
    fn an_empty_direction_stays_empty() {
        let v = Vector4::new(1.0, 2.0, 0.0, 2.0);
        let inverse = pseudo_inverse(v * v.transpose(), 1e-12);
        assert!((inverse - v * v.transpose() / 81.0_f64).amax() < 1e-15, "{inverse}");
    }
}
