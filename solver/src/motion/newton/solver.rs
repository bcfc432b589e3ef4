//! What Newton's method has at hand at every fraction of the load.

use super::active_contacts::ActiveContacts;
use super::free_space::FreeSpace;
use super::linear::{Guide, Solver as LinearSolver};
use super::load_path::Path;
use super::unknowns::Unknowns;
use super::unknowns::{Pressures, are_unknowns, most};
use crate::force::{OwnPressures, SmallestJacobian};
use crate::model::Model;
use crate::model::following::OwnFluid;
use crate::model::rigid_motions::rigid_motions_left_to_contact;
use crate::motion::balance::Imbalance;
use crate::motion::state::State;
use crate::motion::step::Buffers;
use crate::motion::summary::{NewtonCounts, PatchPressures};
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
    /// Unknowns beside the displacements.
    pub(super) own: Unknowns,
    /// Of a body that is led away from an equilibrium.
    pub(super) guide: Option<Guide>,
}

/// Displacements in equilibrium at a fraction of the load.
pub(super) struct Equilibrium {
    pub u: Vec<f64>,
    /// With the pressures of the patches that the iteration has.
    pub imbalance: Imbalance,
    /// With those that J gives, where these are others.
    pub exact: Option<Imbalance>,
}

impl Equilibrium {
    /// The imbalance that displacements alone decide on.
    pub fn exact(&self) -> &Imbalance {
        self.exact.as_ref().unwrap_or(&self.imbalance)
    }
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
        let unknown = are_unknowns(model);
        let mut solver = Solver {
            model,
            path: Path::new(state.time, end, model.size()),
            counts: NewtonCounts::default(),
            smallest_jacobian: SmallestJacobian::NONE,
            linear: LinearSolver::new(model, most(unknown)),
            free: FreeSpace::new(model, state.time),
            contacts: ActiveContacts::default(),
            floating: !model.contact.obstacles.is_empty() && !held(),
            shift: 0.0,
            own: Unknowns { patches: None, fluids: None },
            guide: None,
        };
        // Before anything fades: the conditions and forces at the start.
        let forces = &mut solver.free.forces;
        solver.path.gap = solver.path.jump(model, 0.0, &state.displacement, forces);
        solver.free_fluids(&state.displacement, buffers);
        let imbalance = solver.imbalance(&state.displacement, 0.0, buffers);
        solver.path.force = imbalance.force;
        solver.smallest_jacobian = imbalance.smallest_jacobian;
        if unknown {
            solver.counts.pressures = PatchPressures::Unknowns;
            solver.take_pressures_of(&state.displacement, 0.0, buffers);
        }
        solver
    }

    pub(super) fn imbalance(
        &mut self,
        u: &[f64],
        fraction: f64,
        buffers: &mut Buffers,
    ) -> Imbalance {
        let unknowns = self.own.take();
        let patches = unknowns.patches.as_ref().map(|pressures| &pressures.own);
        let own = (patches, unknowns.fluids.as_deref());
        let imbalance = self.imbalance_with(u, own, fraction, buffers);
        self.own = unknowns;
        imbalance
    }

    /// With pressures of patches and fluids, or with those that J and volumes give.
    pub(super) fn imbalance_with(
        &mut self,
        u: &[f64],
        (patches, fluids): (Option<&OwnPressures>, Option<&[OwnFluid]>),
        fraction: f64,
        buffers: &mut Buffers,
    ) -> Imbalance {
        self.counts.evaluations += 1;
        self.path.external_force(self.model, fraction, &mut buffers.f_ext);
        if let Some(guide) = &self.guide {
            guide.add_force(u, &mut buffers.f_ext);
        }
        let (t, forces) = (self.path.time(fraction), &mut self.free.forces);
        let unknowns = (u, patches, fluids);
        let mut imbalance = Imbalance::with_pressures(self.model, unknowns, t, buffers, forces);
        self.free.project_contacts(&mut imbalance.acceleration);
        imbalance
    }
}

impl Solver<'_> {
    /// Makes the pressures of the patches unknowns from displacements `u` \[m\] on.
    pub(super) fn free_pressures(&mut self, u: &[f64], fraction: f64, buffers: &mut Buffers) {
        self.counts.pressures = PatchPressures::Unknowns;
        self.linear = LinearSolver::new(self.model, most(true));
        self.take_pressures_of(u, fraction, buffers);
    }

    /// The pressures become those of displacements `u` \[m\].
    pub(super) fn take_pressures_of(&mut self, u: &[f64], fraction: f64, buffers: &mut Buffers) {
        self.imbalance_with(u, (None, None), fraction, buffers);
        self.own.patches = Some(Pressures::of_j(self.model, &buffers.workspace));
    }

    /// Leaves the pressures to the displacements again, for good.
    pub(super) fn give_up_pressures(&mut self) {
        self.own.patches = None;
        self.counts.pressures = PatchPressures::GivenUp;
        self.linear = LinearSolver::new(self.model, most(false));
    }

    /// Adds the imbalance that displacements alone decide on, where pressures are unknowns.
    pub(super) fn with_exact(
        &mut self,
        next: Equilibrium,
        fraction: f64,
        buffers: &mut Buffers,
    ) -> Equilibrium {
        if self.own.patches.is_none() && self.own.fluids.is_none() {
            return next;
        }
        let fluids = self.exact_fluids(&next.u, fraction);
        let own = (None, fluids.as_deref());
        let exact = Some(self.imbalance_with(&next.u, own, fraction, buffers));
        self.see_pressures(buffers);
        Equilibrium { exact, ..next }
    }

    /// Contacts and pressures as they were at displacements `u` \[m\], with the rows of those contacts:
    /// forces are told from rows by the number of their contact.
    pub(super) fn put_back(&mut self, kept: (ActiveContacts, Unknowns), u: &[f64]) {
        (self.contacts, self.own) = kept;
        self.free.close(self.contacts.rows(self.model, u), &[]);
    }

    /// Takes notice of what the displacements of the last evaluation make of the patches.
    pub(super) fn see_pressures(&mut self, buffers: &Buffers) {
        if let Some(pressures) = &mut self.own.patches {
            pressures.see(self.model, &buffers.workspace);
        }
    }
}
