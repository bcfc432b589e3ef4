//! Products with the tangent operator K = ∂f_int/∂u, without a matrix.
#![allow(non_snake_case)]

use crate::essential::ConstraintForces;
use crate::internal_force::{Workspace, internal_force};
use crate::model::Model;

/// v ↦ Π M^(−1/2) K M^(−1/2) Π v with Π the projection onto free displacements.
pub(crate) struct Tangent<'a> {
    model: &'a Model,
    u: &'a [f64],
    t: f64,
    workspace: &'a mut Workspace,
    /// √m per component of node \[√kg\].
    pub root_mass: Vec<f64>,
    /// Displacement of the difference quotient \[m\].
    amplitude: f64,
    /// f_int(u) \[N\].
    base: Vec<f64>,
    forces: ConstraintForces,
}

impl<'a> Tangent<'a> {
    pub fn new(
        model: &'a Model,
        u: &'a [f64],
        t: f64,
        workspace: &'a mut Workspace,
    ) -> Tangent<'a> {
        let mut base = vec![0.0; model.size()];
        internal_force(model, u, workspace, &mut base);
        Tangent::with_force(model, u, t, base, workspace)
    }

    /// As [`Tangent::new`] where f_int(u) \[N\] is known.
    pub fn with_force(
        model: &'a Model,
        u: &'a [f64],
        t: f64,
        base: Vec<f64>,
        workspace: &'a mut Workspace,
    ) -> Tangent<'a> {
        let d = model.components;
        let root_mass =
            model.inertia.iter().flat_map(|m| std::iter::repeat_n(m.sqrt(), d)).collect();
        // Small against the finest gradients: F changes by about 1e-7.
        let amplitude = 1e-7 / model.steepest;
        Tangent {
            model,
            u,
            t,
            workspace,
            root_mass,
            amplitude,
            base,
            forces: ConstraintForces::default(),
        }
    }

    pub fn free_size(&self) -> usize {
        let fixed: usize =
            self.model.constraints.active(self.t).iter().map(|set| set.rows.len()).sum();
        self.model.size().saturating_sub(fixed).max(1)
    }

    /// Removes what the conditions forbid from M^(1/2) u.
    pub fn project(&mut self, vector: &mut [f64]) {
        vector.iter_mut().zip(&self.root_mass).for_each(|(x, r)| *x /= r);
        self.model.constraints.project(self.t, &self.model.inertia, vector, &mut self.forces);
        vector.iter_mut().zip(&self.root_mass).for_each(|(x, r)| *x *= r);
    }

    /// The scaled product, projected.
    pub fn apply(&mut self, vector: &[f64]) -> Vec<f64> {
        let direction: Vec<f64> = vector.iter().zip(&self.root_mass).map(|(x, r)| x / r).collect();
        let mut product = self.stiffness_times(&direction);
        product.iter_mut().zip(&self.root_mass).for_each(|(p, r)| *p /= r);
        self.project(&mut product);
        product
    }

    /// K v \[N\] as a difference of the internal force, not projected. The
    /// change of F by 1e-7 makes the quotient true to about as much.
    pub fn stiffness_times(&mut self, direction: &[f64]) -> Vec<f64> {
        let largest = direction.iter().fold(0.0f64, |a, x| a.max(x.abs()));
        let epsilon = self.amplitude / largest.max(f64::MIN_POSITIVE);
        let moved: Vec<f64> = self.u.iter().zip(direction).map(|(u, v)| u + epsilon * v).collect();
        let mut product = vec![0.0; self.u.len()];
        internal_force(self.model, &moved, self.workspace, &mut product);
        product.iter_mut().zip(&self.base).for_each(|(f, base)| *f = (*f - base) / epsilon);
        product
    }
}
