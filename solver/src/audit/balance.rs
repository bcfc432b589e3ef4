//! The balance of forces, moments and energies.
#![allow(non_snake_case)]

use super::{Kind, Row, Run};
use crate::algebra::packed::largest;
use crate::algebra::tensor::{Vector3, vector_at};
use crate::force::{internal_force, potential_energy};
use crate::motion::energy::{energies, excess_of_mean};
use crate::motion::step::{add_following, external_force};

/// Sum of all forces on a body at rest over the sum of their sizes \[–\]: Newton's method leaves up
/// to 1e-3 of it at its usual tolerance, and error bars are rarely smaller.
const FORCES: f64 = 5e-3;
/// The same over the sum of the stiffnesses times the largest displacement \[–\]: round-off of the
/// forces of a body that has only shifted.
const ROUND_OFF: f64 = 1e-12;
/// Energy that is unaccounted for over the largest energy \[–\]: central differences keep that of
/// a linear body, and of others to third order of the step.
const ENERGY: f64 = 0.01;
/// The same of the work of what does not move \[–\].
const WORK: f64 = 0.01;
/// Difference of the work of internal forces over that of their sizes \[–\].
const INTERNAL: f64 = 1e-4;
/// Part by which the displacement is changed for the derivative of the energy \[–\]: the difference
/// is wrong by its square, and round-off of the energy is divided by it.
const CHANGE: f64 = 1e-4;
/// Round-off of the energy of a point over its volume times the bulk modulus \[–\].
const OF_ENERGY: f64 = 1e-15;
/// The same over the second difference of the energy \[–\], of which the third derivative that is
/// left out is no large multiple.
const THIRD: f64 = 1e-5;

impl Run<'_> {
    /// Loads at the nodes, reactions and contact of a body at rest, which add up to zero.
    pub(super) fn forces(&self) -> Vec<Row> {
        if self.moves() {
            return Vec::new();
        }
        let (model, state) = (self.model, self.state);
        let (u, d) = (&state.displacement, model.components);
        let mut loads = vec![0.0; model.size()];
        external_force(model, self.time, &mut loads);
        add_following(model, self.time, u, &mut loads);
        let (mut force, mut moment, mut sizes) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        let mut add = |place: Vector3, own: Vector3| {
            force += own;
            moment += (place - self.centre).cross(&own);
            sizes += own.norm();
        };
        let place = |node: usize| model.positions[node] + vector_at(u, node, d);
        for node in 0..model.positions.len() {
            add(place(node), vector_at(&loads, node, d));
        }
        for contact in state.contact_forces() {
            add(model.contact.place(contact.node, &model.positions, u), contact.force);
        }
        for reaction in state.reactions(model, &self.centre) {
            force += reaction.force;
            moment += reaction.moment;
            sizes += reaction.sizes;
        }
        let stiffness: f64 = model.stiffness.iter().sum();
        let limit = FORCES * sizes + ROUND_OFF * stiffness * largest(u);
        let zero = Vector3::zeros();
        vec![
            Row::vectors(Kind::Forces, "", zero, force, limit),
            Row::vectors(Kind::Moments, "", zero, moment, limit * self.extent()),
        ]
    }

    /// f_int · u, by the loop that a run spends its time in, against the derivative of the strain
    /// energy along u, by one that takes point after point.
    pub(super) fn internal_work(&self) -> Row {
        let (model, u) = (self.model, &self.state.displacement);
        let mut force = vec![0.0; model.size()];
        let mut workspace = self.state.workspace(model);
        internal_force(&model.points, u, &mut workspace, &mut force);
        let works = || u.iter().zip(&force).map(|(u, f)| u * f);
        let (done, sizes): (f64, f64) = (works().sum(), works().map(f64::abs).sum());
        let energy = |factor: f64| {
            potential_energy(
                &model.points,
                &u.iter().map(|u| factor * u).collect::<Vec<_>>(),
                &workspace,
            )
        };
        let [less, same, more] = [1.0 - CHANGE, 1.0, 1.0 + CHANGE].map(energy);
        let asked = (more - less) / (2.0 * CHANGE);
        let second = (more - 2.0 * same + less) / (CHANGE * CHANGE);
        let stiffness: f64 = model.stiffness.iter().sum();
        let of_forces = ROUND_OFF * stiffness * largest(u) * largest(u);
        let volumes = self.sampled.volumes.iter().zip(&self.problem.regions);
        let moduli = volumes
            .map(|(volume, region)| volume.size * region.material.law.constants().bulk_modulus);
        let round_off = of_forces + OF_ENERGY * moduli.sum::<f64>() / CHANGE;
        let limit = INTERNAL * sizes + THIRD * second.abs() + round_off;
        Row::numbers(Kind::InternalWork, "", asked, done, limit)
    }

    /// The energies of a motion whose works were accumulated.
    pub(super) fn energy(&self) -> Vec<Row> {
        let (model, state) = (self.model, self.state);
        let work = state.work;
        if !self.moves() || (work.external == 0.0 && work.constraint == 0.0 && work.damping == 0.0)
        {
            return Vec::new();
        }
        let now = energies(model, state);
        let start = work.start;
        let largest = [now.kinetic, now.strain, work.external.abs(), work.constraint.abs(), start];
        let largest = largest.into_iter().fold(work.damping.abs(), f64::max);
        let done = now.balance() - excess_of_mean(model, state);
        let balance = Row::numbers(Kind::Energy, "", start, done, ENERGY * largest);
        let mut rows = vec![balance];
        if model.constraints.hold_still(0.0, state.time) && !model.contact.has_moving() {
            // Without what obstacles keep of the nodes that touch them, and with what they have taken.
            let done = now.constraint_work - now.contact_loss;
            rows.push(Row::numbers(Kind::ContactWork, "", 0.0, done, WORK * largest));
        }
        rows
    }
}
