//! The imbalance of forces, and norms of it.

use crate::algebra::packed::{dot, largest};
use crate::force::{OwnPressures, SmallestJacobian, internal_force_with};
use crate::model::Model;
use crate::model::essential::ConstraintForces;
use crate::model::following::OwnFluid;
use crate::motion::step::Buffers;

/// Nodal force over stiffness times displacement below which a body counts as free of
/// stress \[–\]: a residual relative to smaller forces would say nothing, such as that of a
/// body that has only shifted, whose forces are round-off.
const STRESS_FREE: f64 = 1e-6;

/// Forces that do not balance at some displacements.
#[derive(Debug)]
pub(crate) struct Imbalance {
    /// f_ext − f_int \[component of node\] \[N\].
    pub force: Vec<f64>,
    /// Π M⁻¹(f_ext − f_int), the acceleration that the conditions leave free
    /// \[component of node\] \[m/s²\].
    pub acceleration: Vec<f64>,
    /// Largest nodal force, external or internal, or of a body free of stress a small
    /// part of its stiffness times its displacement \[N\] (method book, eq. 20.5).
    pub scale: f64,
    pub smallest_jacobian: SmallestJacobian,
}

impl Imbalance {
    /// At displacements `u` \[m\] under the conditions and pressures of time `t` \[s\] and the
    /// external forces in `buffers`, which the pressures are added to; constraint forces are
    /// written to `forces`.
    pub fn new(
        model: &Model,
        u: &[f64],
        t: f64,
        buffers: &mut Buffers,
        forces: &mut ConstraintForces,
    ) -> Imbalance {
        Imbalance::with_pressures(model, (u, None, None), t, buffers, forces)
    }

    /// The same of patches and fluids that may have pressures of their own.
    pub fn with_pressures(
        model: &Model,
        (u, own, fluids): (&[f64], Option<&OwnPressures>, Option<&[OwnFluid]>),
        t: f64,
        buffers: &mut Buffers,
        forces: &mut ConstraintForces,
    ) -> Imbalance {
        model.following.add_force((t, fluids), u, model.components, &mut buffers.f_ext);
        let smallest_jacobian =
            internal_force_with(&model.points, u, own, &mut buffers.workspace, &mut buffers.f_int);
        let force: Vec<f64> = buffers
            .f_ext
            .iter()
            .zip(&buffers.f_int)
            .map(|(external, internal)| external - internal)
            .collect();
        let mut acceleration = model.accelerations(&force);
        model.constraints.project(t, &model.inertia, &mut acceleration, forces);
        let free_of_stress = STRESS_FREE * largest(&model.stiffness) * largest(u);
        let scale = largest(&buffers.f_int).max(largest(&buffers.f_ext)).max(free_of_stress);
        Imbalance { force, acceleration, scale, smallest_jacobian }
    }

    /// Largest free unbalanced nodal force \[N\]; NaN if there is one.
    pub fn largest(&self, model: &Model) -> f64 {
        let d = model.components;
        let free =
            self.acceleration.iter().enumerate().map(|(i, a)| (a * model.inertia[i / d]).abs());
        free.fold(0.0, |a, f| if f.is_nan() || f > a { f } else { a })
    }

    /// Largest free unbalanced nodal force over the largest nodal force \[–\].
    pub fn relative(&self, model: &Model) -> f64 {
        self.largest(model) / self.scale.max(f64::MIN_POSITIVE)
    }

    /// M Π M⁻¹(f_ext − f_int), the forces that do work on free displacements \[N\].
    pub fn free(&self, model: &Model) -> Vec<f64> {
        let d = model.components;
        self.acceleration.iter().enumerate().map(|(i, a)| a * model.inertia[i / d]).collect()
    }

    /// √(rᵀ M⁻¹ r) of the free unbalanced forces r \[N/√kg\]. Not from the full
    /// forces: the round-off of reactions would exceed it.
    pub fn norm(&self, model: &Model) -> f64 {
        dot(&self.free(model), &self.acceleration).sqrt()
    }
}
