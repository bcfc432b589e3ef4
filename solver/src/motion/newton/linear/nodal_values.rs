//! Nodal parameters from nodal values of the displacement, approximately.
#![allow(non_snake_case)]

use crate::algebra::sparse::{Combine, Padded, Sparse};
use crate::discretisation::Rows;
use nalgebra::{Cholesky, DMatrix, DVector};
use rayon::prelude::*;

/// Weight of the size of a row of S beside its equations \[–\]: irregular clouds have Φ that
/// are nearly singular.
const REGULARISATION: f64 = 0.1;

/// T = S (2 I − Φ S) ≈ Φ⁻¹ with Φ_ab = φ_b(X_a) and a sparse S that inverts Φ within the
/// support of each node (method book, eq. 21.6). Short waves of the nodal parameters, which
/// the shape functions smooth away, are short waves of the values again.
///
/// Q = I − S Φ is what is left: parameters whose values vanish almost, and which T leaves out.
pub(super) struct NodalValues {
    /// Φ and Φᵀ.
    phi: [Sparse; 2],
    /// S and Sᵀ.
    local: [Sparse; 2],
}

impl NodalValues {
    /// From the shape functions at the nodes.
    pub fn new(rows: &Rows) -> NodalValues {
        let count = rows.len();
        let row = |a: usize| rows.row(a).map(|e| (rows.nodes[e], rows.phi[e])).collect();
        let phi = Sparse::from_rows((0..count).map(row));
        let local: Vec<_> = (0..count).into_par_iter().map(|a| local_inverse(rows, a)).collect();
        let local = Sparse::from_rows(local);
        let both = |matrix: Sparse| {
            let transposed = matrix.transposed(count);
            [matrix, transposed]
        };
        NodalValues { phi: both(phi), local: both(local) }
    }

    /// Means of values of the parameters, each weighted by the square of its part in the
    /// displacement whose value is 1 at one node and 0 at its neighbours.
    pub fn mean(&self, values: &[f64]) -> Vec<f64> {
        let [_, transposed] = &self.local;
        let mean = |ends: &[usize]| {
            let (mut sum, mut weights) = (0.0, 0.0);
            for entry in ends[0]..ends[1] {
                let weight = f64::from(transposed.values[entry]).powi(2);
                sum += weight * values[transposed.columns[entry] as usize];
                weights += weight;
            }
            sum / weights
        };
        transposed.starts.windows(2).map(mean).collect()
    }

    /// T D⁻¹ Tᵀ r + Q E⁻¹ Qᵀ r into the last of the buffers, with the inverses of D and E, one
    /// number for each node.
    pub fn apply(
        &self,
        r: &[Padded],
        inverses: impl Fn(usize) -> [f64; 2],
        [values, rest, result]: &mut [Vec<Padded>; 3],
    ) {
        let ([phi, phi_t], [local, local_t]) = (&self.phi, &self.local);
        values.resize(r.len(), [0.0; 4]);
        result.resize(r.len(), [0.0; 4]);
        // Tᵀ r and Qᵀ r.
        rest.clear();
        rest.extend_from_slice(r);
        local_t.product(r, values, Combine::Replace);
        phi_t.product(values, rest, Combine::Subtract);
        local_t.product(rest, values, Combine::Add);
        for (a, (values, rest)) in values.iter_mut().zip(&mut *rest).enumerate() {
            let [value, hidden] = inverses(a);
            values.iter_mut().for_each(|x| *x *= value);
            rest.iter_mut().for_each(|x| *x *= hidden);
        }
        // T v + Q w = 2 S v + w − S Φ (S v + w).
        local.product(values, result, Combine::Replace);
        for (result, rest) in result.iter_mut().zip(&mut *rest) {
            for (result, rest) in result.iter_mut().zip(rest) {
                *rest += *result;
                *result += *rest;
            }
        }
        phi.product(rest, values, Combine::Replace);
        local.product(values, result, Combine::Subtract);
    }
}

/// Row a of S: Σ_c S_ac Φ_cb = δ_ab for all b and c in the support of node a.
fn local_inverse(rows: &Rows, a: usize) -> Vec<(u32, f64)> {
    let nodes = &rows.nodes[rows.row(a)];
    let mut matrix = DMatrix::<f64>::zeros(nodes.len(), nodes.len());
    for (i, &c) in nodes.iter().enumerate() {
        let mut entries = rows.row(c as usize).peekable();
        for (j, b) in nodes.iter().enumerate() {
            while entries.next_if(|&entry| rows.nodes[entry] < *b).is_some() {}
            if let Some(entry) = entries.next_if(|&entry| rows.nodes[entry] == *b) {
                matrix[(j, i)] = rows.phi[entry];
            }
        }
    }
    let own = |&node: &u32| if node as usize == a { 1.0 } else { 0.0 };
    let unit = DVector::from_iterator(nodes.len(), nodes.iter().map(own));
    // The least squares of the equations and of the row itself.
    let size = nodes.len();
    let squares = DMatrix::identity(size, size) * REGULARISATION.powi(2);
    let normal = matrix.transpose() * &matrix + squares;
    match Cholesky::new(normal) {
        Some(cholesky) => {
            let row = cholesky.solve(&(matrix.transpose() * unit));
            nodes.iter().copied().zip(row.iter().copied()).collect()
        }
        None => vec![(a as u32, 1.0)],
    }
}
