//! Newton's method towards a static solution, the load in as few parts as it takes.

use super::active_contacts::ActiveContacts;
use super::branch::{AHEAD, Branch};
use super::increment::{Load, Unsolved};
use super::solver::{Equilibrium, Solver};
use super::unknowns::Unknowns;
use super::unknowns::can_be_unknowns;
use crate::algebra::packed::dot;
use crate::error::{Error, Instability};
use crate::force::strain_energy;
use crate::model::Model;
use crate::model::following::OwnFluid;
use crate::motion::observe::{Continue, Observer, notify};
use crate::motion::stability::Stability;
use crate::motion::state::State;
use crate::motion::step::{Buffers, external_force};
use crate::motion::summary::{PatchPressures, Summary};
use crate::problem::Newton;
use std::f64::consts::FRAC_PI_2;

/// Fraction of the load below which an increment is not halved again.
const SMALLEST_INCREMENT: f64 = 1e-3;
/// The same where pressures are unknowns, which are given up there.
const SMALLEST_WITH_PRESSURES: f64 = 0.02;
/// Fraction of the load above which it is halved where the body cannot be led away from an
/// unstable equilibrium.
const LARGEST_UNSTABLE: f64 = 0.1;
/// Way of an obstacle in an increment over the mean nodal spacing \[–\]: nodes that it has passed by
/// more may be nearer to another side of it.
const LARGEST_WAY: f64 = 0.5;
/// Turn of all prescribed rotations in an increment \[rad\]: beyond half a turn the end of it is
/// nearer by the other way round.
const LARGEST_TURN: f64 = FRAC_PI_2;
/// Residual of the increments before the last one, unless more is allowed at the end \[–\].
const PASSING_TOLERANCE: f64 = 1e-4;

/// Solves f_ext = f_int under the conditions of the end of loading, by
/// corrections K Δu = f_ext − f_int from conjugate gradients that stay in the
/// free displacements. Contacts open and close between corrections. Where this
/// fails, the load is applied in parts. The works of the state are sums over the
/// parts by the trapezoidal rule; their total is the strain energy.
pub(crate) fn equilibrate(
    model: &Model,
    settings: &Newton,
    state: &mut State,
    observer: &mut dyn Observer,
) -> Result<Summary, Error> {
    let mut buffers = Buffers::new(model, false);
    state.extra.act(model, state.time, &mut buffers.workspace);
    let solver = Solver::new(model, settings, state, &mut buffers);
    let stopped = notify(model, state, 1.0, 0.0, observer) == Continue::Stop;
    let tolerance = settings.tolerance;
    let branch = Branch::default();
    let (reached, increment) = (0.0, 1.0);
    let mut loading = Loading {
        solver,
        state,
        buffers,
        observer,
        tolerance,
        branch,
        reached,
        increment,
        stopped,
    };
    while loading.reached < 1.0 && !loading.stopped {
        loading.next_part()?;
    }
    let Loading { solver, state, stopped, branch, .. } = loading;
    let Stability { found, products, .. } = branch.stability;
    Ok(solver.summary(state, stopped, found, products))
}

/// A body while its load grows.
struct Loading<'a, 'm> {
    solver: Solver<'m>,
    state: &'a mut State,
    buffers: Buffers,
    observer: &'a mut dyn Observer,
    /// Of the residual at the end \[–\].
    tolerance: f64,
    branch: Branch,
    /// Fraction of the load that is in equilibrium \[–\].
    reached: f64,
    /// What is tried next \[–\].
    increment: f64,
    /// By the observer.
    stopped: bool,
}

impl Loading<'_, '_> {
    fn load_at(&self, fraction: f64) -> Load {
        let passing = self.tolerance.max(PASSING_TOLERANCE);
        let tolerance = if fraction == 1.0 { self.tolerance } else { passing };
        Load { fraction, part: fraction - self.reached, tolerance }
    }

