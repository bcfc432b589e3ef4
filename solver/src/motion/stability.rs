//! Loss of stability, seen in the motion itself or searched among smooth modes.
#![allow(non_snake_case)]

use crate::algebra::packed::{axpy, dot, largest};
use crate::algebra::tensor::{Vector3, vector_at};
use crate::error::{Error, Instability};
use crate::force::Workspace;
use crate::geometry::indices;
use crate::model::Model;
use crate::model::essential::ConstraintForces;
use crate::motion::state::State;
use crate::motion::tangent::Tangent;
use nalgebra::{DMatrix, DVector};
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
    /// Products with the tangent that looked for it.
    pub products: usize,
}

/// An equilibrium.
#[derive(Clone, Copy)]
pub(crate) struct Here<'a> {
    pub step: usize,
    /// \[s\]
    pub time: f64,
    /// \[m\]
    pub displacement: &'a [f64],
    /// Nodes in contact.
    pub touching: &'a [u32],
    /// Free unbalanced forces \[N\], where they are known.
    pub unbalanced: Option<&'a [f64]>,
}

impl<'a> Here<'a> {
    /// That of a state.
    pub fn of(state: &'a State) -> Here<'a> {
        let State { step, time, displacement, contact, .. } = state;
        Here {
            step: *step,
            time: *time,
            displacement,
            touching: &contact.touching,
            unbalanced: None,
        }
    }
}

/// A motion, and the work of the tangent along it.
pub(crate) struct Mode {
    pub motion: Vec<f64>,
    pub curvature: Curvature,
}

impl Stability {
    /// Takes the curvature along a change of displacement over time \[m/s\].
    pub fn observe(&mut self, model: &Model, state: &State, change: &[f64], curvature: Curvature) {
        self.in_turn = if curvature.is_negative() { self.in_turn + 1 } else { 0 };
        if self.in_turn == IN_TURN && self.found.is_none() {
            self.found = Some(instability(model, state.step, change));
        }
    }

    /// Looks for a mode away from the equilibrium that has been reached.
    pub fn search(
        &mut self,
        model: &Model,
        here: Here,
        workspace: &mut Workspace,
    ) -> Option<Vec<f64>> {
        let mode = self.softest(model, here, workspace).filter(|mode| mode.curvature.is_negative());
        match (&mut self.found, &mode) {
            (Some(found), mode) => found.passed = mode.is_none(),
            (None, Some(mode)) => self.found = Some(instability(model, here.step, &mode.motion)),
            (None, None) => {}
        }
        mode.map(|mode| mode.motion)
    }

    /// The softest mode of the equilibrium that has been reached.
    pub fn softest(
        &mut self,
        model: &Model,
        here: Here,
        workspace: &mut Workspace,
    ) -> Option<Mode> {
        let (products, mode) = softest_mode(model, here, workspace);
        self.products += products;
        mode
    }

    /// The body has left an equilibrium along a motion.
    pub fn left(&mut self, model: &Model, step: usize, motion: &[f64]) {
        self.found.get_or_insert_with(|| instability(model, step, motion)).passed = true;
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

/// The mode of the tangent with the least curvature at an equilibrium, among fields that are polynomials times the distances to the
/// nodes that each condition holds in their component, and to those `touching` obstacles: bodies buckle and topple in such smooth modes, which
/// iterations from a random start would find last. The first number is that of products
/// with the tangent (method book, eq. 20.7).
fn softest_mode(model: &Model, here: Here, workspace: &mut Workspace) -> (usize, Option<Mode>) {
    let u = here.displacement;
    let mut tangent = Tangent::new(model, u, here.time, workspace);
    let fields = smooth_fields(model, here.time, here.touching);
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
    let (least, most) = (eigen.eigenvalues.min(), eigen.eigenvalues.amax());
    let alike = |&k: &usize| eigen.eigenvalues[k] - least <= ALIKE.0 * least.abs() + ALIKE.1 * most;
    let softest: Vec<usize> = (0..kept.len()).filter(alike).collect();
    let modes = basis * eigen.eigenvectors.select_columns(&softest);
    let weights = &modes * weights_of(model, here, least, &(&all * &modes));
    let mut motion = vec![0.0; u.len()];
    (0..n).for_each(|i| axpy(&mut motion, weights[i], &fields[i]));
    let image = tangent.stiffness_times(&motion);
    let works = motion.iter().zip(&image).map(|(u, f)| u * f);
    let curvature = Curvature { work: works.clone().sum(), sizes: works.map(f64::abs).sum() };
    (n + 1, Some(Mode { motion, curvature }))
}

/// Differences of curvatures over the least and over the largest that count as none \[–\].
const ALIKE: (f64, f64) = (1e-3, 1e-9);
/// Displacements along a motion over those that unbalanced forces may have made, and over all, from
/// which they are no round-off \[–\].
const CERTAIN: (f64, f64) = (10.0, 1e-9);

/// Weights of orthonormal motions, columns, of the curvature `least` \[N/m\], in the motion to look
/// at: the part of the displacements in them, or where that is round-off, of a field without a
/// symmetry. Round-off would choose otherwise to which side a body buckles.
fn weights_of(model: &Model, here: Here, least: f64, motions: &DMatrix<f64>) -> DVector<f64> {
    let part = |field: &[f64]| motions.tr_mul(&DVector::from_column_slice(field));
    let (u, d) = (here.displacement, model.components);
    let moved = part(u);
    let by_chance = here.unbalanced.map_or(f64::INFINITY, |force| part(force).norm() / least.abs());
    let round_off = CERTAIN.1 * dot(u, u).sqrt();
    if moved.norm() > CERTAIN.0 * by_chance + round_off {
        return moved.normalize();
    }
    let slanted = (0..u.len()).map(|i| {
        let x = (model.positions[i / d] - model.positions[0]) / model.extent;
        [1.0, 0.61, 0.37][i % d] * (1.0 + 0.43 * x.x + 0.29 * x.y + 0.19 * x.z)
    });
    let along = part(&slanted.collect::<Vec<f64>>());
    if along.norm() > 0.0 { along.normalize() } else { DVector::from_element(motions.ncols(), 1.0) }
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

fn instability(model: &Model, step: usize, motion: &[f64]) -> Instability {
    let (node, _) = fastest_node(model, motion);
    let size = largest(motion).max(f64::MIN_POSITIVE);
    Instability {
        step,
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
