//! Products with the tangent operator K = ∂f_int/∂u, without a matrix.
#![allow(non_snake_case)]

use crate::algebra::block_matrix::BlockMatrix;
use crate::force::{
    Block, Chunk, ChunkTangent, OwnPressures, Workspace, for_each_chunk, linearise,
    linearised_stiffness_times,
};
use crate::model::essential::ConstraintForces;
use crate::model::following::{FollowingTangent, OwnFluid};
use crate::model::{Following, Model};

/// v ↦ Π M^(−1/2) K M^(−1/2) Π v with Π the projection onto free displacements.
pub(crate) struct Tangent<'a> {
    model: &'a Model,
    u: &'a [f64],
    t: f64,
    own: Option<OwnPressures>,
    following: Option<FollowingTangent<'a>>,
    workspace: &'a mut Workspace,
    /// √m per component of node \[√kg\].
    pub root_mass: Vec<f64>,
    forces: ConstraintForces,
}

impl<'a> Tangent<'a> {
    pub fn new(
        model: &'a Model,
        u: &'a [f64],
        t: f64,
        workspace: &'a mut Workspace,
    ) -> Tangent<'a> {
        let d = model.components;
        let root_mass =
            model.inertia.iter().flat_map(|m| std::iter::repeat_n(m.sqrt(), d)).collect();
        linearise(&model.points, u, workspace);
        let forces = ConstraintForces::default();
        let Model { following: loads, components, .. } = model;
        let of_loads = || FollowingTangent::new(loads, (t, None), u, *components);
        let following = (!loads.is_empty()).then(of_loads);
        Tangent { model, u, t, own: None, following, workspace, root_mass, forces }
    }

    /// Of patches with pressures of their own.
    pub fn with_pressures(self, own: Option<OwnPressures>) -> Tangent<'a> {
        Tangent { own, ..self }
    }

    /// Of fluids with pressures of their own.
    pub fn with_fluids(self, fluids: Option<&[OwnFluid]>) -> Tangent<'a> {
        if fluids.is_none() {
            return self;
        }
        let Model { following: loads, components, .. } = self.model;
        let own = FollowingTangent::new(loads, (self.t, fluids), self.u, *components);
        Tangent { following: Some(own), ..self }
    }

    pub fn model(&self) -> &'a Model {
        self.model
    }

    pub fn free_size(&self) -> usize {
        self.model.size().saturating_sub(self.model.constraints.count(self.t)).max(1)
    }

    /// Removes what the conditions forbid from M^(1/2) u.
    pub fn project(&mut self, vector: &mut [f64]) {
        vector.iter_mut().zip(&self.root_mass).for_each(|(x, r)| *x /= r);
        self.model.constraints.project(self.t, &self.model.inertia, vector, &mut self.forces);
        vector.iter_mut().zip(&self.root_mass).for_each(|(x, r)| *x *= r);
    }

    /// The scaled product of all that resists, projected.
    pub fn apply(&mut self, vector: &[f64]) -> Vec<f64> {
        let direction: Vec<f64> = vector.iter().zip(&self.root_mass).map(|(x, r)| x / r).collect();
        let mut product = self.internal_stiffness_times(&direction);
        if let Some(loads) = self.following.as_ref().filter(|_| self.model.following.is_stiff()) {
            let mut stiff = vec![0.0; self.u.len()];
            loads.add_stiff_part_times(&direction, &mut stiff);
            product.iter_mut().zip(&stiff).for_each(|(p, f)| *p -= f);
        }
        product.iter_mut().zip(&self.root_mass).for_each(|(p, r)| *p /= r);
        self.project(&mut product);
        product
    }

    /// K v \[N\] less the stiffness of loads, of which a symmetric part counts; not projected.
    pub fn stiffness_times(&mut self, direction: &[f64]) -> Vec<f64> {
        self.times(Following::Symmetric, direction)
    }

    /// (K less all of the stiffness of loads)ᵀ v \[N\], not projected.
    pub fn transposed_times(&mut self, direction: &[f64]) -> Vec<f64> {
        self.times(Following::Transposed, direction)
    }

    fn times(&mut self, part: Following, direction: &[f64]) -> Vec<f64> {
        let mut product = self.internal_stiffness_times(direction);
        if let Some(loads) = &mut self.following {
            let mut following = vec![0.0; self.u.len()];
            loads.add_times(direction, part, &mut following);
            product.iter_mut().zip(&following).for_each(|(p, f)| *p -= f);
        }
        product
    }

    /// As [`Tangent::stiffness_times`] with the slopes of the patches' own pressures, and the
    /// slopes of their volumes along the direction, four a patch.
    pub fn saddle_times(&mut self, direction: &[f64], slopes: &[f64]) -> (Vec<f64>, Vec<f64>) {
        if let Some(own) = &mut self.own {
            own.set_slopes(slopes);
        }
        let product = self.stiffness_times(direction);
        (product, self.workspace.patches().flat_map(|patch| patch.volume).collect())
    }

    /// Visits the tangents of all chunks, at fixed pressures where patches have their own but for the
    /// part that J gives at once.
    pub fn for_each_chunk(&mut self, visit: impl FnMut(&Block, &Chunk, &ChunkTangent)) {
        for_each_chunk(&self.model.points, self.own.as_ref(), self.workspace, visit);
    }

    /// The stiffness of pressures that turn with the surface \[N/m\], which is taken from that of the
    /// body.
    pub fn turning(&mut self) -> Option<&BlockMatrix> {
        self.following.as_mut().map(FollowingTangent::turning)
    }

    fn internal_stiffness_times(&mut self, direction: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; self.u.len()];
        linearised_stiffness_times(
            &self.model.points,
            direction,
            self.own.as_ref(),
            self.workspace,
            &mut product,
        );
        product
    }
}
