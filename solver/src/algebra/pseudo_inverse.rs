//! Inverses of symmetric matrices that may have empty directions.
#![allow(non_snake_case)]

use nalgebra::allocator::Allocator;
use nalgebra::{Const, DefaultAllocator, DimDiff, DimSub, SMatrix, U1};

/// A⁺ of a symmetric matrix without negative eigenvalues, in which a direction with an eigenvalue
/// of at most `empty` stays empty. By its eigenvectors: a singular value decomposition of such a
/// matrix, with an empty direction and two alike, was seen to end up to 20 % beside it.
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

    /// Moments of a flat body about its middle: two directions alike or nearly, one empty, and
    /// round-off between them.
    fn moments(random: &mut Random, turn: usize) -> Matrix4<f64> {
        let extent = random.vector(1).x.abs();
        let alike = [extent, extent * (1.0 + 1e-3 * random.vector(1).x)][turn % 2];
        let sizes = [[1.0, extent, alike, 0.0], [1.0, extent, 0.0, alike], [1.0, 1.0, extent, 0.0]];
        let mut A = Matrix4::from_diagonal(&Vector4::from(sizes[turn / 2 % 3]));
        let round_off = [0.0, 1e-17, 1e-16, 1e-14][turn / 6 % 4];
        for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            A[(i, j)] = round_off * random.vector(1).x;
            A[(j, i)] = A[(i, j)];
        }
        A
    }

    #[test]
    fn a_matrix_times_its_pseudo_inverse_times_itself_is_the_matrix() {
        let mut random = Random(11);
        for turn in 0..24_000 {
            let A = moments(&mut random, turn) * [1.0, 0.00731][turn / 24 % 2];
            let empty = 1e-12 * A[(0, 0)];
            // Of nalgebra's own, by singular values, 32 of these are more than 1e-6 off, one 0.2.
            let off = (A * pseudo_inverse(A, empty) * A - A).amax() / A[(0, 0)];
            assert!(off < 1e-11, "{turn}: {A}");
        }
    }

    #[test]
    fn an_empty_direction_stays_empty() {
        let v = Vector4::new(1.0, 2.0, 0.0, 2.0);
        let inverse = pseudo_inverse(v * v.transpose(), 1e-12);
        assert!((inverse - v * v.transpose() / 81.0_f64).amax() < 1e-15, "{inverse}");
    }
}
