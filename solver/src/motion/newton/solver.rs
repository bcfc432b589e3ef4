//! What Newton's method has at hand at every fraction of the load.

use super::active_contacts::ActiveContacts;
use super::conjugate_gradients::Solver as LinearSolver;
use super::free_space::FreeSpace;
use super::load_path::Path;
use crate::model::Model;
use crate::model::rigid_motions::rigid_motions_left_to_contact;
use crate::motion::balance::Imbalance;
use crate::motion::internal_force::SmallestJacobian;
use crate::motion::state::State;
use crate::motion::step::Buffers;
use crate::motion::summary::NewtonCounts;
use crate::problem::Newton;

/// Bounds of the shift \[–\]; 0 where the body is held without contact.
pub(super) const SHIFTS: (f64, f64) = (1e-9, 1.0);

pub(super) struct Solver<'a> {
    pub model: &'a Model,
    pub path: Path,
    pub counts: NewtonCounts,
    pub smallest_jacobian: SmallestJacobian,
    pub(super) linear: LinearSolver,
    pub(super) free: FreeSpace<'a>,
    pub(super) contacts: ActiveContacts,
    /// Whether only contacts can hold the body.
    pub(super) floating: bool,
    /// Part of the diagonal that is added to K \[–\].
    pub(super) shift: f64,
}

/// Displacements in equilibrium at a fraction of the load.
pub(super) struct Equilibrium {
    pub u: Vec<f64>,
    pub imbalance: Imbalance,
}

impl<'a> Solver<'a> {
    pub fn new(
        model: &'a Model,
        settings: &Newton,
        state: &State,
        buffers: &mut Buffers,
    ) -> Solver<'a> {
        let end = settings.load_end;
        let held = || rigid_motions_left_to_contact(model, end) == 0;
        let mut solver = Solver {
            model,
            path: Path::new(state.time, end, model.size()),
            counts: NewtonCounts::default(),
            smallest_jacobian: SmallestJacobian::NONE,
            linear: LinearSolver::new(model),
            free: FreeSpace::new(model, state.time),
            contacts: ActiveContacts::default(),
            floating: !model.contact.obstacles.is_empty() && !held(),
            shift: 0.0,
        };
        // Before anything fades: the conditions and forces at the start.
        let forces = &mut solver.free.forces;
        solver.path.gap = solver.path.jump(model, 0.0, &state.displacement, forces);
        let imbalance = solver.imbalance(&state.displacement, 0.0, buffers);
        solver.path.force = imbalance.force;
        solver.smallest_jacobian = imbalance.smallest_jacobian;
        solver
    }

    pub(super) fn imbalance(
        &mut self,
        u: &[f64],
        fraction: f64,
        buffers: &mut Buffers,
    ) -> Imbalance {
        self.counts.evaluations += 1;
        self.path.external_force(self.model, fraction, &mut buffers.f_ext);
        let t = self.path.time(fraction);
        let mut imbalance = Imbalance::new(self.model, u, t, buffers, &mut self.free.forces);
        self.free.project_contacts(&mut imbalance.acceleration);
        imbalance
    }
}
