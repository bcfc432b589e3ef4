//! Where a point of the deformed space came from.
#![allow(non_snake_case)]

use super::field::DisplacementField;
use mtled::algebra::tensor::Vector3;

/// The largest |X + u(X) − x| of a source that was found \[m\].
pub const TOLERANCE: f64 = 1e-7;

/// Iterations after which a point counts as one without a source.
pub const MOST_ITERATIONS: usize = 200;

/// The smallest part of a correction that is made where corrections grow \[–\].
const SMALLEST_STEP: f64 = 0.125;

/// The place X that moved to x, as a vector from x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// X − x \[m\]
    pub vector: Vector3,
    /// |X + u(X) − x| \[m\]; above [`TOLERANCE`] where none was found.
    pub residual: f64,
    /// Evaluations of the field.
    pub iterations: usize,
}

/// Solves X + u(X) = x by the fixed point of X = x − u(X), from X − x = `start`, with shorter
/// steps where the residual grows. Where it does not converge, such as in folds, this is the
/// iterate with the smallest residual.
pub fn source_of(field: &DisplacementField, x: &Vector3, start: &Vector3) -> Source {
    let mut vector = *start;
    let mut best = Source { vector, residual: f64::INFINITY, iterations: 0 };
    let (mut step, mut last) = (1.0f64, f64::INFINITY);
    for iterations in 1..=MOST_ITERATIONS {
        let correction = -field.at(&(x + vector)) - vector;
        let residual = correction.norm();
        if residual < best.residual {
            best = Source { vector, residual, iterations };
        }
        if residual <= TOLERANCE {
            return best;
        }
        if residual > last {
            step = (0.5 * step).max(SMALLEST_STEP);
        }
        last = residual;
        vector += correction * step;
    }
    Source { iterations: MOST_ITERATIONS, ..best }
}
