//! Rigid motions that nothing prevents.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::model::Model;
use nalgebra::{DMatrix, DVector};

/// Number of rigid motions that the conditions at time `t` \[s\] and the contacts that are
/// closed at displacements `u` \[component of node\] \[m\] leave free: the dimension of
/// their kernel in the rigid motions. A closed contact counts as if it could not open.
pub fn free_rigid_motions(model: &Model, t: f64, u: &[f64]) -> usize {
    let mut rows = prescribed(model, t);
    rows.extend(model.contact.closed(&model.positions, u));
    kernel(model, &rows)
}

/// Number of rigid motions that the conditions at time `t` \[s\] leave to contact.
pub fn rigid_motions_left_to_contact(model: &Model, t: f64) -> usize {
    kernel(model, &prescribed(model, t))
}

/// Places and directions of what the conditions prescribe.
fn prescribed(model: &Model, t: f64) -> Vec<(Vector3, Vector3)> {
    let mut rows: Vec<(Vector3, Vector3)> = Vec::new();
    for set in model.constraints.active(t) {
        let along = Vector3::ith(set.component, 1.0);
        rows.extend(set.rows.iter().map(|row| (model.positions[row.node as usize], along)));
    }
    rows
}

/// Dimension of the rigid motions without a component along any of the rows (place,
/// direction).
fn kernel(model: &Model, rows: &[(Vector3, Vector3)]) -> usize {
    let motions = rigid_motions(model.components, model.extent);
    let mut products = DMatrix::<f64>::zeros(motions.len(), motions.len());
    for (X, along) in rows {
        let X = X - model.positions[0];
        let values = motions.iter().map(|motion| motion(&X).dot(along));
        let values = DVector::from_iterator(motions.len(), values);
        products.ger(1.0, &values, &values, 1.0);
    }
    let small = 1e-10 * (rows.len() as f64).max(1.0);
    products.symmetric_eigenvalues().iter().filter(|&&value| value < small).count()
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