    /// Of the load, to be tried next.
    fn next_fraction(&mut self) -> f64 {
        let Loading { solver, state, reached, .. } = self;
        let (model, reached) = (solver.model, *reached);
        let around = (model.contact.has_moving())
            .then(|| model.contact.around(&model.positions, &state.displacement));
        let is_far = |part: f64| {
            let times = (solver.path.time(reached), solver.path.time((reached + part).min(1.0)));
            let way = around.map_or(0.0, |around| model.contact.travel(times, around));
            way > LARGEST_WAY * model.contact.mean_spacing
                || model.constraints.turn(times) > LARGEST_TURN
        };
        while is_far(self.increment) && self.increment > SMALLEST_INCREMENT {
            self.increment *= 0.5;
        }
        // No tiny last increment.
        let all = reached + 1.5 * self.increment > 1.0;
        if all { 1.0 } else { reached + self.increment }
    }

    /// Tries the next part of the load.
    fn next_part(&mut self) -> Result<(), Error> {
        let fraction = self.next_fraction();
        let load = self.load_at(fraction);
        let Loading { solver, state, buffers, observer, .. } = self;
        let kept = (solver.contacts.clone(), solver.own.clone());
        state.extra.act(solver.model, solver.path.time(fraction), &mut buffers.workspace);
        match solver.solve(&state.displacement, load, buffers, *observer) {
            Ok(equilibrium) => self.settle(equilibrium, load, kept),
            Err(Unsolved::Stopped(here)) => {
                let jacobian = here.exact().smallest_jacobian.jacobian;
                solver.accept(*here, fraction, state, buffers);
                notify(solver.model, state, jacobian, self.reached, *observer);
                self.stopped = true;
            }
            Err(Unsolved::Failed { residual, indefinite }) => {
                self.try_otherwise(fraction, residual, indefinite)?;
            }
        }
        Ok(())
    }

    /// Goes on from an equilibrium, or from a stable one that it leads to; without either, from
    /// the contacts and pressures that were `kept`, with a smaller part of the load.
    fn settle(&mut self, equilibrium: Equilibrium, load: Load, kept: (ActiveContacts, Unknowns)) {
        let Loading { solver, state, branch, buffers, observer, .. } = self;
        let equilibrium = match branch.stable(solver, equilibrium, load, buffers, *observer) {
            Ok(stable) => stable,
            Err(_) if load.fraction - self.reached > LARGEST_UNSTABLE => {
                // Nearer to where it lost its stability it has fewer ways to go.
                solver.put_back(kept, &state.displacement);
                self.increment = 0.5 * (load.fraction - self.reached);
                return;
            }
            Err(unstable) => branch.stay_on(*unstable),
        };
        self.reach(equilibrium, load.fraction);
        self.increment *= 2.0;
    }

    /// After a failure: pressures as unknowns, a smaller part of the load, or the way around a
    /// limit point.
    fn try_otherwise(
        &mut self,
        fraction: f64,
        residual: f64,
        indefinite: bool,
    ) -> Result<(), Error> {
        let reached = self.reached;
        let Loading { solver, state, buffers, .. } = self;
        if solver.counts.pressures == PatchPressures::OfDisplacements
            && can_be_unknowns(solver.model)
        {
            solver.free_pressures(&state.displacement, reached, buffers);
            return Ok(());
        }
        self.increment = 0.5 * (fraction - reached);
        if self.increment < SMALLEST_WITH_PRESSURES && solver.own.patches.is_some() {
            solver.give_up_pressures();
            self.increment = 1.0 - reached;
        }
        if self.increment >= SMALLEST_INCREMENT {
            return Ok(());
        }
        let load = self.load_at((reached + AHEAD).min(1.0));
        let Loading { solver, state, branch, buffers, observer, .. } = self;
        state.extra.act(solver.model, solver.path.time(load.fraction), &mut buffers.workspace);
        match branch.beyond(solver, state, load, buffers, *observer) {
            Some(equilibrium) => {
                self.reach(equilibrium, load.fraction);
                self.increment = AHEAD;
                Ok(())
            }
            None => Err(Error::NoEquilibrium {
                reached,
                iterations: solver.counts.iterations,
                evaluations: solver.counts.evaluations,
                residual,
                indefinite,
            }),
        }
    }

