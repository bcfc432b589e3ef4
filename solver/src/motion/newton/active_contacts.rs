//! Which contacts are closed.
#![allow(non_snake_case)]

use super::free_space::ContactRow;
use crate::algebra::tensor::{Matrix3, Vector3, vector_at};
use crate::model::Model;
use crate::model::contact::{Components, ContactForce, Placed};
use crate::problem::Friction;
use std::collections::{BTreeMap, BTreeSet};

/// Depth over the mean nodal spacing from which a node has entered an obstacle \[–\].
const ENTERED: f64 = 1e-7;
/// Changes of one contact between open and closed in an increment, after which it opens
/// only against a notable force.
const MOST_CHANGES: u32 = 4;
/// That force over the largest one \[–\].
const NOTABLE: f64 = 1e-3;
/// Step of the differences of normals over the mean nodal spacing \[–\].
const SLIDING_STEP: f64 = 0.05;

/// How deep a correction may lead into a narrow obstacle, over its width or the mean spacing \[–\].
const PASSING: f64 = 0.2;

/// A node on the surface of an obstacle.
#[derive(Debug, Clone, Copy)]
struct Contact {
    obstacle: u32,
    node: u32,
    /// Where it sticks, as the obstacle sees it \[m\].
    anchor: Option<Vector3>,
}

impl Contact {
    fn pair(&self) -> (u32, u32) {
        (self.obstacle, self.node)
    }
}

/// The closed contacts (method book, eq. 21.9: the active set of Hüeber, Wohlmuth 2005).
#[derive(Debug, Clone, Default)]
pub(super) struct ActiveContacts {
    contacts: Vec<Contact>,
    changes: BTreeMap<(u32, u32), u32>,
    /// Time of the load, at which obstacles are where they are \[s\].
    t: f64,
    /// The same at the start of the increment \[s\].
    since: f64,
}

impl ActiveContacts {
    /// Forgets how often contacts changed, at the start of an increment between two times \[s\].
    pub fn begin(&mut self, (since, t): (f64, f64)) {
        (self.since, self.t) = (since, t);
        self.changes.clear();
    }

    /// Closes contacts of nodes that have entered at displacements `u` \[m\], on their way
    /// from those `before`, and opens those that pull, by the normal forces \[N\] of
    /// [`ActiveContacts::normal_forces`]. Returns the number of changes.
    pub fn update(&mut self, model: &Model, before: &[f64], u: &[f64], forces: &[f64]) -> usize {
        let largest = forces.iter().fold(0.0f64, |a, f| a.max(f.abs()));
        let changes = &mut self.changes;
        let mut forces = forces.iter();
        let count = self.contacts.len();
        let known: BTreeSet<(u32, u32)> = self.contacts.iter().map(Contact::pair).collect();
        self.contacts.retain(|contact| {
            let changed = changes.entry(contact.pair()).or_default();
            let limit = if *changed < MOST_CHANGES { 0.0 } else { -NOTABLE * largest };
            let stays = forces.next().is_none_or(|&force| force >= limit);
            *changed += !stays as u32;
            stays
        });
        let opened = count - self.contacts.len();
        opened + self.enter(model, before, u, &known)
    }

    fn enter(
        &mut self,
        model: &Model,
        before: &[f64],
        u: &[f64],
        known: &BTreeSet<(u32, u32)>,
    ) -> usize {
        let count = self.contacts.len();
        for (obstacle, placed) in model.contact.all_placed(self.t) {
            for &node in &model.contact.nodes {
                let (x, free) =
                    (model.contact.place(node, &model.positions, u), model.contact.free(node));
                let depth = -placed.gap(&x);
                let entered = depth > ENTERED * model.contact.mean_spacing
                    && !known.contains(&(obstacle, node))
                    && placed.normal(&x, free) != Vector3::zeros();
                if entered {
                    let anchor = (placed.obstacle.friction != Friction::Frictionless).then(|| {
                        let start = model.contact.placed(obstacle, self.since);
                        sticks(
                            (&start, &model.contact.place(node, &model.positions, before)),
                            (&placed, &x),
                            free,
                        )
                    });
                    self.contacts.push(Contact { obstacle, node, anchor });
                }
            }
        }
        self.contacts.sort_by_key(|contact| (contact.node, contact.obstacle));
        self.contacts.len() - count
    }

    /// What the closed contacts prescribe at displacements `u` \[m\].
    pub fn rows(&self, model: &Model, u: &[f64]) -> Vec<ContactRow> {
        let mut rows = Vec::new();
        for (index, contact) in self.contacts.iter().enumerate() {
            let obstacle = model.contact.placed(contact.obstacle, self.t);
            let (x, free) = (
                model.contact.place(contact.node, &model.positions, u),
                model.contact.free(contact.node),
            );
            let row =
                |along: Vector3, way| ContactRow { contact: index, node: contact.node, along, way };
            match contact.anchor {
                Some(anchor) => {
                    let anchor = obstacle.now(&anchor);
                    let along = (0..3).filter(|k| free[*k]);
                    rows.extend(along.map(|k| row(Vector3::ith(k, 1.0), anchor[k] - x[k])))
                }
                None => {
                    let along = obstacle.normal(&x, free);
                    let target = obstacle.onto_surface(&x, obstacle.gap(&x), free);
                    rows.push(row(along, (target - x).dot(&along)));
                }
            }
        }
        rows
    }

