//! The modified quadratic basis: a penalty on the second-order terms.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::support::{Near, Support, monomials};
use crate::problem::Basis;
use nalgebra::{DMatrix, DVector, SMatrix};

/// Restores the reproduction of linear fields, which round-off has disturbed:
/// second-order coefficients reach 1/μ and cancel in φ, which leaves about
/// 1e-16/μ. `inverse` is that of the linear part of A.
pub(super) fn restore_linear<const M: usize>(
    components: usize,
    support: &mut Support,
    near: &Near,
    inverse: &DMatrix<f64>,
    s: f64,
) {
    let size = components + 1;
    let lacking = |target: DVector<f64>, value: &dyn Fn(usize) -> f64| {
        let lack = near.iter().enumerate().fold(target, |lack, (a, weighed)| {
            let p = monomials::<M>(&weighed.scaled);
            lack - DVector::from_fn(size, |i, _| p[i] * value(a))
        });
        inverse * lack
    };
    let unit =
        |i: usize, value: f64| DVector::from_fn(size, |row, _| if row == i { value } else { 0.0 });
    let values = lacking(unit(0, 1.0), &|a| support.phi[a]);
    let slopes: Vec<DVector<f64>> = (0..components)
        .map(|k| lacking(unit(k + 1, 1.0 / s), &|a| support.grad_phi[a][k]))
        .collect();
    for (a, weighed) in near.iter().enumerate() {
        let p = monomials::<M>(&weighed.scaled);
        let part = |c: &DVector<f64>| weighed.weight * (0..size).map(|i| c[i] * p[i]).sum::<f64>();
        support.phi[a] += part(&values);
        for (k, slope) in slopes.iter().enumerate() {
            support.grad_phi[a][k] += part(slope);
        }
    }
}

/// Adds μ Σw to the second-order diagonal of A in the scaled basis (Joldes
/// et al. 2015, eq. 12, there without Σw) and returns μ times the gradient
/// of the added term: with R = Σ w |X_a − X|² it is Σw s⁴ = R²/Σw in metres,
/// so that s⁻⁴ ∂(R²/Σw) = 2 s⁻² ∂R − ∂Σw (method book, eqs. 6.7 and 6.8).
pub(super) fn regularise<const M: usize>(
    basis: Basis,
    components: usize,
    A: &mut SMatrix<f64, M, M>,
    near: &Near,
    total: f64,
    s: f64,
) -> Option<Vector3> {
    let Basis::ModifiedQuadratic { regularisation } = basis else { return None };
    for i in components + 1..M {
        A[(i, i)] += regularisation * total;
    }
    let mut slope = Vector3::zeros();
    for a in near.iter() {
        let offset = a.scaled * s;
        let moment = a.gradient * offset.norm_squared() - offset * (2.0 * a.weight);
        slope += moment * (2.0 / (s * s)) - a.gradient;
    }
    Some(slope * regularisation)
}

/// Inverse and condition (1-norm) of the first `size` rows and columns.
pub(super) fn linear_part<const M: usize>(
    A: &SMatrix<f64, M, M>,
    size: usize,
) -> Option<(DMatrix<f64>, f64)> {
    let norm = |part: &DMatrix<f64>| {
        part.column_iter().map(|column| column.abs().sum()).fold(0.0, f64::max)
    };
    let part = DMatrix::from_fn(size, size, |i, j| A[(i, j)]);
    let inverse = part.clone().cholesky()?.inverse();
    let condition = norm(&part) * norm(&inverse);
    Some((inverse, condition))
}
