//! Where a point of the deformed space came from.
#![allow(non_snake_case)]

use super::field::DisplacementField;
use mtled::algebra::tensor::{Matrix3, Vector3};

/// The largest |X + u(X) − x| of a source that was found \[m\].
pub const TOLERANCE: f64 = 1e-7;

/// Iterations after which a point counts as one without a source.
pub(crate) const MOST_ITERATIONS: usize = 200;

/// Evaluations of the field after which secants are given up.
const MOST_SECANTS: usize = 30;

/// Secants are given up where a step s changes g, seen through the inverse, by less than this
/// part of s along s \[–\].
const SMALLEST_SLOPE: f64 = 0.05;

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
    /// An estimate of ∂X/∂x there.
    pub inverse: Matrix3,
}

/// Solves g = X − x + u(X) = 0 by the secant method of Broyden 1965, eq. 4.5, from
/// X − x = `start` and an estimate `inverse` of ∂X/∂x; where it fails, such as near folds, from
/// its best iterate by the fixed point of X = x − u(X), with shorter steps where the residual
/// grows. Where that does not converge either, this is the iterate with the smallest residual.
/// Where the field decays so fast that a place may have a second source, one in the body counts.
pub fn source_of(
    field: &DisplacementField,
    x: &Vector3,
    start: &Vector3,
    inverse: Matrix3,
) -> Source {
    let found = solve(&|vector| field.at(&(x + vector)) + vector, start, inverse);
    if field.may_fold() && field.distance_outside(&(x + found.vector)) > 0.0 {
        return in_body(field, x).unwrap_or(found);
    }
    found
}

/// The source in the body, if there is one: what has moved to a place has driven out what was
/// there.
fn in_body(field: &DisplacementField, x: &Vector3) -> Option<Source> {
    if field.distance_outside(x) > field.largest_displacement {
        return None;
    }
    let gap = |vector: &Vector3| field.at_nearest(&(x + vector)) + vector;
    let found = solve(&gap, &-field.at_nearest(x), Matrix3::identity());
    let is_inside = field.distance_outside(&(x + found.vector)) <= TOLERANCE;
    (found.residual <= TOLERANCE && is_inside).then_some(found)
}

fn solve(gap: &impl Fn(&Vector3) -> Vector3, start: &Vector3, inverse: Matrix3) -> Source {
    let best = by_secants(gap, start, inverse);
    if best.residual <= TOLERANCE { best } else { by_fixed_point(gap, best) }
}

fn by_secants(gap: &impl Fn(&Vector3) -> Vector3, start: &Vector3, mut inverse: Matrix3) -> Source {
    let (mut vector, mut g) = (*start, gap(start));
    let mut best = Source { vector, residual: g.norm(), iterations: 1, inverse };
    while best.residual > TOLERANCE && best.iterations < MOST_SECANTS {
        let step = -inverse * g;
        vector += step;
        let before = std::mem::replace(&mut g, gap(&vector));
        let residual = g.norm();
        let iterations = best.iterations + 1;
        if residual >= best.residual {
            return Source { iterations, ..best };
        }
        best = Source { vector, residual, iterations, inverse };
        let moved = inverse * (g - before);
        let along = step.dot(&moved);
        if along.abs() < SMALLEST_SLOPE * step.norm_squared() {
            return best;
        }
        inverse += (step - moved) * (step.transpose() * inverse) / along;
        best.inverse = inverse;
    }
    best
}

fn by_fixed_point(gap: &impl Fn(&Vector3) -> Vector3, start: Source) -> Source {
    let (mut vector, mut best) = (start.vector, start);
    let (mut step, mut last) = (1.0f64, f64::INFINITY);
    for iterations in start.iterations + 1..=MOST_ITERATIONS {
        let g = gap(&vector);
        let residual = g.norm();
        if residual < best.residual {
            best = Source { vector, residual, iterations, inverse: Matrix3::identity() };
        }
        if residual <= TOLERANCE {
            return best;
        }
        if residual > last {
            step = (0.5 * step).max(SMALLEST_STEP);
        }
        last = residual;
        vector -= g * step;
    }
    Source { iterations: MOST_ITERATIONS, ..best }
}
