//! Collocation of prescribed values for functions that do not interpolate.

use crate::algebra::tensor::Vector3;
use crate::discretisation::{Discretisation, Rows};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, MatMut, Par, Side};
use std::sync::Arc;

/// u = u* + M⁻¹Φᵀ(ΦM⁻¹Φᵀ)⁻¹(ū − Φu*): the displacement field takes the
/// prescribed values ū at the collocation nodes (method book, eq. 15.2: EBCIEM of
/// Joldes, Chowdhury, Wittek, Miller 2017 with V = Φᵀ). The matrix is factored once.
#[derive(Debug, Clone)]
pub(super) struct Collocation {
    /// Row i of Φ: the shape functions at collocation node i.
    rows: Rows,
    symbolic: Arc<SymbolicCholesky<usize>>,
    factor: Vec<f64>,
}

/// Memory for the triangular solves, with its size in bytes.
#[derive(Default)]
pub(super) struct Scratch(Option<MemBuffer>, usize);

impl std::fmt::Debug for Scratch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Scratch").field(&self.1).finish()
    }
}

impl Collocation {
    /// `None` if the constraints are linearly dependent.
    pub fn new(
        discretisation: &Discretisation,
        mass: &[f64],
        nodes: &[u32],
    ) -> Option<Collocation> {
        let positions: Vec<Vector3> =
            nodes.iter().map(|&node| discretisation.cloud.positions[node as usize]).collect();
        let rows = discretisation.rows_at(&positions).ok()?;
        let matrix = gram_matrix(&rows, mass)?;
        let symbolic = factorize_symbolic_cholesky(
            matrix.symbolic(),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .ok()?;
        let mut factor = vec![0.0; symbolic.len_val()];
        let required = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        symbolic
            .factorize_numeric_llt(
                &mut factor,
                matrix.as_ref(),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut MemBuffer::new(required)),
                Default::default(),
            )
            .ok()?;
        Some(Collocation { rows, symbolic: Arc::new(symbolic), factor })
    }

    /// Replaces prescribed values ū by the multipliers (ΦM⁻¹Φᵀ)⁻¹(ū − Φu), where
    /// `value_of(node)` is the nodal parameter.
    pub fn solve(&self, values: &mut [f64], scratch: &mut Scratch, value_of: impl Fn(u32) -> f64) {
        for (i, value) in values.iter_mut().enumerate() {
            for entry in self.rows.row(i) {
                *value -= self.rows.phi[entry] * value_of(self.rows.nodes[entry]);
            }
        }
        let required = self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        if scratch.0.is_none() || scratch.1 < required.size_bytes() {
            *scratch = Scratch(Some(MemBuffer::new(required)), required.size_bytes());
        }
        if let Some(memory) = &mut scratch.0 {
            let n = values.len();
            LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(values, n, 1),
                Par::Seq,
                MemStack::new(memory),
            );
        }
    }

    /// The displacement field \[m\] at collocation node `i`.
    pub fn displacement(&self, i: usize, u: &[f64], components: usize) -> Vector3 {
        self.rows.interpolate(i, u, components)
    }

    /// Calls `correct(node, Δu)` for the changes Δu = M⁻¹Φᵀλ, term by term.
    pub fn corrections(
        &self,
        mass: &[f64],
        multipliers: &[f64],
        mut correct: impl FnMut(u32, f64),
    ) {
        for (i, multiplier) in multipliers.iter().enumerate() {
            for entry in self.rows.row(i) {
                let node = self.rows.nodes[entry];
                correct(node, self.rows.phi[entry] * multiplier / mass[node as usize]);
            }
        }
    }
}

/// The lower triangle of ΦM⁻¹Φᵀ.
fn gram_matrix(rows: &Rows, mass: &[f64]) -> Option<SparseColMat<usize, f64>> {
    let mut columns: Vec<Vec<(usize, f64)>> = vec![Vec::new(); mass.len()];
    for i in 0..rows.len() {
        for entry in rows.row(i) {
            columns[rows.nodes[entry] as usize].push((i, rows.phi[entry]));
        }
    }
    let mut triplets = Vec::new();
    for (node, entries) in columns.iter().enumerate() {
        for (position, &(i, phi_i)) in entries.iter().enumerate() {
            for &(j, phi_j) in &entries[..=position] {
                triplets.push(Triplet::new(i, j, phi_i * phi_j / mass[node]));
            }
        }
    }
    SparseColMat::try_new_from_triplets(rows.len(), rows.len(), &triplets).ok()
}
