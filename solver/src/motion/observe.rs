//! Observers of a run.

use crate::algebra::tensor::Vector3;
use crate::model::essential::Reaction;
use crate::model::{CavityState, Model};
use crate::motion::energy::{Energies, Momenta, energies, momenta};
use crate::motion::state::State;

/// A run after a step, as an observer sees it; energies and reactions are computed
/// on request.
pub struct View<'a> {
    /// What stays constant.
    pub model: &'a Model,
    /// What has evolved.
    pub state: &'a State,
    /// Smallest J over all quadrature points, before the last step \[–\].
    pub smallest_jacobian: f64,
    /// Completed fraction of the run \[–\].
    pub progress: f64,
}

impl View<'_> {
    /// Energies half a step ago; two passes over the quadrature points.
    pub fn energies(&self) -> Energies {
        energies(self.model, self.state)
    }

    /// Momenta half a step ago, the angular one about `about` \[m\].
    pub fn momenta(&self, about: &Vector3) -> Momenta {
        momenta(self.model, self.state, about)
    }

    /// Force and moment about `about` \[m\] that each condition exerts on the
    /// body, in the order of the problem's conditions.
    pub fn reactions(&self, about: &Vector3) -> Vec<Reaction> {
        self.state.reactions(self.model, about)
    }

    /// Volume and pressure of each cavity, in the order of the problem's.
    pub fn cavities(&self) -> Vec<CavityState> {
        let (t, u) = (self.state.time, &self.state.displacement);
        let cavities = self.model.following.cavities.iter();
        cavities.map(|cavity| cavity.state(t, u, self.model.components)).collect()
    }

    /// What the springs exert on the body \[N\], in the order of the problem's.
    pub fn spring_forces(&self) -> Vec<Vector3> {
        let u = &self.state.displacement;
        let springs = self.model.following.springs.iter();
        springs.map(|spring| spring.resultant(u, self.model.components)).collect()
    }
}

/// Whether a run continues.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Continue {
    /// It does.
    Yes,
    /// The run ends here, complete up to this step.
    Stop,
}

/// Observes a run. Its records stay valid if the run fails.
pub trait Observer {
    /// Called once before the first step and after every step.
    fn observe(&mut self, view: &mut View) -> Continue;

    /// Called within an iteration whose states are no solutions yet, with the completed
    /// fraction of the run \[–\] and the number of corrections.
    fn iterate(&mut self, _progress: f64, _corrections: usize) -> Continue {
        Continue::Yes
    }

    /// The next time \[s\] at which a motion is to have a state: steps end there. None where
    /// any step will do; a time that has passed counts as none.
    fn awaited_time(&self) -> Option<f64> {
        None
    }

    /// Called after a step of a motion. Where it is true the run goes on as one does that is
    /// continued from this state, bit for bit.
    fn checkpoint(&mut self, _view: &View) -> bool {
        false
    }

    /// Called where a run begins again from its first state by another method.
    fn restart(&mut self) {}

    /// Whether the run accumulates work, for an energy balance.
    fn tracks_work(&self) -> bool {
        false
    }
}

/// An observer that does nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn observe(&mut self, _view: &mut View) -> Continue {
        Continue::Yes
    }
}

/// Notifies the observer of the present state.
pub(crate) fn notify(
    model: &Model,
    state: &State,
    smallest_jacobian: f64,
    progress: f64,
    observer: &mut dyn Observer,
) -> Continue {
    observer.observe(&mut View { model, state, smallest_jacobian, progress })
}
