//! Affine fields on each connected body: what the operator does not see.
#![allow(non_snake_case)]

use crate::moments::homogeneous;
use crate::rows::Rows;
use crate::tensor::Vector3;
use nalgebra::{Matrix4, Matrix4x3};

/// Affine functions on each body, orthonormal over its nodes.
pub(super) struct Affine<'a> {
    bodies: &'a [u32],
    positions: &'a [Vector3],
    /// Centre, length and inverse Cholesky factor of each body.
    pub bases: Vec<(Vector3, f64, Matrix4<f64>)>,
}

impl Affine<'_> {
    pub fn new<'a>(positions: &'a [Vector3], bodies: &'a [u32]) -> Affine<'a> {
        let count = bodies.iter().max().map_or(0, |&last| last as usize + 1);
        let bases = (0..count as u32)
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
        Affine { bodies, positions, bases }
    }

    /// Takes the affine part out of a nodal field.
    pub fn project(&self, field: &mut [Vector3]) {
        let basis = |node: usize| {
            let (centre, length, inverse) = &self.bases[self.bodies[node] as usize];
            inverse * homogeneous(&((self.positions[node] - centre) / *length))
        };
        let mut parts = vec![Matrix4x3::<f64>::zeros(); self.bases.len()];
        for (node, value) in field.iter().enumerate() {
            parts[self.bodies[node] as usize] += basis(node) * value.transpose();
        }
        for (node, value) in field.iter_mut().enumerate() {
            *value -= parts[self.bodies[node] as usize].tr_mul(&basis(node));
        }
    }
}

/// The connected body of each node: nodes that share a support are joined.
pub fn connected_bodies(rows: &Rows, nodes: usize) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..nodes as u32).collect();
    fn root(parent: &mut [u32], mut node: u32) -> u32 {
        while parent[node as usize] != node {
            parent[node as usize] = parent[parent[node as usize] as usize];
            node = parent[node as usize];
        }
        node
    }
    for q in 0..rows.len() {
        let row = rows.row(q);
        let first = root(&mut parent, rows.nodes[row.start]);
        for entry in row {
            let other = root(&mut parent, rows.nodes[entry]);
            parent[first.max(other) as usize] = first.min(other);
        }
    }
    let mut number = vec![u32::MAX; nodes];
    let mut count = 0;
    (0..nodes as u32)
        .map(|node| {
            let root = root(&mut parent, node) as usize;
            if number[root] == u32::MAX {
                number[root] = count;
                count += 1;
            }
            number[root]
        })
        .collect()
}