    /// Makes an equilibrium the state of the body and shows it.
    fn reach(&mut self, equilibrium: Equilibrium, fraction: f64) {
        let Loading { solver, state, buffers, observer, .. } = self;
        let jacobian = equilibrium.exact().smallest_jacobian.jacobian;
        solver.accept(equilibrium, fraction, state, buffers);
        self.stopped = notify(solver.model, state, jacobian, fraction, *observer) == Continue::Stop;
        self.reached = fraction;
    }
}

impl Solver<'_> {
    /// Makes an equilibrium the state of the body, at rest.
    pub(super) fn accept(
        &mut self,
        equilibrium: Equilibrium,
        fraction: f64,
        state: &mut State,
        buffers: &mut Buffers,
    ) {
        let model = self.model;
        let Equilibrium { u, imbalance, exact } = equilibrium;
        let imbalance = exact.unwrap_or(imbalance);
        self.counts.increments += 1;
        self.counts.residual = imbalance.relative(model);
        self.smallest_jacobian = self.smallest_jacobian.or(imbalance.smallest_jacobian);
        let stored =
            strain_energy(&model.points, &u) - strain_energy(&model.points, &state.displacement);
        external_force(model, state.time, &mut buffers.f_ext);
        let fluids = self.exact_fluids(&state.displacement, self.path.fraction(state.time));
        self.add_following(state.time, fluids, &state.displacement, buffers);
        let before = std::mem::take(&mut state.displacement);
        let steps: Vec<f64> = u.iter().zip(&before).map(|(u, before)| u - before).collect();
        let mut external = 0.5 * dot(&buffers.f_ext, &steps);
        state.time = self.path.time(fraction);
        external_force(model, state.time, &mut buffers.f_ext);
        let fluids = self.exact_fluids(&u, fraction);
        self.add_following(state.time, fluids, &u, buffers);
        external += 0.5 * dot(&buffers.f_ext, &steps);
        state.work.external += external;
        state.work.constraint += stored - external;
        state.displacement = u;
        // What has a memory remembers whole parts of the time only.
        if model.has_extra_stress() && !model.has_memory() {
            state.remember(model, &mut buffers.workspace);
        }
        state.velocity.fill(0.0);
        state.time_step = 0.0;
        state.step = self.counts.iterations;
        // f_int − f_ext is the force of the conditions and of contact.
        let (contact, mut acceleration) = self.without_contact(&imbalance);
        state.contact.touching = contact.iter().map(|force| force.node).collect();
        state.contact.touching.dedup();
        state.contact.forces = contact;
        let forces = &mut state.constraint_forces;
        model.constraints.project(state.time, &model.inertia, &mut acceleration, forces);
        state.force_factor = 1.0;
    }

    /// Adds the loads that depend on displacements, of fluids with these pressures.
    fn add_following(
        &self,
        t: f64,
        fluids: Option<Vec<OwnFluid>>,
        u: &[f64],
        buffers: &mut Buffers,
    ) {
        let Model { following, components, .. } = self.model;
        following.add_force((t, fluids.as_deref()), u, *components, &mut buffers.f_ext);
    }

    fn summary(
        &self,
        state: &State,
        stopped: bool,
        instability: Option<Instability>,
        stability_products: usize,
    ) -> Summary {
        Summary {
            steps: self.counts.iterations,
            time: state.time,
            time_steps: (0.0, 0.0),
            critical_time_step: 0.0,
            force_evaluations: self.counts.evaluations,
            lanczos_evaluations: 0,
            smallest_jacobian: self.smallest_jacobian,
            relaxation: None,
            newton: Some(self.counts),
            newton_failed: None,
            stopped,
            instability,
            stability_products,
            contact_loss: None,
        }
    }
}
