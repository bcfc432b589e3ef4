//! Newton's method at a fraction of the load.

use super::drift::drifts;
use super::linear::{Correction, System};
use super::solver::{Equilibrium, SHIFTS, Solver};
use super::taken::{Outcome, is_left};
use crate::algebra::packed::largest;
use crate::model::contact::ContactForce;
use crate::motion::balance::Imbalance;
use crate::motion::observe::{Continue, Observer};
use crate::motion::step::Buffers;
use crate::motion::tangent::Tangent;

/// Corrections in one increment of the load; more where pressures follow, and where contacts
/// have to be found.
const MOST_ITERATIONS: usize = 20;
const MOST_ITERATIONS_WITH_PRESSURES: usize = 40;
const MOST_ITERATIONS_IN_CONTACT: usize = 100;
/// Residual \[–\] below which more of them follow, as long as each leaves at most this part of it:
/// where pressures follow a free rim the tangent is not symmetric, and convergence linear.
const STILL_FALLING: (f64, f64) = (1e-3, 0.7);
/// Bounds of the relative residual at which conjugate gradients end.
const FORCING: (f64, f64) = (1e-4, 0.1);
/// Part of the tolerance that the last correction aims at \[–\].
const ENOUGH: f64 = 0.3;
/// Bound for the first correction, which is not followed by a line search.
const FIRST_FORCING: f64 = 0.01;
/// Round-off of a nodal force over ε K u.
const ROUND_OFF: f64 = 100.0;
/// Gap of a closed contact over the mean nodal spacing \[–\].
const CLOSED: f64 = 1e-6;
/// Move of a body that only contacts can hold in its first correction, over the mean
/// nodal spacing \[–\].
const FIRST_MOVE: f64 = 0.5;
/// Factor of the shift after a correction that went too far \[–\].
const TOO_FAR: f64 = 10.0;
/// Factor of the shift while a body falls that touches nothing \[–\].
const FALLING: f64 = 0.5;

/// What an equilibrium is looked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Load {
    /// Of the whole load \[–\].
    pub fraction: f64,
    /// Of the residual \[–\].
    pub tolerance: f64,
}

/// Why an increment has no equilibrium.
pub(super) enum Unsolved {
    Failed {
        residual: f64,
        indefinite: bool,
    },
    /// The observer ended the run here.
    Stopped(Box<Equilibrium>),
}

