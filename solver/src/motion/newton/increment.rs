//! Newton's method at a fraction of the load.

use super::correction::round_off_of_fluids;
use super::drift::drifts;
use super::solver::{Equilibrium, SHIFTS, Solver};
use super::taken::{Outcome, is_left};
use crate::algebra::packed::largest;
use crate::model::Model;
use crate::model::contact::ContactForce;
use crate::motion::balance::Imbalance;
use crate::motion::observe::{Continue, Observer};
use crate::motion::step::Buffers;

/// Corrections in one increment of the load; more where pressures follow, and in small increments
/// where contacts have to be found. A large one is halved instead: corrections that wander for long
/// may end in an equilibrium that the load does not lead to.
const MOST_ITERATIONS: usize = 20;
const MOST_ITERATIONS_WITH_PRESSURES: usize = 40;
const MOST_ITERATIONS_IN_CONTACT: usize = 100;
/// Increment above which it is large \[–\].
const LARGE: f64 = 0.25;
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
/// Round-off of a nodal force over ε K h with the nodal spacing h: that of F = 1 + Grad u.
const ROUND_OFF_AT_REST: f64 = 10.0;
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
    /// What is new of it \[–\].
    pub part: f64,
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

/// How far an increment has come.
struct Course {
    load: Load,
    /// Largest component of the whole jump of what is prescribed \[m\].
    asked: f64,
    now: Equilibrium,
    /// What the next correction adds to what is prescribed \[m\].
    jump: Vec<f64>,
    /// Whether the whole jump, which may take several corrections, is not made yet.
    jumping: bool,
    /// Of the next correction, at which conjugate gradients end \[–\].
    forcing: f64,
    /// Whether the last tangent was.
    indefinite: bool,
    /// Residual before the last correction \[–\].
    before: f64,
    /// One for each correction, and one for the end.
    looks: std::ops::RangeInclusive<usize>,
}

/// What a correction came to.
enum Advance {
    /// Whether the body falls without touching anything.
    Moved {
        falling: bool,
    },
    AgainWithLargerShift,
    Stopped,
    Failed,
}

impl Course {
    /// Whether a residual leaves reason for another correction.
    fn may_go_on(&mut self, residual: f64) -> bool {
        let falls = residual < STILL_FALLING.0 && residual < STILL_FALLING.1 * self.before;
        self.before = residual;
        !residual.is_nan() && (self.looks.next().is_some() || falls)
    }

    /// Whether all that is prescribed has been met, by a tangent that resists.
    fn is_whole(&self) -> bool {
        !self.jumping && !self.indefinite
    }

