//! Inverses and norms of small matrices.
#![allow(non_snake_case)]

use nalgebra::SMatrix;

/// The inverse of a symmetric matrix by Cholesky, from its lower triangle; `None` unless
/// positive definite.
#[inline(always)]
pub(crate) fn inverse<const M: usize>(A: &SMatrix<f64, M, M>) -> Option<SMatrix<f64, M, M>> {
    let (L, over) = cholesky(A)?;
    let mut inverse = SMatrix::<f64, M, M>::identity();
    for column in 0..M {
        for i in column..M {
            let x = inverse[(i, column)] * over[i];
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
            inverse[(i, column)] = (inverse[(i, column)] - sum) * over[i];
        }
    }
    Some(inverse)
}

/// L with A = L Lᵀ below the diagonal, and one over its diagonal.
#[inline(always)]
fn cholesky<const M: usize>(A: &SMatrix<f64, M, M>) -> Option<(SMatrix<f64, M, M>, [f64; M])> {
    let (mut L, mut over) = (*A, [0.0; M]);
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
        over[j] = 1.0 / diagonal.sqrt();
        for i in j + 1..M {
            L[(i, j)] *= over[j];
        }
    }
    Some((L, over))
}

#[inline]
pub(super) fn norm_1<const M: usize>(matrix: &SMatrix<f64, M, M>) -> f64 {
    matrix.column_iter().map(|column| column.abs().sum()).fold(0.0, f64::max)
}
