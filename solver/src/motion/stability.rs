//! Loss of stability, seen in the motion itself or searched among smooth modes.
#![allow(non_snake_case)]

use crate::algebra::packed::{axpy, largest};
use crate::algebra::tensor::{Vector3, vector_at};
use crate::error::{Error, Instability};
use crate::geometry::indices;
use crate::model::Model;
use crate::model::essential::ConstraintForces;
use crate::motion::internal_force::Workspace;
use crate::motion::state::State;
use crate::motion::tangent::Tangent;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Δu·Δf_int of a step between displacements that the conditions leave free, which is
/// Δuᵀ K Δu with a mean tangent K (method book, eq. 20.6).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Curvature {
    /// Sum over all components \[J\].
    pub work: f64,
    /// Sum of their sizes \[J\].
    pub sizes: f64,
}

impl Curvature {
    fn is_negative(&self) -> bool {
        self.work < NEGATIVE * self.sizes
    }
}

/// Curvature over the sum of sizes below which it is negative for certain, not by
/// round-off \[–\].
const NEGATIVE: f64 = -1e-6;
/// Negative curvatures in turn that show a motion away from an unstable equilibrium.
const IN_TURN: usize = 3;

/// Watches a static run for loss of stability.
#[derive(Debug, Default)]
pub(crate) struct Stability {
    in_turn: usize,
    /// The first one.
    pub found: Option<Instability>,
}

impl Stability {
    /// Takes the curvature along a change of displacement over time \[m/s\].
    pub fn observe(&mut self, model: &Model, state: &State, change: &[f64], curvature: Curvature) {
        self.in_turn = if curvature.is_negative() { self.in_turn + 1 } else { 0 };
        if self.in_turn == IN_TURN && self.found.is_none() {
            self.found = Some(instability(model, state, change));
        }
    }

    /// Looks for a mode away from the equilibrium that has been reached; returns the
    /// number of products with the tangent.
    pub fn search(&mut self, model: &Model, state: &State, workspace: &mut Workspace) -> usize {
        let State { displacement, time, contact, .. } = state;
        let (products, mode) =
            negative_mode(model, displacement, *time, &contact.touching, workspace);
        match (&mut self.found, mode) {
            (Some(found), mode) => found.passed = mode.is_none(),
            (None, mode) => self.found = mode.map(|mode| instability(model, state, &mode)),
        }
        products
    }

    /// An error of the run with the instability that led to it.
    pub fn explain(&self, error: Error) -> Error {
        match &self.found {
            Some(found) => Error::Unstable { instability: found.clone(), then: Box::new(error) },
            None => error,
        }
    }
}

/// Highest total degree of the fields in which a negative mode is searched.
const DEGREE: i32 = 2;

/// A mode of the tangent with negative curvature at displacements `u` \[m\] under the
/// conditions of time `t` \[s\], among fields that are polynomials times the distances to the
/// nodes that each condition holds in their component, and to those `touching` obstacles: bodies buckle and topple in such smooth modes, which
/// iterations from a random start would find last. The first number is that of products
/// with the tangent (method book, eq. 20.7).
pub(crate) fn negative_mode(
    model: &Model,
    u: &[f64],
    t: f64,
    touching: &[u32],
    workspace: &mut Workspace,
) -> (usize, Option<Vec<f64>>) {
    let mut tangent = Tangent::new(model, u, t, workspace);
    let fields = smooth_fields(model, t, touching);
    let images: Vec<Vec<f64>> = fields.iter().map(|field| tangent.stiffness_times(field)).collect();
    let n = fields.len();
    let columns = |fields: &[Vec<f64>]| DMatrix::from_iterator(u.len(), n, fields.concat());
    let (all, images) = (columns(&fields), columns(&images));
    let gram = all.tr_mul(&all);
    let products = all.tr_mul(&images);
    let form = 0.5 * (&products + products.transpose());
    // Orthonormal, without directions of round-off.
    let gram = gram.symmetric_eigen();
    let kept: Vec<usize> =
        (0..n).filter(|&i| gram.eigenvalues[i] > 1e-9 * gram.eigenvalues.max()).collect();
    if kept.is_empty() {
        return (n, None);
    }
    let basis = DMatrix::from_fn(n, kept.len(), |i, j| {
        gram.eigenvectors[(i, kept[j])] / gram.eigenvalues[kept[j]].sqrt()
    });
    let eigen = (basis.transpose() * form * &basis).symmetric_eigen();
    let weights = basis * eigen.eigenvectors.column(eigen.eigenvalues.imin());
    let mut mode = vec![0.0; u.len()];
    (0..n).for_each(|i| axpy(&mut mode, weights[i], &fields[i]));
    let image = tangent.stiffness_times(&mode);
    let works = mode.iter().zip(&image).map(|(u, f)| u * f);
    let curvature = Curvature { work: works.clone().sum(), sizes: works.map(f64::abs).sum() };
    (n + 1, curvature.is_negative().then_some(mode))
}

