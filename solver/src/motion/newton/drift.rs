//! Rigid motions along closed contacts that nothing drives.
#![allow(non_snake_case)]

use super::free_space::{ContactRow, place};
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

/// Rigid motions \[component of node\] that neither the conditions nor the closed contacts
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
    let mut rows = prescribed(model, t);
    rows.extend(contacts.iter().map(|row| (place(model, row.node, u), row.along)));
    let d = model.components;
    let motions = rigid_motions_beside(model, &rows, ALONG).into_iter().map(|motion| {
        let mut drift = Vec::with_capacity(model.size());
        for (node, X) in model.positions.iter().enumerate() {
            let velocity: Vector3 = motion(&(X + vector_at(u, node, d)));
            drift.extend((0..d).map(|k| velocity[k]));
        }
        drift
    });
    motions.filter(|drift| !is_driven(drift, force)).collect()
}

fn is_driven(drift: &[f64], force: &[f64]) -> bool {
    let sizes: f64 = drift.iter().zip(force).map(|(v, f)| (v * f).abs()).sum();
    dot(drift, force).abs() > DRIVEN * sizes
}
