//! The largest stable step of the tangent operator, by Lanczos.
#![allow(non_snake_case)]

use crate::internal_force::Workspace;
use crate::model::Model;
use crate::tangent::Tangent;

/// The critical step and what it cost.
#[derive(Debug, Clone, PartialEq)]
pub struct CriticalStep {
    /// 2/√λ with λ the upper end of the interval that holds the largest
    /// eigenvalue \[s\].
    pub time_step: f64,
    /// Products with the tangent operator.
    pub products: usize,
    /// The mode found \[component of node\], to start from next time.
    pub mode: Vec<f64>,
}

/// Relative width of the interval for the largest eigenvalue \[–\].
const EIGENVALUE_TOLERANCE: f64 = 5e-3;
const MOST_PRODUCTS: usize = 80;
/// Fewest products from a random start and from a known mode. A small residual
/// only tells that some eigenvalue is near; from a random start the largest of
/// n is missed by more than a share ε with a probability below
/// 1.648 √n exp(−(2k − 1)√ε) after k products (Kuczyński, Woźniakowski 1992):
/// one per cent for ε = 3 %, n = 10⁴ and k = 30, and for ε = 19 %, which a
/// safety factor of 0.9 covers, and k = 12.
const FEWEST_PRODUCTS: usize = 30;
const FEWEST_PRODUCTS_KNOWN: usize = 12;

/// The stable limit 2/√λ_max(M⁻¹K) of the tangent operator at displacements
/// `u` \[m\] under the conditions of time `t` \[s\], by Lanczos with full
/// reorthogonalisation on M^(−1/2) K M^(−1/2). The returned step belongs to
/// the Ritz value plus its residual, which is the safe side unless a mode has
/// stayed out of sight (measured on 500 random small bodies: 3, by 0.3 % at most).
pub fn critical_time_step(
    model: &Model,
    u: &[f64],
    t: f64,
    start: Option<&[f64]>,
    workspace: &mut Workspace,
) -> CriticalStep {
    let mut tangent = Tangent::new(model, u, t, workspace);
    let mut basis = vec![starting_vector(&mut tangent, start)];
    let fewest = if start.is_some() { FEWEST_PRODUCTS_KNOWN } else { FEWEST_PRODUCTS };
    let (mut diagonal, mut off_diagonal): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    loop {
        let last = basis.len() - 1;
        let mut next = tangent.apply(&basis[last]);
        diagonal.push(dot(&next, &basis[last]));
        // Twice is enough: round-off of one pass is removed by the second.
        for _ in 0..2 {
            for vector in &basis {
                let overlap = dot(&next, vector);
                axpy(&mut next, -overlap, vector);
            }
        }
        let beta = norm(&next);
        let (ritz, weights) = largest_ritz_pair(&diagonal, &off_diagonal);
        let residual = beta * weights[last].abs();
        let products = basis.len();
        let exhausted = products >= MOST_PRODUCTS.min(tangent.free_size());
        let converged = products >= fewest && residual <= EIGENVALUE_TOLERANCE * ritz;
        // The Krylov space ends where beta is nothing but round-off.
        let ended = beta.is_nan() || beta <= 1e-12 * ritz;
        if converged || exhausted || ended {
            let mode = combine(&basis, &weights, &tangent.root_mass);
            let time_step = 2.0 / (ritz + residual).sqrt();
            return CriticalStep { time_step, products, mode };
        }
        next.iter_mut().for_each(|x| *x /= beta);
        off_diagonal.push(beta);
        basis.push(next);
    }
}

/// The last mode if there is one, with some noise so that a new one is seen.
fn starting_vector(tangent: &mut Tangent, start: Option<&[f64]>) -> Vec<f64> {
    let mut seed = 0x9E37_79B9_7F4A_7C15u64;
    let mut noise = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let mut vector: Vec<f64> = tangent.root_mass.iter().map(|_| noise()).collect();
    normalise(&mut vector);
    if let Some(mode) = start {
        let mut known: Vec<f64> = mode.iter().zip(&tangent.root_mass).map(|(x, r)| x * r).collect();
        normalise(&mut known);
        vector.iter_mut().zip(&known).for_each(|(x, k)| *x = 0.1 * *x + k);
    }
    tangent.project(&mut vector);
    normalise(&mut vector);
    vector
}

/// Largest eigenvalue of the tridiagonal matrix and its unit eigenvector.
fn largest_ritz_pair(diagonal: &[f64], off_diagonal: &[f64]) -> (f64, Vec<f64>) {
    let n = diagonal.len();
    let matrix = nalgebra::DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => off_diagonal[i.min(j)],
        _ => 0.0,
    });
    let eigen = matrix.symmetric_eigen();
    let top = eigen.eigenvalues.imax();
    (eigen.eigenvalues[top], eigen.eigenvectors.column(top).iter().copied().collect())
}

fn combine(basis: &[Vec<f64>], weights: &[f64], root_mass: &[f64]) -> Vec<f64> {
    let mut mode = vec![0.0; root_mass.len()];
    for (vector, &weight) in basis.iter().zip(weights) {
        axpy(&mut mode, weight, vector);
    }
    mode.iter_mut().zip(root_mass).for_each(|(x, r)| *x /= r);
    mode
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

fn normalise(a: &mut [f64]) {
    let length = norm(a);
    if length > 0.0 {
        a.iter_mut().for_each(|x| *x /= length);
    }
}

fn axpy(y: &mut [f64], a: f64, x: &[f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}