    /// Forces that the obstacles exert \[N\], from the multipliers of the rows.
    pub fn forces(&self, rows: &[ContactRow], multipliers: &[f64]) -> Vec<ContactForce> {
        let mut forces: Vec<ContactForce> = (self.contacts.iter())
            .map(|&Contact { obstacle, node, .. }| ContactForce {
                obstacle,
                node,
                force: Vector3::zeros(),
            })
            .collect();
        for (row, multiplier) in rows.iter().zip(multipliers) {
            forces[row.contact].force -= row.along * *multiplier;
        }
        forces
    }

    /// How the normals turn as the nodes of frictionless contacts slide under forces \[N\]:
    /// node and stiffness −λ ∂n/∂x \[N/m\], on request only what of it resists
    /// (method book, eq. 21.10).
    pub fn sliding_stiffness(
        &self,
        model: &Model,
        u: &[f64],
        forces: &[ContactForce],
        only_resisting: bool,
    ) -> Vec<(u32, Matrix3)> {
        let step = SLIDING_STEP * model.contact.mean_spacing;
        let mut found = Vec::new();
        for (contact, force) in self.contacts.iter().zip(forces) {
            if contact.anchor.is_some() {
                continue;
            }
            let obstacle = model.contact.placed(contact.obstacle, self.t);
            let (x, free) = (
                model.contact.place(contact.node, &model.positions, u),
                model.contact.free(contact.node),
            );
            let n = obstacle.normal(&x, free);
            let lambda = force.force.dot(&n).max(0.0);
            let turn = Matrix3::from_columns(&[0, 1, 2].map(|k| {
                if free[k] {
                    let aside = step * Vector3::ith(k, 1.0);
                    let ahead = obstacle.normal(&(x + aside), free);
                    (ahead - obstacle.normal(&(x - aside), free)) / (2.0 * step)
                } else {
                    Vector3::zeros()
                }
            }));
            let along = Matrix3::identity() - n * n.transpose();
            let symmetric = -0.5 * lambda * (turn + turn.transpose());
            let mut stiffness = along * symmetric * along;
            if only_resisting {
                let mut eigen = stiffness.symmetric_eigen();
                eigen.eigenvalues.apply(|value| *value = value.max(0.0));
                stiffness = eigen.recompose();
            }
            found.push((contact.node, stiffness));
        }
        found
    }

    /// The part of a change of `u` \[m\] with which no node passes through a narrow obstacle that
    /// it does not touch \[–\].
    pub fn safe_part(&self, model: &Model, u: &[f64], change: &[f64]) -> f64 {
        let contact = &model.contact;
        let mut part = 1.0f64;
        for obstacle in 0..contact.obstacles.len() as u32 {
            let Some(width) = contact.width(obstacle) else { continue };
            let known: BTreeSet<u32> =
                self.contacts.iter().filter(|c| c.obstacle == obstacle).map(|c| c.node).collect();
            let inside = PASSING * width.min(contact.mean_spacing);
            let placed = contact.placed(obstacle, self.t);
            for &node in contact.nodes.iter().filter(|node| !known.contains(node)) {
                let from = model.contact.place(node, &model.positions, u);
                let way = vector_at(change, node as usize, model.components);
                if let Some(x) =
                    contact.crossing(obstacle, (&placed, &from), (&placed, &(from + way)))
                {
                    part = part.min(((x - from).norm() + inside) / way.norm());
                }
            }
        }
        part
    }

    /// The parts of forces along the normals, positive where the obstacle pushes \[N\].
    pub fn normal_forces(&self, model: &Model, u: &[f64], forces: &[ContactForce]) -> Vec<f64> {
        let places =
            forces.iter().map(|force| model.contact.place(force.node, &model.positions, u));
        let normals = model.contact.normals(self.t, forces, places);
        normals.zip(forces).map(|(normal, force)| normal.dot(&force.force)).collect()
    }
}

/// Where a node sticks to an obstacle, as the obstacle sees it: where it entered on its way since the
/// start of the increment, or, if it touched then, where it is, carried along since.
fn sticks(before: (&Placed, &Vector3), now: (&Placed, &Vector3), free: Components) -> Vector3 {
    let (outside, inside) = (before.0.own(before.1), now.0.own(now.1));
    let (now, x) = (now.0, now.1);
    let at = |part: f64| now.now(&outside.lerp(&inside, part));
    let place = if now.gap(&at(0.0)) > 0.0 {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if now.gap(&at(middle)) >= 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        at(high)
    } else {
        now.now(&before.0.own(x))
    };
    now.own(&now.onto_surface(&place, now.gap(&place), free))
}