    /// How well the next correction is solved, after one before which the imbalance was `norm`
    /// (Eisenstat and Walker 1996, choice 2).
    fn force_next(&mut self, model: &Model, jumped: bool, norm: f64) {
        self.forcing = match jumped {
            true if self.jumping => FIRST_FORCING,
            true => FORCING.1,
            false => {
                let now = &self.now;
                let fallen = now.imbalance.norm(model) / norm;
                // Not much beyond the tolerance (Kelley 1995, eq. 6.20).
                let relative = now.imbalance.relative(model).max(now.exact().relative(model));
                let enough = ENOUGH * self.load.tolerance / relative;
                (0.9 * fallen * fallen).max(enough).clamp(FORCING.0, FORCING.1)
            }
        };
    }
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
        let kept = (self.contacts.clone(), self.own.clone());
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
            self.put_back(kept, start);
        }
        solved
    }

    fn iterate(
        &mut self,
        start: &[f64],
        load: Load,
        buffers: &mut Buffers,
        observer: &mut dyn Observer,
    ) -> Result<Equilibrium, Unsolved> {
        let model = self.model;
        let mut course = self.begin(start, load, buffers);
        loop {
            let changes = self.settle(start, &mut course.now);
            let residual = course.now.exact().relative(model);
            let failed = Unsolved::Failed { residual, indefinite: course.indefinite };
            if !course.may_go_on(residual) {
                return Err(failed);
            }
            let open = self.free.contacts.iter().fold(0.0f64, |a, row| a.max(row.way.abs()));
            let settled =
                changes == 0 && open <= CLOSED.max(load.tolerance) * model.contact.mean_spacing;
            if settled && course.is_whole() && self.is_balanced(&course.now, load.tolerance) {
                self.counts.up_to_round_off = residual > load.tolerance;
                return Ok(course.now);
            }
            match self.advance(&mut course, settled, residual, buffers, observer) {
                Advance::Moved { falling } if self.floating => self.adapt_shift(changes, falling),
                Advance::Moved { .. } | Advance::AgainWithLargerShift => {}
                Advance::Stopped => return Err(Unsolved::Stopped(Box::new(course.now))),
                Advance::Failed => return Err(failed),
            }
        }
    }

    /// At the start of an increment, nothing corrected yet.
    fn begin(&mut self, start: &[f64], load: Load, buffers: &mut Buffers) -> Course {
        let fraction = load.fraction;
        self.free.t = self.path.time(fraction);
        self.contacts.begin((self.path.time(fraction - load.part), self.free.t));
        let jump = self.jump(start, fraction);
        let imbalance = self.imbalance(start, fraction, buffers);
        self.see_pressures(buffers);
        self.shift = if self.floating { self.first_shift(&imbalance) } else { 0.0 };
        let finds_contacts = !self.model.contact.obstacles.is_empty() && load.part <= LARGE;
        let most = match self.own.patches {
            _ if finds_contacts => MOST_ITERATIONS_IN_CONTACT,
            Some(_) => MOST_ITERATIONS_WITH_PRESSURES,
            None => MOST_ITERATIONS,
        };
        Course {
            load,
            asked: largest(&jump),
            now: Equilibrium { u: start.to_vec(), imbalance, exact: None },
            jump,
            jumping: true,
            forcing: FIRST_FORCING,
            indefinite: false,
            before: f64::INFINITY,
            looks: 0..=most,
        }
    }

    /// One correction.
    fn advance(
        &mut self,
        course: &mut Course,
        settled: bool,
        residual: f64,
        buffers: &mut Buffers,
        observer: &mut dyn Observer,
    ) -> Advance {
        let (model, Load { fraction, tolerance, .. }) = (self.model, course.load);
        let (mut change, whole) = self.part_of(std::mem::take(&mut course.jump));
        self.free.close_contacts(&mut change);
        let (progress, count) = (progress(residual, tolerance), self.counts.iterations);
        let mut go_on = || observer.iterate(fraction * progress, count) == Continue::Yes;
        let Course { now, forcing, indefinite, .. } = &*course;
        let correction =
            self.correction((now, fraction), change, *forcing, *indefinite, buffers, &mut go_on);
        if correction.stopped {
            return Advance::Stopped;
        }
        course.indefinite = correction.indefinite;
        // Nothing balances a falling body before it touches something.
        let falling = self.floating && self.free.contacts.is_empty();
        let jumping = course.jumping;
        let searched = !jumping && settled && !falling;
        let norm = course.now.imbalance.norm(model);
        let length = match self.take(&course.now, &correction, fraction, searched, buffers) {
            Outcome::Taken(next, length) => {
                course.now = self.with_exact(next, fraction, buffers);
                length
            }
            Outcome::TooFar if self.floating && self.shift < SHIFTS.1 => {
                self.shift = (TOO_FAR * self.shift).min(SHIFTS.1);
                course.jump = self.jump(&course.now.u, fraction);
                return Advance::AgainWithLargerShift;
            }
            _ => return Advance::Failed,
        };
        let cut = jumping && !(whole && length == 1.0);
        let (now, asked) = (&course.now, course.asked);
        let left = if cut { self.left_of_jump(&now.u, fraction, asked) } else { None };
        course.jumping = left.is_some();
        course.jump = left.unwrap_or_else(|| vec![0.0; model.size()]);
        course.force_next(model, jumping, norm);
        Advance::Moved { falling }
    }

    /// Less of a shift the closer a floating body is to lying still.
    fn adapt_shift(&mut self, changes: usize, falling: bool) {
        let changed = changes as f64 / (self.free.contacts.len() as f64).max(10.0);
        let factor = if falling { FALLING } else { shift_factor(changed) };
        self.shift = (factor * self.shift).clamp(SHIFTS.0, SHIFTS.1);
    }

    fn is_balanced(&self, now: &Equilibrium, tolerance: f64) -> bool {
        let model = self.model;
        let of_length = ROUND_OFF * largest(&now.u) + ROUND_OFF_AT_REST * model.mean_spacing;
        let round_off = f64::EPSILON * largest(&model.stiffness) * of_length;
        let round_off = round_off + ROUND_OFF * round_off_of_fluids(model, &now.u);
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
    pub(super) fn contact_forces(&mut self, imbalance: &Imbalance) -> Vec<ContactForce> {
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
        let shift = resultant / (stiffness * FIRST_MOVE * model.contact.mean_spacing);
        shift.clamp(SHIFTS.0, SHIFTS.1)
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
