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

/// Lengths that differ by less are equal but for round-off \[spacing\].
const TIE: f64 = 1e-6;

/// Number of cells of about `spacing` in a length, at least one.
pub(crate) fn lattice_cells(length: f64, spacing: f64) -> usize {
    nearest_count(length / spacing)
}

/// Number of parts, at least one, in which a length of so many spacings is divided; the larger one
/// of two that fit equally well but for round-off.
pub(crate) fn nearest_count(spacings: f64) -> usize {
    (spacings + TIE).round().max(1.0) as usize
}
