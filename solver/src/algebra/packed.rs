//! Fields packed into one vector \[component of node\].

use rayon::prelude::*;

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// y += a x.
pub(crate) fn axpy(y: &mut [f64], a: f64, x: &[f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}

/// Largest absolute value of the entries; 0 if there are none.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0f64, |a, x| a.max(x.abs()))
}

/// Components processed together, few enough to stay in the first cache.
const PIECE: usize = 1024;

/// Removes from a vector its components along an orthonormal basis.
pub(crate) fn orthogonalise(vector: &mut [f64], basis: &[Vec<f64>]) {
    make_orthogonal(vector, basis, basis);
}

/// Removes from a vector its components along a basis b that is orthonormal in a mass M, from the
/// vectors M b. Twice is
/// enough: round-off of one pass is removed by the second. Overlaps are summed piece
/// by piece, in the order of the pieces on any number of threads.
pub(crate) fn make_orthogonal(vector: &mut [f64], basis: &[Vec<f64>], masses: &[Vec<f64>]) {
    let pass = |vector: &mut [f64], known: &[f64]| -> Vec<f64> {
        let piece = |(index, piece): (usize, &mut [f64])| {
            let range = index * PIECE..index * PIECE + piece.len();
            for (factor, basis) in known.iter().zip(basis) {
                axpy(piece, -factor, &basis[range.clone()]);
            }
            masses.iter().map(|mass| overlap(piece, &mass[range.clone()])).collect()
        };
        let pieces: Vec<Vec<f64>> = vector.par_chunks_mut(PIECE).enumerate().map(piece).collect();
        (0..basis.len()).map(|i| pieces.iter().map(|piece| piece[i]).sum()).collect()
    };
    let first = pass(vector, &[]);
    let second = pass(vector, &first);
    for (factor, basis) in second.iter().zip(basis) {
        axpy(vector, -factor, basis);
    }
}

/// The dot product in eight sums, which need not wait for each other.
pub(crate) fn overlap(a: &[f64], b: &[f64]) -> f64 {
    let (a, a_rest) = a.as_chunks::<8>();
    let (b, b_rest) = b.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        (0..8).for_each(|lane| sums[lane] += a[lane] * b[lane]);
    }
    sums.iter().sum::<f64>() + dot(a_rest, b_rest)
}

/// Σ w v of vectors, of which there is at least one.
pub(crate) fn combine(basis: &[Vec<f64>], weights: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; basis[0].len()];
    for (vector, &weight) in basis.iter().zip(weights) {
        axpy(&mut sum, weight, vector);
    }
    sum
}

/// √(a · a).
pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Scales a vector to norm 1, unless it is 0.
pub(crate) fn normalise(a: &mut [f64]) {
    let length = norm(a);
    if length > 0.0 {
        a.iter_mut().for_each(|x| *x /= length);
    }
}
