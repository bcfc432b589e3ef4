//! Vectors and tensors in space.
#![allow(non_snake_case)]

use crate::algebra::real::Real;

/// A vector in space, in the unit that its context states.
pub type Vector3 = nalgebra::Vector3<f64>;
/// A second-order tensor as a 3×3 matrix.
pub type Matrix3 = nalgebra::Matrix3<f64>;

/// cof A = det A · A⁻ᵀ, defined for singular A too; ∂J/∂F = cof F (method book,
/// eq. 2.3).
#[inline]
pub fn cofactor(a: &Matrix3) -> Matrix3 {
    let (r0, r1, r2) = (a.row(0), a.row(1), a.row(2));
    let (c0, c1, c2) = (
        r1.transpose().cross(&r2.transpose()),
        r2.transpose().cross(&r0.transpose()),
        r0.transpose().cross(&r1.transpose()),
    );
    Matrix3::from_rows(&[c0.transpose(), c1.transpose(), c2.transpose()])
}

/// A second-order tensor of any [`Real`], row by row.
pub type Tensor<R> = [[R; 3]; 3];

/// The same entries as a [`Tensor`].
pub fn tensor(a: &Matrix3) -> Tensor<f64> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[(i, j)]))
}

/// As [`cofactor`], of any [`Real`].
#[inline(always)]
pub fn tensor_cofactor<R: Real>(a: &Tensor<R>) -> Tensor<R> {
    map(
        #[inline(always)]
        |i, j| {
            let (k, l, m, n) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            a[k][m].times_plus(a[l][n], -(a[k][n] * a[l][m]))
        },
    )
}

/// A : B = Σ A_ij B_ij.
#[inline(always)]
pub fn contract<R: Real>(a: &Tensor<R>, b: &Tensor<R>) -> R {
    dot(&a[0], &b[0]) + dot(&a[1], &b[1]) + dot(&a[2], &b[2])
}

/// a · b.
#[inline(always)]
pub fn dot<R: Real>(a: &[R; 3], b: &[R; 3]) -> R {
    a[0].times_plus(b[0], a[1].times_plus(b[1], a[2] * b[2]))
}

/// C = FᵀF (method book, eq. 2.4).
#[inline(always)]
pub fn right_cauchy_green<R: Real>(F: &Tensor<R>) -> Tensor<R> {
    let transpose = transposed(F);
    times_symmetric(&transpose, &transpose)
}

/// Aᵀ.
#[inline(always)]
pub fn transposed<R: Real>(a: &Tensor<R>) -> Tensor<R> {
    map(
        #[inline(always)]
        |i, j| a[j][i],
    )
}

/// A Bᵀ, which is A B for a symmetric B.
#[inline(always)]
pub fn times_symmetric<R: Real>(a: &Tensor<R>, b: &Tensor<R>) -> Tensor<R> {
    map(
        #[inline(always)]
        |i, j| dot(&a[i], &b[j]),
    )
}

/// The tensor with the entries `entry(i, j)`.
#[inline(always)]
pub fn map<R: Real>(entry: impl Fn(usize, usize) -> R) -> Tensor<R> {
    [
        [entry(0, 0), entry(0, 1), entry(0, 2)],
        [entry(1, 0), entry(1, 1), entry(1, 2)],
        [entry(2, 0), entry(2, 1), entry(2, 2)],
    ]
}

/// Rotation by `angle` \[rad\] about `axis` (Rodrigues' formula).
pub fn rotation(axis: &Vector3, angle: f64) -> Matrix3 {
    let unit = nalgebra::Unit::new_normalize(*axis);
    nalgebra::Rotation3::from_axis_angle(&unit, angle).into_inner()
}

/// Lower and upper corner of the box around `positions`, which must not be empty.
pub fn bounding_box(positions: &[Vector3]) -> (Vector3, Vector3) {
    let first = (positions[0], positions[0]);
    positions.iter().fold(first, |(lower, upper), x| (lower.inf(x), upper.sup(x)))
}

/// Entry `node` of a packed nodal field with `components` per node; missing
/// components are 0.
pub fn vector_at(field: &[f64], node: usize, components: usize) -> Vector3 {
    let mut value = Vector3::zeros();
    for k in 0..components {
        value[k] = field[components * node + k];
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cofactor_is_determinant_times_inverse_transpose() {
        let a = Matrix3::new(1.1, 0.2, -0.3, 0.05, 0.9, 0.4, 0.0, -0.2, 1.3);
        let expected = a.try_inverse().unwrap().transpose() * a.determinant();
        assert!((cofactor(&a) - expected).norm() < 1e-14);
    }

    #[test]
    fn a_rotation_turns_x_into_y_about_z() {
        let turned = rotation(&Vector3::z(), std::f64::consts::FRAC_PI_2) * Vector3::x();
        assert!((turned - Vector3::y()).norm() < 1e-15);
    }
}
