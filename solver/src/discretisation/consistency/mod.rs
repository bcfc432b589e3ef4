//! Consistent gradients: Grad φ changed as little as possible until the
//! divergence theorem holds for every node (method book, section 9).
//!
//! Find the smallest change dg, min Σ_q w_q Σ_a |dg_qa|²/W_qa, such that
//!
//! 1. at every point Σ_a dg_qa = 0 and Σ_a X_a ⊗ dg_qa = 0 (linear fields
//!    keep their gradient), and
//! 2. for every node Σ_q w_q (Grad φ_a + dg_qa) = ∮ φ_a N dA.
//!
//! With one multiplier λ_a per node the change is dg_qa = W_qa (λ_a − c_q(X_a)),
//! c_q the affine fit of λ at point q in the metric W, and 2. becomes a
//! symmetric system K λ = r, singular for affine λ only.
#![allow(non_snake_case)]

mod affine;
mod connected_bodies;
mod lattice;
mod multilevel;
mod operator;

pub use connected_bodies::connected_bodies;
pub use operator::Layout;

use crate::algebra::tensor::Vector3;
use crate::discretisation::rows::Rows;
use crate::error::Error;
use affine::Affine;
use multilevel::Multilevel;
use operator::Operator;

/// Result of the correction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Of the conjugate gradients.
    pub iterations: usize,
    /// Residual of condition 2 over that of the plain gradients \[–\].
    pub residual: f64,
    /// The requested residual, or the smallest that round-off allows \[–\].
    pub tolerance: f64,
    /// The plain gradients' residual over the size of the targets \[–\].
    pub defect: f64,
    /// Number of connected bodies.
    pub bodies: usize,
}

/// Inconsistencies below this fraction of the targets are round-off \[–\].
const ROUND_OFF: f64 = 1e-12;

impl Correction {
    /// Itself, unless the gradients are worse than plain ones: the critical step of
    /// such a discretisation may be so small that no run ends.
    pub fn checked(self) -> Result<Correction, Error> {
        let Correction { iterations, residual, .. } = self;
        match residual <= 1.0 || residual * self.defect <= ROUND_OFF {
            true => Ok(self),
            false => Err(Error::DivergedCorrection { iterations, residual }),
        }
    }
}

/// Largest number of iterations.
const MOST_ITERATIONS: usize = 500;

/// Changes the gradients of `rows` until the residual of condition 2 has
/// fallen to `tolerance` of its first size; `targets` are ∮ φ_a N dA \[node\]
/// \[m²\], `bodies` the connected body of each node.
pub fn make_consistent(
    rows: &mut Rows,
    layout: &Layout,
    targets: &[Vector3],
    bodies: &[u32],
    tolerance: f64,
) -> Correction {
    let mut residual = targets.to_vec();
    for (q, weight) in layout.weights.iter().enumerate() {
        for entry in rows.row(q) {
            residual[rows.nodes[entry] as usize] -= *weight * rows.grad_phi[entry];
        }
    }
    let (operator, gradients) = Operator::new(rows, layout);
    let preconditioner = Multilevel::new(&operator, layout);
    let affine = Affine::new(layout.nodes, bodies);
    affine.project(&mut residual);
    let size = norm(targets).max(f64::MIN_POSITIVE);
    let first = norm(&residual);
    let goal = (tolerance * first).max(1e-15 * size);
    let (multipliers, iterations, last) =
        solve(&operator, &preconditioner, &affine, residual, goal);
    operator.change(&multipliers, gradients);
    Correction {
        iterations,
        residual: last / first.max(f64::MIN_POSITIVE),
        tolerance: goal / first.max(f64::MIN_POSITIVE),
        defect: first / size,
        bodies: affine.count,
    }
}

/// Preconditioned conjugate gradients on the three components at once.
fn solve(
    operator: &Operator,
    preconditioner: &Multilevel,
    affine: &Affine,
    mut residual: Vec<Vector3>,
    goal: f64,
) -> (Vec<Vector3>, usize, f64) {
    let mut solution = vec![Vector3::zeros(); residual.len()];
    let mut size = norm(&residual);
    let mut direction = preconditioner.apply(&residual);
    affine.project(&mut direction);
    let mut energy = dot(&residual, &direction);
    let mut iterations = 0;
    while size > goal && iterations < MOST_ITERATIONS {
        let image = operator.apply(&direction);
        let step = ratio(&energy, &dot(&direction, &image));
        for ((x, r), (d, k)) in
            solution.iter_mut().zip(&mut residual).zip(direction.iter().zip(&image))
        {
            *x += step.component_mul(d);
            *r -= step.component_mul(k);
        }
        affine.project(&mut residual);
        size = norm(&residual);
        let mut next = preconditioner.apply(&residual);
        affine.project(&mut next);
        let after = dot(&residual, &next);
        let factor = ratio(&after, &energy);
        for (d, z) in direction.iter_mut().zip(&next) {
            *d = z + factor.component_mul(d);
        }
        energy = after;
        iterations += 1;
    }
    (solution, iterations, size)
}

fn norm(field: &[Vector3]) -> f64 {
    field.iter().map(|value| value.norm_squared()).sum::<f64>().sqrt()
}

/// Component by component.
fn dot(a: &[Vector3], b: &[Vector3]) -> Vector3 {
    a.iter().zip(b).map(|(a, b)| a.component_mul(b)).sum()
}

/// a/b by component, 0 where b is.
fn ratio(a: &Vector3, b: &Vector3) -> Vector3 {
    a.zip_map(b, |a, b| if b > 0.0 { a / b } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_worse_than_plain_ones_are_refused() {
        let with = |residual: f64, defect: f64| {
            Correction { iterations: 500, residual, tolerance: 1e-3, defect, bodies: 1 }.checked()
        };
        assert!(with(1.0, 0.1).is_ok());
        assert!(with(3.0, 1e-14).is_ok(), "round-off");
        for worse in [2e10, f64::NAN] {
            let error = with(worse, 0.1).unwrap_err();
            assert!(matches!(error, Error::DivergedCorrection { iterations: 500, .. }));
            assert!(error.to_string().contains("use more cells per spacing"), "{error}");
        }
    }
}
