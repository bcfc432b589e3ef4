//! How far apart points should be.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;

/// Requested distance of neighbouring points \[m\] and its bounds.
pub(crate) struct TargetSpacing<'a> {
    pub at: &'a (dyn Fn(&Vector3) -> f64 + Sync),
    pub smallest: f64,
    pub largest: f64,
}

impl TargetSpacing<'_> {
    pub(super) fn uniform(&self) -> bool {
        self.smallest == self.largest
    }
}

/// Number of cells of about `spacing` in a length, at least one; the larger one of two that fit
/// equally well but for round-off.
pub(crate) fn lattice_cells(length: f64, spacing: f64) -> usize {
    (length / spacing + 1e-9).round().max(1.0) as usize
}
