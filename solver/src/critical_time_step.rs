//! The largest stable step of the tangent operator, by Lanczos.
#![allow(non_snake_case)]

use crate::essential::ConstraintForces;
use crate::internal_force::{Workspace, internal_force};
use crate::model::Model;

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

/// v ↦ Π M^(−1/2) K M^(−1/2) Π v with Π the projection onto free displacements.
struct Tangent<'a> {
    model: &'a Model,
    u: &'a [f64],
    t: f64,
    workspace: &'a mut Workspace,
    /// √m per component of node \[√kg\].
    root_mass: Vec<f64>,
    /// Displacement of the difference quotient \[m\].
    amplitude: f64,
    forces: ConstraintForces,
}

impl<'a> Tangent<'a> {
    fn new(model: &'a Model, u: &'a [f64], t: f64, workspace: &'a mut Workspace) -> Tangent<'a> {
        let d = model.components;
        let root_mass =
            model.lumped_mass.iter().flat_map(|m| std::iter::repeat_n(m.sqrt(), d)).collect();
        // Small against the finest gradients: F changes by about 1e-6.
        let steepest =
            model.blocks.iter().flat_map(|b| &b.grad_phi).fold(0.0f64, |a, g| a.max(g.abs()));
        let amplitude = 1e-6 / steepest;
        Tangent {
            model,
            u,
            t,
            workspace,
            root_mass,
            amplitude,
            forces: ConstraintForces::default(),
        }
    }

    fn free_size(&self) -> usize {
        let fixed: usize =
            self.model.constraints.active(self.t).iter().map(|set| set.rows.len()).sum();
        self.model.size().saturating_sub(fixed).max(1)
    }

    /// Removes what the conditions forbid from M^(1/2) u.
    fn project(&mut self, vector: &mut [f64]) {
        vector.iter_mut().zip(&self.root_mass).for_each(|(x, r)| *x /= r);
        self.model.constraints.project(self.t, &self.model.lumped_mass, vector, &mut self.forces);
        vector.iter_mut().zip(&self.root_mass).for_each(|(x, r)| *x *= r);
    }

    /// K v as a central difference of the internal force.
    fn apply(&mut self, vector: &[f64]) -> Vec<f64> {
        let direction: Vec<f64> = vector.iter().zip(&self.root_mass).map(|(x, r)| x / r).collect();
        let largest = direction.iter().fold(0.0f64, |a, x| a.max(x.abs()));
        let epsilon = self.amplitude / largest.max(f64::MIN_POSITIVE);
        let mut moved = vec![0.0; self.u.len()];
        let (mut plus, mut minus) = (vec![0.0; self.u.len()], vec![0.0; self.u.len()]);
        for (sign, f) in [(epsilon, &mut plus), (-epsilon, &mut minus)] {
            for ((x, u), v) in moved.iter_mut().zip(self.u).zip(&direction) {
                *x = u + sign * v;
            }
            internal_force(self.model, &moved, self.workspace, f);
        }
        for ((p, m), r) in plus.iter_mut().zip(&minus).zip(&self.root_mass) {
            *p = (*p - m) / (2.0 * epsilon * r);
        }
        self.project(&mut plus);
        plus
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
