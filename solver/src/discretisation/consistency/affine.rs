//! Affine fields on each connected body: the kernel of the operator.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::moments::homogeneous;
use nalgebra::{Matrix4, Matrix4x3, Vector4};

/// Affine functions on each body, orthonormal over its nodes.
pub(super) struct Affine<'a> {
    bodies: &'a [u32],
    /// The functions of its body at each node.
    values: Vec<Vector4<f64>>,
    /// Number of bodies.
    pub count: usize,
}

impl Affine<'_> {
    pub fn new<'a>(positions: &[Vector3], bodies: &'a [u32]) -> Affine<'a> {
        let count = bodies.iter().max().map_or(0, |&last| last as usize + 1);
        let bases: Vec<(Vector3, f64, Matrix4<f64>)> = (0..count as u32)
            .map(|body| {
                let own = || positions.iter().zip(bodies).filter(move |(_, b)| **b == body);
                let centre = own().map(|(X, _)| X).sum::<Vector3>() / own().count() as f64;
                let length =
                    own().map(|(X, _)| (X - centre).norm()).fold(f64::MIN_POSITIVE, f64::max);
                let mut gram = Matrix4::zeros();
                for (X, _) in own() {
                    let p = homogeneous(&((X - centre) / length));
                    gram += p * p.transpose();
                }
                // An empty direction, as across a plane, stays empty.
                for k in 0..4 {
                    if gram[(k, k)] < 1e-20 {
                        gram[(k, k)] = 1.0;
                    }
                }
                let inverse = gram
                    .cholesky()
                    .and_then(|factor| factor.l().try_inverse())
                    .unwrap_or_else(Matrix4::zeros);
                (centre, length, inverse)
            })
            .collect();
        let value = |(X, body): (&Vector3, &u32)| {
            let (centre, length, inverse) = &bases[*body as usize];
            inverse * homogeneous(&((X - centre) / *length))
        };
        Affine { bodies, values: positions.iter().zip(bodies).map(value).collect(), count }
    }

    /// Removes the affine part of a nodal field.
    pub fn project(&self, field: &mut [Vector3]) {
        let mut parts = vec![Matrix4x3::<f64>::zeros(); self.count];
        for ((value, p), body) in field.iter().zip(&self.values).zip(self.bodies) {
            parts[*body as usize].ger(1.0, p, value, 1.0);
        }
        for ((value, p), body) in field.iter_mut().zip(&self.values).zip(self.bodies) {
            *value -= parts[*body as usize].tr_mul(p);
        }
    }
}
