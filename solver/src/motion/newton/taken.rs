//! How much of a correction is taken, and what it leaves of the jump of prescribed values.

use super::linear::Correction;
use super::solver::{Equilibrium, SHIFTS, Solver};
use super::unknowns::Unknowns;
use crate::algebra::packed::{dot, largest};
use crate::motion::step::Buffers;

/// Halvings of a correction that overshoots.
const MOST_HALVINGS: usize = 6;
/// A correction may not compress a point to less than this fraction of its volume.
const SMALLEST_VOLUME: f64 = 0.1;
/// The same of a part of a jump, of which the rest follows in the next correction.
const SMALLEST_VOLUME_IN_JUMP: f64 = 0.3;
/// Largest move of a node in a correction with contact, over the mean nodal spacing \[–\].
const LARGEST_MOVE: f64 = 2.0;
/// Largest jump of a prescribed value in it, over the mean nodal spacing \[–\]: less, as what
/// is free may move farther than what is prescribed.
const LARGEST_JUMP: f64 = 1.0;
/// What may be left of a jump, over the jump and over the largest displacement \[–\].
const LEFT: (f64, f64) = (1e-6, 1e-10);

/// How a correction is taken.
pub(super) enum Outcome {
    /// With the part of it that was taken \[–\].
    Taken(Equilibrium, f64),
    /// Refused; a larger shift may do better.
    TooFar,
    Failed,
}

/// Whether more than round-off is left of a jump whose largest component was `asked` \[m\], at
/// displacements `u` \[m\].
pub(super) fn is_left(left: &[f64], asked: f64, u: &[f64]) -> bool {
    largest(left) > LEFT.0 * asked + LEFT.1 * largest(u)
}

impl Solver<'_> {
    /// The change of `u` \[m\] that meets what is prescribed at a fraction of the load.
    pub(super) fn jump(&mut self, u: &[f64], fraction: f64) -> Vec<f64> {
        self.path.jump(self.model, fraction, u, &mut self.free.forces)
    }

    /// What is left \[m\] of a jump whose largest component was `asked` \[m\].
    pub(super) fn left_of_jump(
        &mut self,
        u: &[f64],
        fraction: f64,
        asked: f64,
    ) -> Option<Vec<f64>> {
        Some(self.jump(u, fraction)).filter(|left| is_left(left, asked, u))
    }

    /// The part of a jump \[m\] that one correction carries, and whether that is all of it:
    /// with obstacles no more than a spacing, lest nodes pass through them.
    pub(super) fn part_of(&self, mut jump: Vec<f64>) -> (Vec<f64>, bool) {
        let contact = &self.model.contact;
        let part = LARGEST_JUMP * contact.mean_spacing / largest(&jump);
        let whole = contact.obstacles.is_empty() || part >= 1.0;
        if !whole {
            jump.iter_mut().for_each(|jump| *jump *= part);
        }
        (jump, whole)
    }

    /// Takes a correction: all of it where it jumps, or as much as brings the forces
    /// closer to balance.
    pub(super) fn take(
        &mut self,
        now: &Equilibrium,
        correction: &Correction,
        fraction: f64,
        searched: bool,
        buffers: &mut Buffers,
    ) -> Outcome {
        let safe = self.contacts.safe_part(self.model, &now.u, &correction.change);
        let from = self.own.clone();
        let outcome = self.tried(now, (correction, safe, &from), fraction, searched, buffers);
        if !matches!(outcome, Outcome::Taken(..)) {
            self.own = from;
        }
        outcome
    }

    fn tried(
        &mut self,
        now: &Equilibrium,
        (correction, safe, from): (&Correction, f64, &Unknowns),
        fraction: f64,
        searched: bool,
        buffers: &mut Buffers,
    ) -> Outcome {
        let change = &correction.change;
        if searched {
            return match self.search(now, (correction, safe, from), fraction, buffers) {
                Some(next) => Outcome::Taken(next, 1.0),
                None => Outcome::TooFar,
            };
        }
        let model = self.model;
        let farthest = LARGEST_MOVE * model.contact.mean_spacing / largest(change);
        let length = if model.contact.obstacles.is_empty() { 1.0 } else { farthest.min(safe) };
        if self.floating && farthest < 1.0 && self.shift < SHIFTS.1 {
            return Outcome::TooFar;
        }
        let smallest = now.imbalance.smallest_jacobian.jacobian.min(1.0);
        // Of a jump without contact the rest can follow.
        let (halvings, volume) = if from.patches.is_some() && model.contact.obstacles.is_empty() {
            (MOST_HALVINGS, SMALLEST_VOLUME_IN_JUMP)
        } else {
            (0, SMALLEST_VOLUME)
        };
        let taken = (0..=halvings).find_map(|halvings| {
            let length = length * 0.5f64.powi(halvings as i32);
            let u = moved(&now.u, change, length);
            self.move_pressures(from, length, correction);
            let imbalance = self.imbalance(&u, fraction, buffers);
            let valid = imbalance.smallest_jacobian.jacobian > volume * smallest;
            valid.then_some(Outcome::Taken(Equilibrium { u, imbalance, exact: None }, length))
        });
        let refused = if self.floating { Outcome::TooFar } else { Outcome::Failed };
        taken.unwrap_or(refused)
    }

    /// The longest of the halved corrections that keeps points from collapsing
    /// and brings the forces, or their work along it, closer to balance.
    fn search(
        &mut self,
        now: &Equilibrium,
        (correction, safe, from): (&Correction, f64, &Unknowns),
        fraction: f64,
        buffers: &mut Buffers,
    ) -> Option<Equilibrium> {
        let change: Vec<f64> = correction.change.iter().map(|change| safe * change).collect();
        let (model, before) = (self.model, &now.imbalance);
        let slope = dot(&change, &before.free(model)).abs();
        let volume = SMALLEST_VOLUME * before.smallest_jacobian.jacobian.min(1.0);
        (0..=MOST_HALVINGS).find_map(|halvings| {
            let length = 0.5f64.powi(halvings as i32);
            let u = moved(&now.u, &change, length);
            self.move_pressures(from, safe * length, correction);
            // The normals turn on the way, and what the obstacles take with them.
            if !self.free.contacts.is_empty() {
                self.close(&u, &before.force);
            }
            let imbalance = self.imbalance(&u, fraction, buffers);
            let valid = imbalance.smallest_jacobian.jacobian > volume;
            let closer = imbalance.norm(model) <= 0.99 * before.norm(model)
                || dot(&change, &imbalance.free(model)).abs() <= 0.8 * slope;
            (valid && closer).then_some(Equilibrium { u, imbalance, exact: None })
        })
    }
}

impl Solver<'_> {
    /// The pressures become those before a correction and a part of it.
    fn move_pressures(&mut self, from: &Unknowns, part: f64, correction: &Correction) {
        self.own = from.moved(self.model, part, correction);
    }
}

fn moved(u: &[f64], change: &[f64], length: f64) -> Vec<f64> {
    u.iter().zip(change).map(|(u, change)| u + length * change).collect()
}
