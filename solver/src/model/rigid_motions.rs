//! Rigid motions that nothing prevents.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::model::Model;
use nalgebra::{DMatrix, DVector};

/// Number of rigid motions that the conditions at time `t` \[s\] and the contacts that are
/// closed at displacements `u` \[component of node\] \[m\] leave free: the dimension of
/// their kernel in the rigid motions. A closed contact counts as if it could not open.
pub fn free_rigid_motions(model: &Model, t: f64, u: &[f64]) -> usize {
    let mut rows = held_places(model, t);
    rows.extend(model.contact.closed(&model.positions, t, u));
    kernel(model, &rows)
}

/// A separate piece of the body, and how many of its rigid motions are free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreePiece {
    /// Its number in [`Model::bodies`].
    pub body: u32,
    /// Number of rigid motions that nothing prevents.
    pub motions: usize,
}

/// The pieces of a body of several whose rigid motions the conditions at time `t` \[s\] do not
/// all prevent, each for itself. Of a body in one piece see [`free_rigid_motions`].
pub fn free_pieces(model: &Model, t: f64) -> Vec<FreePiece> {
    let count = model.bodies.iter().max().map_or(0, |&last| last + 1);
    let rows = held_of_pieces(model, t, count);
    let piece = |(rows, body): (&Vec<(Vector3, Vector3)>, u32)| {
        let motions = kernel(model, rows);
        (motions > 0).then_some(FreePiece { body, motions })
    };
    rows.iter().zip(0..).filter_map(piece).collect()
}

/// The free rigid motions \[component of node\] of each piece of a body for itself, under the
/// conditions of time `t` \[s\]. Each has displacements of about 1 over the extent.
pub(crate) fn free_rigid_fields(model: &Model, t: f64) -> Vec<Vec<f64>> {
    let pieces = model.bodies.iter().max().map_or(0, |&last| last + 1);
    let rows = held_of_pieces(model, t, pieces);
    let mut fields = Vec::new();
    for (rows, piece) in rows.iter().zip(0..) {
        for motion in rigid_motions_beside(model, rows, ROUND_OFF) {
            let still = Vector3::zeros();
            let of_node =
                |(X, own): (&Vector3, &u32)| if *own == piece { motion(X) } else { still };
            let values = model.positions.iter().zip(&model.bodies).map(of_node);
            let components = |value: Vector3| (0..model.components).map(move |k| value[k]);
            fields.push(values.flat_map(components).collect());
        }
    }
    fields
}

/// Number of rigid motions that the conditions at time `t` \[s\] leave to contact.
pub fn rigid_motions_left_to_contact(model: &Model, t: f64) -> usize {
    kernel(model, &held_places(model, t))
}

/// Nodes and directions of what the conditions prescribe.
pub(crate) fn prescribed(model: &Model, t: f64) -> Vec<(u32, Vector3)> {
    let mut rows: Vec<(u32, Vector3)> = Vec::new();
    for set in model.constraints.active(t) {
        let along = Vector3::ith(set.component, 1.0);
        rows.extend(set.rows.iter().map(|row| (row.node, along)));
    }
    rows
}

/// Places and directions of what conditions and springs hold.
fn held_places(model: &Model, t: f64) -> Vec<(Vector3, Vector3)> {
    held_of_pieces(model, t, 1).remove(0)
}

/// The same of each of some pieces; all of them in one list where there is only one.
fn held_of_pieces(model: &Model, t: f64, pieces: u32) -> Vec<Vec<(Vector3, Vector3)>> {
    let mut rows = vec![Vec::new(); pieces.max(1) as usize];
    let mut add = |node: u32, place: Vector3, along: Vector3| {
        let piece = if pieces > 1 { model.bodies[node as usize] } else { 0 };
        rows[piece as usize].push((place, along));
    };
    for (node, along) in prescribed(model, t) {
        add(node, model.positions[node as usize], along);
    }
    model.following.held().for_each(|(node, place, along)| add(node, place, along));
    rows
}

/// Dimension of the rigid motions without a component along any of the rows (place,
/// direction).
fn kernel(model: &Model, rows: &[(Vector3, Vector3)]) -> usize {
    rigid_motions_beside(model, rows, ROUND_OFF).len()
}

/// Square of a component along a row, in the mean, that is none \[–\].
const ROUND_OFF: f64 = 1e-10;

/// A basis of the rigid motions whose components along the rows (place \[m\], direction)
/// are none: the mean of their squares is below `small`. Each has displacements of about 1
/// over the extent, as a function of the place.
pub(crate) fn rigid_motions_beside(
    model: &Model,
    rows: &[(Vector3, Vector3)],
    small: f64,
) -> Vec<impl Fn(&Vector3) -> Vector3> {
    let motions = std::rc::Rc::new(rigid_motions(model.components, model.extent));
    let mut products = DMatrix::<f64>::zeros(motions.len(), motions.len());
    let origin = model.positions[0];
    for (X, along) in rows {
        let X = X - origin;
        let values = motions.iter().map(|motion| motion(&X).dot(along));
        let values = DVector::from_iterator(motions.len(), values);
        products.ger(1.0, &values, &values, 1.0);
    }
    let small = small * (rows.len() as f64).max(1.0);
    let eigen = products.symmetric_eigen();
    let found = (0..motions.len()).filter(|&mode| eigen.eigenvalues[mode] < small);
    let combined = found.map(|mode| {
        let (motions, factors) = (motions.clone(), eigen.eigenvectors.column(mode).into_owned());
        move |X: &Vector3| {
            let terms = motions.iter().zip(&factors);
            terms.map(|(motion, factor)| motion(&(X - origin)) * *factor).sum()
        }
    });
    combined.collect()
}

type Motion = Box<dyn Fn(&Vector3) -> Vector3>;

/// Translations and rotations about the origin with displacements of size 1 over the
/// extent.
fn rigid_motions(d: usize, extent: f64) -> Vec<Motion> {
    let unit = |k: usize| Vector3::ith(k, 1.0);
    let mut motions: Vec<Motion> = Vec::new();
    for k in 0..d {
        motions.push(Box::new(move |_| unit(k)));
    }
    for k in if d == 3 { 0..3 } else { 2..3 } {
        motions.push(Box::new(move |X| unit(k).cross(X) / extent));
    }
    motions
}
