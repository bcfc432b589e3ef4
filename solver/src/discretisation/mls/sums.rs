//! Sums over the nodes that cover a point, four of them side by side.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::support::{Four, Near, Support, dimension, monomials_of};
use crate::discretisation::weight_function::quartic_spline;
use crate::problem::WeightFunction;
use fearless_simd::{Simd, f64x4, prelude::*};
use nalgebra::{SMatrix, SVector};

/// Offsets \[m\] and influence radii \[m\] of four nodes to their weights; offsets are not
/// scaled yet. Also Σw and Σw |X_a − X|² of the four \[m²\].
#[inline(always)]
pub(super) fn weigh<S: Simd>(
    simd: S,
    weight_function: WeightFunction,
    offsets: [[f64; 4]; 3],
    radii: [f64; 4],
) -> (Four, f64x4<S>, f64x4<S>) {
    let [x, y, z]: [f64x4<S>; 3] =
        [offsets[0].simd_into(simd), offsets[1].simd_into(simd), offsets[2].simd_into(simd)];
    let radius: f64x4<S> = radii.simd_into(simd);
    let square = x.mul_add(x, y.mul_add(y, z * z));
    let distance = square.sqrt();
    let (weight, slope) = values_and_derivatives(simd, weight_function, distance / radius);
    // At the node itself the slope is 0, and any distance will do.
    let safe = distance.max(radius * 1e-12);
    let factor = f64x4::splat(simd, 0.0) - slope / (radius * safe);
    let gradient = [(x * factor).into(), (y * factor).into(), (z * factor).into()];
    (Four { scaled: offsets, weight: weight.into(), gradient }, weight, weight * square)
}

/// W and dW/dq at four q.
#[inline(always)]
fn values_and_derivatives<S: Simd>(
    simd: S,
    weight_function: WeightFunction,
    q: f64x4<S>,
) -> (f64x4<S>, f64x4<S>) {
    let constant = |x: f64| f64x4::splat(simd, x);
    if weight_function == WeightFunction::QuarticSpline {
        // Both vanish at 1.
        return quartic_spline(q.min(constant(1.0)), constant);
    }
    let q: [f64; 4] = q.into();
    let (mut values, mut slopes) = ([0.0; 4], [0.0; 4]);
    for lane in 0..4 {
        (values[lane], slopes[lane]) = weight_function.value_and_derivative(q[lane]);
    }
    (values.simd_into(simd), slopes.simd_into(simd))
}

/// Σ_a w_a p_a p_aᵀ.
#[inline(always)]
pub(super) fn moment_matrix<S: Simd, const M: usize>(simd: S, near: &Near) -> SMatrix<f64, M, M> {
    let mut sums = [[f64x4::splat(simd, 0.0); M]; M];
    for four in &near.fours {
        let p = monomials_of::<S, M>(simd, four);
        let weight: f64x4<S> = four.weight.simd_into(simd);
        for i in 0..M {
            let weighted = weight * p[i];
            for j in 0..=i {
                sums[i][j] = weighted.mul_add(p[j], sums[i][j]);
            }
        }
    }
    let mut A = SMatrix::zeros();
    for i in 0..M {
        for j in 0..=i {
            A[(i, j)] = sums[i][j].reduce_sum();
            A[(j, i)] = A[(i, j)];
        }
    }
    A
}

/// Σ_a ∂_k w_a p_a p_aᵀ c for the directions k.
#[inline(always)]
pub(super) fn slope_moments<S: Simd, const M: usize>(
    simd: S,
    near: &Near,
    c: &SVector<f64, M>,
) -> [SVector<f64, M>; 3] {
    let mut sums = [[f64x4::splat(simd, 0.0); M]; 3];
    for four in &near.fours {
        let p = monomials_of::<S, M>(simd, four);
        let value = polynomial(simd, c, &p);
        for (sums, gradient) in sums.iter_mut().zip(four.gradient).take(dimension(M)) {
            let gradient: f64x4<S> = gradient.simd_into(simd);
            let weighted = gradient * value;
            for i in 0..M {
                sums[i] = weighted.mul_add(p[i], sums[i]);
            }
        }
    }
    let mut moments = [SVector::zeros(); 3];
    for k in 0..dimension(M) {
        for i in 0..M {
            moments[k][i] = sums[k][i].reduce_sum();
        }
    }
    moments
}

/// φ_a = w_a cᵀp and its gradient from those of w_a and c.
#[inline(always)]
pub(super) fn fill<S: Simd, const M: usize>(
    simd: S,
    near: &Near,
    c: &SVector<f64, M>,
    slopes: &[SVector<f64, M>; 3],
    support: &mut Support,
) {
    let count = near.nodes.len();
    support.nodes.extend_from_slice(&near.nodes);
    support.phi.resize(count, 0.0);
    support.grad_phi.resize(count, Vector3::zeros());
    let rows = support.phi.chunks_mut(4).zip(support.grad_phi.chunks_mut(4));
    for (four, (values, gradients)) in near.fours.iter().zip(rows) {
        let p = monomials_of::<S, M>(simd, four);
        let weight: f64x4<S> = four.weight.simd_into(simd);
        let value = polynomial(simd, c, &p);
        let phi: [f64; 4] = (weight * value).into();
        values.copy_from_slice(&phi[..values.len()]);
        for k in 0..dimension(M) {
            let gradient: f64x4<S> = four.gradient[k].simd_into(simd);
            let slope = polynomial(simd, &slopes[k], &p);
            let along: [f64; 4] = gradient.mul_add(value, weight * slope).into();
            gradients.iter_mut().zip(along).for_each(|(gradient, along)| gradient[k] = along);
        }
    }
}

/// cᵀp of four nodes.
#[inline(always)]
fn polynomial<S: Simd, const M: usize>(
    simd: S,
    c: &SVector<f64, M>,
    p: &[f64x4<S>; M],
) -> f64x4<S> {
    let mut sum = p[0] * c[0];
    for i in 1..M {
        sum = p[i].mul_add(f64x4::splat(simd, c[i]), sum);
    }
    sum
}

/// e_{k+1}/s − A,_k c from the second term: with A⁻¹ they give the derivatives of the
/// coefficients A⁻¹ p(X) along the directions k.
pub(super) fn slope_right_sides<const M: usize>(
    moments: [SVector<f64, M>; 3],
    penalty: Option<Vector3>,
    c: &SVector<f64, M>,
    s: f64,
) -> [SVector<f64, M>; 3] {
    let mut right = moments.map(|moment| -moment);
    for (k, column) in right.iter_mut().enumerate().take(dimension(M)) {
        column[k + 1] += 1.0 / s;
        let Some(slope) = penalty else { continue };
        for i in dimension(M) + 1..M {
            column[i] -= slope[k] * c[i];
        }
    }
    right
}
