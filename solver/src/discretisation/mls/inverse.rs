//! Inverses and norms of small matrices.
#![allow(non_snake_case)]

use nalgebra::SMatrix;

/// The inverse of a symmetric matrix by Cholesky, from its lower triangle; `None` unless
/// positive definite.
#[inline]
pub(crate) fn inverse<const M: usize>(A: &SMatrix<f64, M, M>) -> Option<SMatrix<f64, M, M>> {
    let L = cholesky(A)?;
    let mut inverse = SMatrix::<f64, M, M>::identity();
    for column in 0..M {
        for i in column..M {
            let x = inverse[(i, column)] / L[(i, i)];
            inverse[(i, column)] = x;
            for j in i + 1..M {
                inverse[(j, column)] -= x * L[(j, i)];
            }
        }
        for i in (0..M).rev() {
            let mut sum = 0.0;
            for j in i + 1..M {
                sum += L[(j, i)] * inverse[(j, column)];
            }
            inverse[(i, column)] = (inverse[(i, column)] - sum) / L[(i, i)];
        }
    }
    Some(inverse)
}

/// L with A = L Lᵀ, below and on the diagonal.
#[inline]
fn cholesky<const M: usize>(A: &SMatrix<f64, M, M>) -> Option<SMatrix<f64, M, M>> {
    let mut L = *A;
    for j in 0..M {
        for k in 0..j {
            let factor = -L[(j, k)];
            for i in j..M {
                L[(i, j)] += factor * L[(i, k)];
            }
        }
        let diagonal = L[(j, j)];
        if diagonal.is_nan() || diagonal <= 0.0 {
            return None;
        }
        let root = diagonal.sqrt();
        L[(j, j)] = root;
        for i in j + 1..M {
            L[(i, j)] /= root;
        }
    }
    Some(L)
}

#[inline]
pub(super) fn norm_1<const M: usize>(matrix: &SMatrix<f64, M, M>) -> f64 {
    matrix.column_iter().map(|column| column.abs().sum()).fold(0.0, f64::max)
}