/// Fields of one component each that the conditions allow \[field\]\[component of node\].
fn smooth_fields(model: &Model, t: f64, touching: &[u32]) -> Vec<Vec<f64>> {
    let d = model.components;
    let powers: Vec<[i32; 3]> = indices([DEGREE as usize + 1; 3])
        .map(|powers| powers.map(|power| power as i32))
        .filter(|[i, j, k]| i + j + k <= DEGREE && (d == 3 || *k == 0))
        .collect();
    let mut forces = ConstraintForces::default();
    let mut fields = Vec::new();
    let (mut known, mut distances) = (None, Vec::new());
    for component in 0..d {
        let groups = held_nodes(model, t, component, touching);
        if known.as_ref() != Some(&groups) {
            distances = distances_to(model, &groups);
            known = Some(groups);
        }
        for [i, j, k] in &powers {
            let mut field = vec![0.0; model.size()];
            for (node, X) in model.positions.iter().enumerate() {
                let x = (X - model.positions[0]) / model.extent;
                field[d * node + component] =
                    distances[node] * x.x.powi(*i) * x.y.powi(*j) * x.z.powi(*k);
            }
            model.constraints.project(t, &model.inertia, &mut field, &mut forces);
            fields.push(field);
        }
    }
    fields
}

/// The nodes that each condition holds in a component, and those that touch.
fn held_nodes(model: &Model, t: f64, component: usize, touching: &[u32]) -> Vec<Vec<u32>> {
    let mut groups = vec![Vec::new(); model.constraints.conditions.len()];
    for set in model.constraints.active(t).iter().filter(|set| set.component == component) {
        set.rows.iter().for_each(|row| groups[row.condition as usize].push(row.node));
    }
    groups.push(touching.to_vec());
    groups.retain(|group| !group.is_empty());
    groups
}

/// The product of the distances of each node to some groups, as smooth as those are: the
/// least of them has a kink between two held ends, whose energy hides that a column buckles.
fn distances_to(model: &Model, groups: &[Vec<u32>]) -> Vec<f64> {
    let mut product = vec![1.0; model.positions.len()];
    for group in groups {
        let distances = distance_to(model, group);
        product.iter_mut().zip(&distances).for_each(|(all, distance)| *all *= distance);
    }
    product
}

/// Distance of each node to the nearest of some, over the size of the body.
fn distance_to(model: &Model, nodes: &[u32]) -> Vec<f64> {
    let held: Vec<Vector3> = nodes.iter().map(|&node| model.positions[node as usize]).collect();
    let distance = |X: &Vector3| {
        let squares = held.iter().map(|Y| (X - Y).norm_squared());
        let least = squares.fold(f64::INFINITY, |least, d| if d < least { d } else { least });
        least.sqrt() / model.extent
    };
    model.positions.par_iter().map(distance).collect()
}

fn instability(model: &Model, state: &State, motion: &[f64]) -> Instability {
    let (node, _) = fastest_node(model, motion);
    let size = largest(motion).max(f64::MIN_POSITIVE);
    Instability {
        step: state.step,
        node,
        position: model.positions[node],
        mode: motion.iter().map(|u| u / size).collect(),
        passed: false,
    }
}

/// The node with the largest velocity, and that \[m/s\].
pub(crate) fn fastest_node(model: &Model, velocity: &[f64]) -> (usize, f64) {
    let speed = |node: usize| vector_at(velocity, node, model.components).norm();
    let fastest = (0..model.positions.len()).max_by(|&a, &b| speed(a).total_cmp(&speed(b)));
    fastest.map_or((0, 0.0), |node| (node, speed(node)))
}
