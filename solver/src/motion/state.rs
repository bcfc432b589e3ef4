//! The state of a run.

use crate::algebra::tensor::{Vector3, vector_at};
use crate::force::{Workspace, internal_force};
use crate::model::Model;
use crate::model::contact::{ContactForce, ContactState};
use crate::model::essential::{ConstraintForces, Reaction};
use crate::motion::extra_stress::ExtraState;

/// Displacements and velocities at one instant, and the work so far.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct State {
    /// Number of steps.
    pub step: usize,
    /// \[s\]
    pub time: f64,
    /// Nodal parameters u(t) \[component of node\] \[m\].
    pub displacement: Vec<f64>,
    /// Velocity at t − Δt/2 \[component of node\] \[m/s\].
    pub velocity: Vec<f64>,
    /// The last time step \[s\]; 0 at the start.
    pub time_step: f64,
    /// Factor from multipliers m Δu of the last step to forces \[1/s²\].
    pub force_factor: f64,
    /// Multipliers of the last step.
    pub constraint_forces: ConstraintForces,
    #[serde(skip)]
    pub(crate) residual_scratch: ConstraintForces,
    /// Nodes in contact.
    pub contact: ContactState,
    /// Stresses beside those of the laws.
    pub extra: ExtraState,
    /// Work so far.
    pub work: Work,
}

/// Work up to t − Δt/2 \[J\]; accumulated on request only.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Work {
    /// Kinetic energy at the start of the motion.
    pub start: f64,
    /// By body forces and tractions.
    pub external: f64,
    /// By prescribed displacements and by contact.
    pub constraint: f64,
    /// Dissipated by damping.
    pub damping: f64,
    /// Done against viscous branches, less what active fibres have done; up to t − Δt.
    pub extra: f64,
}

/// ½ Σ m v² \[J\].
pub(crate) fn kinetic_energy(model: &Model, velocity: &[f64]) -> f64 {
    let nodes = velocity.chunks(model.components);
    let of_node = |(mass, v): (&f64, &[f64])| 0.5 * mass * v.iter().map(|v| v * v).sum::<f64>();
    model.inertia.iter().zip(nodes).map(of_node).sum()
}

impl State {
    /// At rest in the reference configuration, or with the initial velocity.
    pub fn new(model: &Model) -> State {
        State {
            step: 0,
            time: 0.0,
            displacement: vec![0.0; model.size()],
            velocity: model.initial_velocity.clone(),
            time_step: 0.0,
            force_factor: 0.0,
            constraint_forces: ConstraintForces::default(),
            residual_scratch: ConstraintForces::default(),
            contact: ContactState::default(),
            extra: ExtraState::new(model),
            work: Work { start: kinetic_energy(model, &model.initial_velocity), ..Work::default() },
        }
    }

    /// A copy but for the multipliers, which the next step finds again.
    pub(crate) fn copy(&self) -> State {
        State {
            displacement: self.displacement.clone(),
            velocity: self.velocity.clone(),
            constraint_forces: ConstraintForces::default(),
            residual_scratch: ConstraintForces::default(),
            contact: self.contact.clone(),
            extra: self.extra.clone(),
            ..*self
        }
    }

    /// What keeps it from being a state of a model, if anything does: how many numbers it has and the
    /// model needs.
    pub fn misfit(&self, model: &Model) -> Option<(usize, usize)> {
        let (sizes, size) = ([self.displacement.len(), self.velocity.len()], model.size());
        let wrong = sizes.into_iter().find(|found| *found != size).map(|found| (found, size));
        wrong.or_else(|| self.extra.misfit(model))
    }

    /// Has the extra stresses remember a static equilibrium.
    pub(crate) fn remember(&mut self, model: &Model, workspace: &mut Workspace) {
        self.extra.act(model, self.time, workspace);
        internal_force(&model.points, &self.displacement, workspace, &mut vec![0.0; model.size()]);
        let work = self.extra.remember(model, self.time, workspace);
        self.work.extra += work;
        // The work of conditions and contact is what closes the balance of a static run.
        self.work.constraint += work;
    }

    /// Scratch memory for forces and products with the extra stresses of this state.
    pub fn workspace(&self, model: &Model) -> Workspace {
        let mut workspace = Workspace::new(&model.points);
        self.extra.act(model, self.time, &mut workspace);
        workspace
    }

    /// Force \[N\] and moment about `about` \[m\] that each condition exerts on the body, in
    /// the order of the problem's conditions.
    pub fn reactions(&self, model: &Model, about: &Vector3) -> Vec<Reaction> {
        let (forces, factor) = (&self.constraint_forces, self.force_factor);
        let (positions, u) = (&model.positions, &self.displacement);
        model.constraints.reactions(forces, factor, about, positions, u)
    }

    /// What obstacles exert on nodes \[N\]: on values of the displacement in Newton's method, on
    /// parameters in explicit steps. In a motion they are those of the last step, which jump
    /// from step to step.
    pub fn contact_forces(&self) -> Vec<ContactForce> {
        let force = |force: &ContactForce| ContactForce {
            force: self.force_factor * force.force,
            ..*force
        };
        self.contact.forces.iter().map(force).collect()
    }

    /// Nodal parameter of a node as a vector; z is 0 in a plane \[m\].
    pub fn displacement_of(&self, node: usize, components: usize) -> Vector3 {
        vector_at(&self.displacement, node, components)
    }
}
