//! Affine moments of values at points.
#![allow(non_snake_case)]

use crate::algebra::pseudo_inverse::pseudo_inverse;
use crate::algebra::tensor::Vector3;
use nalgebra::{Matrix4, Matrix4x3, Vector4};

/// (1, x, y, z).
pub fn homogeneous(x: &Vector3) -> Vector4<f64> {
    Vector4::new(1.0, x.x, x.y, x.z)
}

/// Directions with less than this fraction of all sizes are empty \[–\].
const EMPTY: f64 = 1e-12;

/// Changes the `values` at the points of `own` as little as possible, in proportion
/// to `sizes`, so that their moments Σ p ⊗ value, p = (1, (X − centre)/length), are
/// reduced by `excess(moments, length)`.
pub fn reduce_moments(
    values: &mut [Vector3],
    sizes: &[f64],
    positions: &[Vector3],
    own: &[usize],
    excess: impl FnOnce(Matrix4x3<f64>, f64) -> Matrix4x3<f64>,
) {
    let total: f64 = own.iter().map(|&i| sizes[i]).sum();
    if total == 0.0 {
        return;
    }
    let centre = own.iter().map(|&i| sizes[i] * positions[i]).sum::<Vector3>() / total;
    let distance = |&i: &usize| (positions[i] - centre).norm();
    let length = own.iter().map(distance).fold(f64::MIN_POSITIVE, f64::max);
    let p = |i: usize| homogeneous(&((positions[i] - centre) / length));
    let mut gram = Matrix4::zeros();
    let mut moments = Matrix4x3::zeros();
    for &i in own {
        gram += sizes[i] * p(i) * p(i).transpose();
        moments += p(i) * values[i].transpose();
    }
    let change = pseudo_inverse(gram, EMPTY * total) * excess(moments, length);
    own.iter().for_each(|&i| values[i] -= sizes[i] * change.tr_mul(&p(i)));
}
