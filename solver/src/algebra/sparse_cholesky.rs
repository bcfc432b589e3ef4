//! Sparse symmetric systems by Cholesky's factors.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SparseColMat;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::{Conj, MatMut, Par, Side};
use std::sync::Arc;

/// L with A = L Lᵀ, rows and columns in an order of few entries.
#[derive(Debug, Clone)]
pub(crate) struct SparseCholesky {
    symbolic: Arc<SymbolicCholesky<usize>>,
    factor: Vec<f64>,
}

/// Memory for solving, with its size in bytes.
#[derive(Default)]
pub(crate) struct Scratch(Option<MemBuffer>, usize);

/// There is nothing in it to keep.
impl Clone for Scratch {
    fn clone(&self) -> Scratch {
        Scratch::default()
    }
}

impl std::fmt::Debug for Scratch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Scratch").field(&self.1).finish()
    }
}

impl Scratch {
    fn of(&mut self, required: faer::dyn_stack::StackReq) -> &mut MemStack {
        let Scratch(memory, size) = self;
        if *size < required.size_bytes() {
            *memory = None;
            *size = required.size_bytes();
        }
        MemStack::new(memory.get_or_insert_with(|| MemBuffer::new(required)))
    }
}

impl SparseCholesky {
    /// Of a matrix given by its lower triangle; `None` if it is not positive definite.
    pub fn new(lower: &SparseColMat<usize, f64>) -> Option<SparseCholesky> {
        let mut cholesky = SparseCholesky::in_order(lower, SymmetricOrdering::Amd)?;
        cholesky.factor_again(lower).then_some(cholesky)
    }

    /// Without numbers yet, for matrices with entries at these places.
    pub fn in_order(
        lower: &SparseColMat<usize, f64>,
        order: SymmetricOrdering<usize>,
    ) -> Option<SparseCholesky> {
        let params = CholeskySymbolicParams::default();
        let places = lower.symbolic();
        let symbolic = factorize_symbolic_cholesky(places, Side::Lower, order, params).ok()?;
        let factor = vec![0.0; symbolic.len_val()];
        Some(SparseCholesky { symbolic: Arc::new(symbolic), factor })
    }

    /// Of another matrix with entries at the same places; false if it is not positive
    /// definite.
    pub fn factor_again(&mut self, lower: &SparseColMat<usize, f64>) -> bool {
        let symbolic = &self.symbolic;
        let required = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = Scratch::default();
        let factored = symbolic.factorize_numeric_llt(
            &mut self.factor,
            lower.as_ref(),
            Side::Lower,
            Default::default(),
            Par::Seq,
            memory.of(required),
            Default::default(),
        );
        factored.is_ok()
    }

    /// Replaces each of the vectors b, one after the other in memory, by A⁻¹ b.
    pub fn solve(&self, b: &mut [f64], scratch: &mut Scratch) {
        let n = self.symbolic.nrows();
        let count = b.len() / n;
        let required = self.symbolic.solve_in_place_scratch::<f64>(count, Par::Seq);
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(b, n, count),
            Par::Seq,
            scratch.of(required),
        );
    }
}
