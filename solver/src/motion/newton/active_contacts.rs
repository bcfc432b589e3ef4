//! Which contacts are closed.
#![allow(non_snake_case)]

use super::free_space::{ContactRow, place};
use crate::algebra::tensor::{Matrix3, Vector3, vector_at};
use crate::model::Model;
use crate::model::contact::{Components, ContactForce, gap, normal, onto_surface};
use crate::problem::{Friction, Obstacle};
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
    /// Where it sticks \[m\].
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
}

impl ActiveContacts {
    /// Forgets how often contacts changed, at the start of an increment.
    pub fn begin(&mut self) {
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
        for (obstacle, shape) in (0..).zip(&model.contact.obstacles) {
            for &node in &model.contact.nodes {
                let (x, free) = (place(model, node, u), model.contact.free(node));
                let depth = -gap(shape, &x);
                let entered = depth > ENTERED * model.contact.mean_spacing
                    && !known.contains(&(obstacle, node))
                    && normal(shape, &x, free) != Vector3::zeros();
                if entered {
                    let anchor = (shape.friction == Friction::NoSlip)
                        .then(|| crossing(shape, &place(model, node, before), &x, free));
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
            let obstacle = &model.contact.obstacles[contact.obstacle as usize];
            let (x, free) = (place(model, contact.node, u), model.contact.free(contact.node));
            let row =
                |along: Vector3, way| ContactRow { contact: index, node: contact.node, along, way };
            match contact.anchor {
                Some(anchor) => {
                    let along = (0..3).filter(|k| free[*k]);
                    rows.extend(along.map(|k| row(Vector3::ith(k, 1.0), anchor[k] - x[k])))
                }
                None => {
                    let along = normal(obstacle, &x, free);
                    let target = onto_surface(obstacle, &x, gap(obstacle, &x), free);
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
            let obstacle = &model.contact.obstacles[contact.obstacle as usize];
            let (x, free) = (place(model, contact.node, u), model.contact.free(contact.node));
            let n = normal(obstacle, &x, free);
            let lambda = force.force.dot(&n).max(0.0);
            let turn = Matrix3::from_columns(&[0, 1, 2].map(|k| {
                if free[k] {
                    let aside = step * Vector3::ith(k, 1.0);
                    let ahead = normal(obstacle, &(x + aside), free);
                    (ahead - normal(obstacle, &(x - aside), free)) / (2.0 * step)
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
            for &node in contact.nodes.iter().filter(|node| !known.contains(node)) {
                let from = place(model, node, u);
                let way = vector_at(change, node as usize, model.components);
                if let Some(x) = contact.crossing(obstacle, &from, &(from + way)) {
                    part = part.min(((x - from).norm() + inside) / way.norm());
                }
            }
        }
        part
    }

    /// The parts of forces along the normals, positive where the obstacle pushes \[N\].
    pub fn normal_forces(&self, model: &Model, u: &[f64], forces: &[ContactForce]) -> Vec<f64> {
        let places = forces.iter().map(|force| place(model, force.node, u));
        let normals = model.contact.normals(forces, places);
        normals.zip(forces).map(|(normal, force)| normal.dot(&force.force)).collect()
    }
}

/// Where the way from `outside` to `inside` \[m\] enters an obstacle.
fn crossing(obstacle: &Obstacle, outside: &Vector3, inside: &Vector3, free: Components) -> Vector3 {
    let (mut low, mut high) = (0.0, 1.0);
    if gap(obstacle, outside) > 0.0 {
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if gap(obstacle, &outside.lerp(inside, middle)) >= 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
    }
    let x = outside.lerp(inside, high);
    onto_surface(obstacle, &x, gap(obstacle, &x), free)
}
