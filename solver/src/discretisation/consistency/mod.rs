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
//!
//! For the second order, before that, gradients are changed in the same way towards
//!
//! 3. Σ_q w_q ((x_q − X_a) ⊗ (Grad φ_a + dg_qa) + φ_a I) = ∮ (x − X_a) ⊗ φ_a N dA,
//!
//! with three multipliers per node that yield a little: linear stresses are then
//! integrated nearly, and the operator is well conditioned at any size.
#![allow(non_snake_case)]

mod affine;
mod conjugate_gradients;
mod connected_bodies;
mod multilevel;
mod operator;
mod products;

pub use connected_bodies::connected_bodies;
pub use operator::Layout;

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::rows::Rows;
use crate::error::Error;
use affine::Affine;
use conjugate_gradients::{Smooth, System, norm};
use multilevel::Multilevel;
use operator::{Nodal, Operator};

/// Result of the correction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Of the conjugate gradients for condition 2.
    pub iterations: usize,
    /// The same for condition 3, if linear stresses are integrated.
    pub linear_stress_iterations: Option<usize>,
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
        if residual <= 1.0 || residual * self.defect <= ROUND_OFF {
            Ok(self)
        } else {
            Err(Error::DivergedCorrection { iterations, residual })
        }
    }
}

/// The multipliers of condition 3 yield by this fraction of the diagonal of their
/// operator \[–\]: imposed exactly, it changes gradients by 60 % and gains nothing.
const COMPLIANCE: f64 = 0.2;
/// Remaining residual of condition 3 with its compliance \[–\]; a tenth of it changes errors by less
/// than 1 %.
const LINEAR_STRESS_TOLERANCE: f64 = 3e-2;

/// What the integrals of gradients over the body should be.
#[derive(Debug)]
pub struct Targets {
    /// ∮ φ_a N dA \[node\] \[m²\].
    pub areas: Vec<Vector3>,
    /// ∮ (x − X_a) ⊗ φ_a N dA/h_a \[node\] \[m²\], if linear stresses are integrated.
    pub moments: Option<Vec<Matrix3>>,
}

/// Changes the gradients of `rows` until the residual of condition 2 has
/// fallen to `tolerance` of its first size; `bodies` are the connected body of each node.
pub fn make_consistent(
    rows: &mut Rows,
    layout: &Layout,
    targets: &Targets,
    bodies: &[u32],
    tolerance: f64,
) -> Correction {
    let areas: Vec<Nodal<1>> = targets.areas.iter().map(|area| area.transpose()).collect();
    let (operator, gradients) = Operator::new(rows, layout);
    let diagonal = operator.diagonal::<1>();
    let multilevel = Multilevel::new(&operator, layout, &diagonal);
    let affine = Affine::new(layout.nodes, bodies);
    let smooth = Smooth { multilevel: &multilevel, affine: &affine };
    let system = System::new(&operator, diagonal, 0.0, Some(smooth));
    let rest = |gradients: &[Vector3]| {
        let mut rest = difference(&areas, &operator.integrals(gradients));
        system.project(&mut rest);
        rest
    };
    let size = norm(&areas).max(f64::MIN_POSITIVE);
    let mut residual = rest(gradients);
    let first = norm(&residual);
    let moments = targets.moments.as_ref();
    let linear_stress_iterations =
        moments.map(|moments| integrate_linear_stress(&operator, moments, gradients));
    if linear_stress_iterations.is_some() {
        residual = rest(gradients);
    }
    let goal = (tolerance * first).max(1e-15 * size);
    let solution = system.solve(residual, goal);
    operator.change(&solution.multipliers, gradients);
    Correction {
        iterations: solution.iterations,
        linear_stress_iterations,
        residual: solution.residual / first.max(f64::MIN_POSITIVE),
        tolerance: goal / first.max(f64::MIN_POSITIVE),
        defect: first / size,
        bodies: affine.count,
    }
}

/// Changes gradients towards condition 3 (method book, eqs. 9.11 and 9.12); returns the number of
/// iterations.
fn integrate_linear_stress(
    operator: &Operator,
    moments: &[Matrix3],
    gradients: &mut [Vector3],
) -> usize {
    let system = System::<3>::new(operator, operator.diagonal(), COMPLIANCE, None);
    let residual = difference(moments, &operator.integrals(gradients));
    let goal = LINEAR_STRESS_TOLERANCE * norm(&residual);
    let solution = system.solve(residual, goal);
    operator.change(&solution.multipliers, gradients);
    solution.iterations
}

fn difference<const M: usize>(targets: &[Nodal<M>], reached: &[Nodal<M>]) -> Vec<Nodal<M>> {
    targets.iter().zip(reached).map(|(target, reached)| target - reached).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_worse_than_plain_ones_are_refused() {
        let with = |residual: f64, defect: f64| {
            let linear_stress_iterations = None;
            let (iterations, tolerance, bodies) = (500, 1e-3, 1);
            Correction { iterations, linear_stress_iterations, residual, tolerance, defect, bodies }
                .checked()
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
