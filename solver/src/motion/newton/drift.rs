//! Rigid motions along closed contacts that nothing drives.
#![allow(non_snake_case)]

use super::free_space::ContactRow;
use crate::algebra::packed::dot;
use crate::algebra::tensor::{Vector3, vector_at};
use crate::model::Model;
use crate::model::rigid_motions::{prescribed, rigid_motions_beside};

/// Square of a component along a contact, in the mean, that is none \[–\]: contacts close
/// as the iteration goes on.
const ALONG: f64 = 1e-8;
/// Work of the unbalanced forces along a drift over the sum of its sizes, below which
/// nothing drives it \[–\].
const DRIVEN: f64 = 1e-3;

/// Rigid motions of single bodies \[component of node\] that neither the conditions nor the closed contacts
/// hinder and that the unbalanced forces \[N\] do not drive, such as a ball that turns in a
/// smooth hollow one. The loads say nothing about them; Newton's method stops them
/// (method book, eq. 21.12).
pub(super) fn drifts(
    model: &Model,
    t: f64,
    u: &[f64],
    contacts: &[ContactRow],
    force: &[f64],
) -> Vec<Vec<f64>> {
    if contacts.is_empty() {
        return Vec::new();
    }
    let bodies = model.bodies.iter().max().map_or(0, |&last| last + 1);
    let place = |(node, along): (u32, Vector3)| (node, model.positions[node as usize], along);
    let held: Vec<_> = prescribed(model, t).into_iter().map(place).collect();
    let held: Vec<_> = held.into_iter().chain(model.following.held()).collect();
    let mut drifts = Vec::new();
    for body in 0..bodies {
        let own = |node: u32| model.bodies[node as usize] == body;
        let held = held.iter().filter(|(node, ..)| own(*node));
        let held = held.map(|(_, place, along)| (*place, *along));
        let touching = contacts.iter().filter(|row| own(row.node));
        let touching =
            touching.map(|row| (model.contact.place(row.node, &model.positions, u), row.along));
        let rows: Vec<(Vector3, Vector3)> = held.chain(touching).collect();
        if !rows.is_empty() {
            let motions = rigid_motions_beside(model, &rows, ALONG);
            drifts.extend(motions.iter().map(|motion| drift_of(model, body, u, motion)));
        }
    }
    drifts.retain(|drift| !is_driven(drift, force));
    drifts
}

/// A rigid motion of one body.
fn drift_of(
    model: &Model,
    body: u32,
    u: &[f64],
    motion: &impl Fn(&Vector3) -> Vector3,
) -> Vec<f64> {
    let d = model.components;
    let mut drift = Vec::with_capacity(model.size());
    for (node, X) in model.positions.iter().enumerate() {
        let velocity = if model.bodies[node] == body {
            motion(&(X + vector_at(u, node, d)))
        } else {
            Vector3::zeros()
        };
        drift.extend((0..d).map(|k| velocity[k]));
    }
    drift
}

fn is_driven(drift: &[f64], force: &[f64]) -> bool {
    let sizes: f64 = drift.iter().zip(force).map(|(v, f)| (v * f).abs()).sum();
    dot(drift, force).abs() > DRIVEN * sizes
}
