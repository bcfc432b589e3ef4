//! What may watch a run.

use crate::algebra::tensor::Vector3;
use crate::model::Model;
use crate::model::essential::Reaction;
use crate::motion::energy::{Energies, energies};
use crate::motion::state::State;
use crate::motion::step::Buffers;

/// A run, seen after a step. Nothing is computed until it is asked for.
pub struct View<'a> {
    pub model: &'a Model,
    pub state: &'a State,
    pub(crate) buffers: &'a mut Buffers,
    /// Smallest J over all quadrature points, before the last step \[–\].
    pub smallest_jacobian: f64,
    /// Share of the run that is done \[–\].
    pub progress: f64,
}

impl View<'_> {
    /// Energies half a step ago; two passes over the quadrature points.
    pub fn energies(&mut self) -> Energies {
        energies(self.model, self.state, &mut self.buffers.workspace)
    }

    /// Force and moment about `about` \[m\] that each condition exerts on the
    /// body, in the order of the problem's conditions.
    pub fn reactions(&self, about: &Vector3) -> Vec<Reaction> {
        let (model, state) = (self.model, self.state);
        model.constraints.reactions(
            &state.constraint_forces,
            state.force_factor,
            about,
            &model.positions,
            &state.displacement,
        )
    }
}

/// Whether a run goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Continue {
    Yes,
    /// The run ends here, complete up to this step.
    Stop,
}

/// Watches a run. What it has recorded stays with it if the run fails.
pub trait Observer {
    /// Called once before the first step and after every step.
    fn observe(&mut self, view: &mut View) -> Continue;

    /// Whether work is to be kept up, for an energy balance.
    fn tracks_work(&self) -> bool {
        false
    }
}

/// An observer that looks at nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn observe(&mut self, _view: &mut View) -> Continue {
        Continue::Yes
    }
}