impl Solver<'_> {
    /// Newton's method at a fraction of the load from displacements `start` \[m\].
    pub fn solve(
        &mut self,
        start: &[f64],
        load: Load,
        buffers: &mut Buffers,
        observer: &mut dyn Observer,
    ) -> Result<Equilibrium, Unsolved> {
        let (contacts, pressures) = (self.contacts.clone(), self.pressures.clone());
        let fraction = load.fraction;
        let asked = largest(&self.jump(start, fraction));
        let solved = self.iterate(start, load, buffers, observer);
        // Whatever an iteration does, it may not end short of what is prescribed.
        let solved = solved.and_then(|now| {
            if is_left(&self.jump(&now.u, fraction), asked, &now.u) {
                Err(Unsolved::Failed {
                    residual: now.exact().relative(self.model),
                    indefinite: false,
                })
            } else {
                Ok(now)
            }
        });
        if matches!(solved, Err(Unsolved::Failed { .. })) {
            (self.contacts, self.pressures) = (contacts, pressures);
        }
        solved
    }

    fn iterate(
        &mut self,
        start: &[f64],
        Load { fraction, tolerance }: Load,
        buffers: &mut Buffers,
        observer: &mut dyn Observer,
    ) -> Result<Equilibrium, Unsolved> {
        let model = self.model;
        self.free.t = self.path.time(fraction);
        self.contacts.begin();
        let mut jump = self.jump(start, fraction);
        let asked = largest(&jump);
        let imbalance = self.imbalance(start, fraction, buffers);
        self.see_pressures(buffers);
        self.shift = if self.floating { self.first_shift(&imbalance) } else { 0.0 };
        let mut now = Equilibrium { u: start.to_vec(), imbalance, exact: None };
        // The jump of what is prescribed may take several corrections.
        let (mut forcing, mut indefinite, mut jumping) = (FIRST_FORCING, false, true);
        let most = match model.contact.obstacles.is_empty() {
            true if self.pressures.is_some() => MOST_ITERATIONS_WITH_PRESSURES,
            true => MOST_ITERATIONS,
            false => MOST_ITERATIONS_IN_CONTACT,
        };
        let (mut before, mut corrections) = (f64::INFINITY, 0..=most);
        loop {
            let changes = self.settle(start, &mut now);
            let residual = now.exact().relative(model);
            let failed = Unsolved::Failed { residual, indefinite };
            let falls = residual < STILL_FALLING.0 && residual < STILL_FALLING.1 * before;
            if residual.is_nan() || corrections.next().is_none() && !falls {
                return Err(failed);
            }
            before = residual;
            let open = self.free.contacts.iter().fold(0.0f64, |a, row| a.max(row.way.abs()));
            let settled = changes == 0 && open <= CLOSED.max(tolerance) * model.contact.skin;
            if !jumping && settled && !indefinite && self.is_balanced(&now, tolerance) {
                return Ok(now);
            }
            let (mut change, whole) = self.part_of(std::mem::take(&mut jump));
            self.free.close_contacts(&mut change);
            let (progress, count) = (progress(residual, tolerance), self.counts.iterations);
            let mut go_on = || observer.iterate(fraction * progress, count) == Continue::Yes;
            let correction =
                self.correction(&now, change, forcing, indefinite, buffers, &mut go_on);
            if correction.stopped {
                return Err(Unsolved::Stopped(Box::new(now)));
            }
            indefinite = correction.indefinite;
            // Nothing balances a falling body before it touches something.
            let falling = self.floating && self.free.contacts.is_empty();
            let searched = !jumping && settled && !falling;
            let norm = now.imbalance.norm(model);
            let cut = match self.take(&now, &correction, fraction, searched, buffers) {
                Outcome::Taken(next, length) => {
                    now = self.with_exact(next, fraction, buffers);
                    jumping && !(whole && length == 1.0)
                }
                Outcome::TooFar if self.floating && self.shift < SHIFTS.1 => {
                    self.shift = (TOO_FAR * self.shift).min(SHIFTS.1);
                    jump = self.jump(&now.u, fraction);
                    continue;
                }
                _ => return Err(failed),
            };
            if self.floating {
                let changed = changes as f64 / (self.free.contacts.len() as f64).max(10.0);
                let factor = if falling { FALLING } else { shift_factor(changed) };
                self.shift = (factor * self.shift).clamp(SHIFTS.0, SHIFTS.1);
            }
            let left = if cut { self.left_of_jump(&now.u, fraction, asked) } else { None };
            // Eisenstat and Walker 1996, choice 2.
            let fallen = now.imbalance.norm(model) / norm;
            forcing = match jumping {
                true if left.is_some() => FIRST_FORCING,
                true => FORCING.1,
                false => {
                    // Not much beyond the tolerance (Kelley 1995, eq. 6.20).
                    let relative = now.imbalance.relative(model).max(now.exact().relative(model));
                    let enough = ENOUGH * tolerance / relative;
                    (0.9 * fallen * fallen).max(enough).clamp(FORCING.0, FORCING.1)
                }
            };
            jumping = left.is_some();
            jump = left.unwrap_or_else(|| vec![0.0; start.len()]);
        }
    }

    fn is_balanced(&self, now: &Equilibrium, tolerance: f64) -> bool {
        let model = self.model;
        let round_off = ROUND_OFF * f64::EPSILON * largest(&model.stiffness) * largest(&now.u);
        now.exact().relative(model) <= tolerance || now.exact().largest(model) <= round_off
    }

    /// Opens and closes contacts; returns how many.
    fn settle(&mut self, before: &[f64], now: &mut Equilibrium) -> usize {
        let model = self.model;
        if model.contact.obstacles.is_empty() {
            return 0;
        }
        self.close(&now.u, &now.imbalance.force);
        let forces = self.contact_forces(&now.imbalance);
        let normal = self.contacts.normal_forces(model, &now.u, &forces);
        let changes = self.contacts.update(model, before, &now.u, &normal);
        if changes > 0 {
            self.close(&now.u, &now.imbalance.force);
        }
        for imbalance in std::iter::once(&mut now.imbalance).chain(&mut now.exact) {
            imbalance.acceleration = model.accelerations(&imbalance.force);
            self.free.project(&mut imbalance.acceleration);
        }
        changes
    }

    /// Closes the contacts at displacements `u` \[m\], and stops rigid motions along them that the
    /// unbalanced forces \[N\] do not drive.
    pub(super) fn close(&mut self, u: &[f64], force: &[f64]) {
        let rows = self.contacts.rows(self.model, u);
        let stopped = if self.floating {
            drifts(self.model, self.free.t, u, &rows, force)
        } else {
            Vec::new()
        };
        self.free.close(rows, &stopped);
    }

    /// What the closed contacts exert.
    fn contact_forces(&mut self, imbalance: &Imbalance) -> Vec<ContactForce> {
        let multipliers = self.contact_multipliers(imbalance);
        self.contacts.forces(&self.free.contacts, &multipliers)
    }

    /// What the closed contacts exert, and the accelerations that are left to the
    /// conditions \[m/s²\].
    pub fn without_contact(&mut self, imbalance: &Imbalance) -> (Vec<ContactForce>, Vec<f64>) {
        let multipliers = self.contact_multipliers(imbalance);
        let mut force = imbalance.force.clone();
        self.free.take_contact_forces(&mut force, &multipliers);
        let contact = self.contacts.forces(&self.free.contacts, &multipliers);
        (contact, self.model.accelerations(&force))
    }

    /// Of the rows of the closed contacts \[N\].
    fn contact_multipliers(&mut self, imbalance: &Imbalance) -> Vec<f64> {
        if self.free.contacts.is_empty() {
            Vec::new()
        } else {
            self.free.project_contacts(&mut self.model.accelerations(&imbalance.force))
        }
    }

    /// The shift with which the resultant moves the body by a part of the spacing.
    fn first_shift(&self, imbalance: &Imbalance) -> f64 {
        let model = self.model;
        let resultant = (0..model.components)
            .map(|k| {
                let along: f64 = imbalance.force.iter().skip(k).step_by(model.components).sum();
                along * along
            })
            .sum::<f64>()
            .sqrt();
        let stiffness: f64 = self.linear.diagonal().iter().sum();
        let shift = resultant / (stiffness * FIRST_MOVE * model.contact.skin);
        shift.clamp(SHIFTS.0, SHIFTS.1)
    }

    fn correction(
        &mut self,
        now: &Equilibrium,
        change: Vec<f64>,
        forcing: f64,
        only_resisting: bool,
        buffers: &mut Buffers,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Correction {
        let model = self.model;
        let forces = self.contact_forces(&now.imbalance);
        let sliding = self.contacts.sliding_stiffness(model, &now.u, &forces, only_resisting);
        let tangent = Tangent::new(model, &now.u, self.free.t, &mut buffers.workspace)
            .with_pressures(self.pressures.as_ref().map(|pressures| pressures.own.clone()));
        let saddle = self.pressures.as_ref().map(|pressures| pressures.saddle(model));
        let residual = now.imbalance.free(model);
        let (shift, guide) = (self.shift, self.guide.as_ref());
        let system = System { tangent, residual, change, forcing, sliding, shift, guide, saddle };
        let correction = self.linear.solve(model, &mut self.free, system, go_on);
        self.counts.iterations += 1;
        self.counts.products += correction.products;
        self.counts.evaluations += correction.products;
        correction
    }
}

/// How far a residual has fallen to its tolerance, in orders of magnitude \[–\].
fn progress(residual: f64, tolerance: f64) -> f64 {
    (residual.ln() / tolerance.ln()).clamp(0.0, 1.0)
}

/// Factor of the shift after a correction, by the part of the contacts that changed \[–\]
/// (method book, eq. 21.11).
fn shift_factor(changed: f64) -> f64 {
    match changed {
        changed if changed > 0.2 => 4.0,
        changed if changed < 0.05 => 0.1,
        _ => 0.5,
    }
}
