//! Moving least squares on a cloud: φ and Grad φ at a point.
#![allow(non_snake_case)]

use crate::algebra::lanes::with_vectors;
use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::inverse::{inverse, norm_1};
use crate::discretisation::mls::regularised::{linear_part, regularise, restore_linear};
use crate::discretisation::mls::sides::{Sides, Stiffness};
use crate::discretisation::mls::sums::{fill, moment_matrix, slope_moments, weigh};
use crate::discretisation::mls::support::{Near, PoorSupport, Scratch, Support, dimension};
use crate::discretisation::mls::visibility::Visibility;
use crate::discretisation::neighbours::Neighbours;
use crate::geometry::Shape;
use crate::problem::{Basis, Dimension, WeightFunction};
use fearless_simd::{Level, Simd, f64x4, prelude::*};
use nalgebra::SVector;

/// Nodes with their influence domains, ready to be evaluated anywhere.
#[derive(Debug, Clone)]
pub struct Approximation {
    /// Reference positions \[node\] \[m\].
    pub nodes: Vec<Vector3>,
    /// \[node\] \[m\]
    pub influence_radius: Vec<f64>,
    /// Polynomial basis.
    pub basis: Basis,
    /// Weight function of all nodes.
    pub weight_function: WeightFunction,
    components: usize,
    /// Where points do not see all nodes around them.
    sides: Option<Sides>,
    /// Where gaps of the body bar the way to some of them.
    visibility: Option<Visibility>,
    smallest_radius: f64,
    largest_radius: f64,
    neighbours: Neighbours,
    /// How far away nodes may be that cover a point of each cell of `neighbours` \[m\]; empty
    /// where all radii are equal.
    reaches: Vec<f64>,
}

/// Influence radii are enlarged at a point by at most this factor.
pub const LARGEST_ENLARGEMENT: f64 = 2.0;

impl Approximation {
    /// From reference positions \[node\] \[m\] and influence radii \[node\] \[m\].
    pub fn new(
        nodes: Vec<Vector3>,
        influence_radius: Vec<f64>,
        basis: Basis,
        weight_function: WeightFunction,
        dimension: &Dimension,
    ) -> Approximation {
        let smallest_radius = influence_radius.iter().fold(f64::INFINITY, |a, &b| a.min(b));
        let largest_radius = influence_radius.iter().fold(0.0f64, |a, &b| a.max(b));
        let mean = influence_radius.iter().sum::<f64>() / influence_radius.len() as f64;
        let neighbours = Neighbours::new(&nodes, 0.6 * mean);
        let components = dimension.components();
        let reaches = match smallest_radius == largest_radius {
            true => Vec::new(),
            false => neighbours.reaches(&influence_radius),
        };
        Approximation {
            nodes,
            influence_radius,
            basis,
            weight_function,
            components,
            sides: None,
            visibility: None,
            smallest_radius,
            largest_radius,
            neighbours,
            reaches,
        }
    }

    /// No node farther away covers X \[m\] with radii enlarged by a factor.
    fn reach(&self, X: &Vector3, enlargement: f64) -> f64 {
        match self.reaches.is_empty() || enlargement > 1.0 {
            true => self.largest_radius * enlargement,
            false => self.reaches[self.neighbours.cell_of(X)],
        }
    }

    /// The same where points do not see nodes that are softer than they are.
    /// Radii are `dilation` spacings.
    pub fn with_sides(self, stiffness: Stiffness, dilation: f64) -> Approximation {
        let spacing: Vec<f64> = self.influence_radius.iter().map(|r| r / dilation).collect();
        let sides = Some(Sides::new(stiffness, &self.nodes, &spacing));
        Approximation { sides, ..self }
    }

    /// The same where points see nodes through the body only. Radii are `dilation` spacings.
    pub fn within(self, body: &Shape, dilation: f64) -> Approximation {
        let Approximation { nodes, influence_radius, neighbours, .. } = &self;
        let visibility = Visibility::new(body, nodes, influence_radius, neighbours, dilation);
        Approximation { visibility, ..self }
    }

    /// Whether a gap of the body bars the way from some node around X \[m\] to another.
    pub fn is_beside_gap(&self, X: &Vector3) -> bool {
        let Some(visibility) = &self.visibility else { return false };
        let mut beside = false;
        self.neighbours.for_each_within(X, self.reach(X, 1.0), |node, _| {
            beside |= visibility.is_beside_gap(node);
        });
        beside
    }

    /// Middle \[m\] and width \[m\] of the widest gap between X \[m\] and one of some nodes.
    pub(crate) fn widest_gap(&self, X: &Vector3, nodes: &[u32]) -> Option<(Vector3, f64)> {
        self.visibility.as_ref()?.widest_gap(X, nodes)
    }

    /// Mean nodal spacing around X where gaps were looked for \[m\].
    pub(crate) fn mean_spacing(&self, X: &Vector3) -> f64 {
        let dilation = self.visibility.as_ref().map_or(1.0, Visibility::dilation);
        self.mean_radius(X) / dilation
    }

    /// Drops the nodes of an ascending list that X \[m\] does not see through the body.
    pub(crate) fn keep_seen(&self, X: &Vector3, nodes: &mut Vec<u32>) {
        if let Some(visibility) = &self.visibility {
            visibility.keep_seen(X, nodes);
        }
    }

    /// Number of monomials in the basis.
    pub fn basis_size(&self) -> usize {
        match (self.basis, self.components) {
            (Basis::Linear, d) => d + 1,
            (Basis::Quadratic | Basis::ModifiedQuadratic { .. }, 2) => 6,
            (Basis::Quadratic | Basis::ModifiedQuadratic { .. }, _) => 10,
        }
    }

    /// Fewest nodes that a support may have (method book, eq. 6.6): twice the
    /// linear basis where the rest is absent or regularised, one and a half
    /// times the basis where it is quadratic.
    pub fn smallest_support(&self) -> usize {
        match self.basis {
            Basis::Linear | Basis::ModifiedQuadratic { .. } => 2 * (self.components + 1),
            Basis::Quadratic => self.basis_size() * 3 / 2,
        }
    }

    /// Largest accepted condition number of the moment matrix; of its linear
    /// part where the rest is regularised.
    pub fn largest_condition(&self) -> f64 {
        match self.basis {
            Basis::Linear | Basis::ModifiedQuadratic { .. } => 1e4,
            Basis::Quadratic => 1e6,
        }
    }

    /// Mean influence radius of the nodes that cover X \[m\]; that of all nodes
    /// where none does.
    pub fn mean_radius(&self, X: &Vector3) -> f64 {
        if self.smallest_radius == self.largest_radius {
            return self.largest_radius;
        }
        let (mut sum, mut count) = (0.0, 0.0);
        self.neighbours.for_each_within(X, self.reach(X, 1.0), |node, offset| {
            let radius = self.influence_radius[node];
            if offset.norm_squared() < radius * radius {
                sum += radius;
                count += 1.0;
            }
        });
        match count > 0.0 {
            true => sum / count,
            false => self.influence_radius.iter().sum::<f64>() / self.influence_radius.len() as f64,
        }
    }

    /// The smallest influence radius of the nodes within `reach` of X \[m\]; the mean of
    /// those that cover it where there is none.
    pub fn smallest_radius_within(&self, X: &Vector3, reach: f64) -> f64 {
        let mut smallest = f64::INFINITY;
        self.for_each_node_within(X, reach, |node, _| {
            smallest = smallest.min(self.influence_radius[node as usize]);
        });
        if smallest.is_finite() { smallest } else { self.mean_radius(X) }
    }

    /// Calls `visit(node, distance)` for every node within `radius` of X \[m\].
    pub(crate) fn for_each_node_within(
        &self,
        X: &Vector3,
        radius: f64,
        mut visit: impl FnMut(u32, f64),
    ) {
        self.neighbours.for_each_within(X, radius, |node, offset| {
            let distance = offset.norm();
            if distance < radius {
                visit(node as u32, distance);
            }
        });
    }

    /// The largest influence radius \[m\].
    pub fn largest_radius(&self) -> f64 {
        self.largest_radius
    }

    /// φ_a(X) = w_a pᵀ(X_a) A⁻¹(X) p(X) and its full derivatives (Lancaster,
    /// Salkauskas 1981; Belytschko, Lu, Gu 1994, eqs. 9–18; method book,
    /// eqs. 6.2 and 6.3). Where the support is poor the radii are enlarged in
    /// steps of 10 %; where it stays poor with the nodes of one side of a border, those of
    /// both are seen, and where it does with those on one side of a gap, all are.
    pub fn evaluate(&self, X: &Vector3) -> Result<Support, PoorSupport> {
        let mut support = Support::default();
        self.evaluate_into(X, &mut Scratch::default(), &mut support)?;
        Ok(support)
    }

    /// As [`Approximation::evaluate`] into memory that is reused; after an error
    /// the support is empty.
    pub(crate) fn evaluate_into(
        &self,
        X: &Vector3,
        scratch: &mut Scratch,
        support: &mut Support,
    ) -> Result<(), PoorSupport> {
        if let Some(sides) = &self.sides {
            let softest = sides.softest_seen(X);
            let seen = |node: u32| sides.is_seen(node, softest);
            if self.evaluate_seeing(X, seen, true, scratch, support).is_ok() {
                return Ok(());
            }
        }
        let result = self.evaluate_seeing(X, |_| true, true, scratch, support);
        if result.is_ok() || self.visibility.is_none() {
            return result;
        }
        let result = self.evaluate_seeing(X, |_| true, false, scratch, support);
        support.across_gap = result.is_ok();
        result
    }

    /// From the nodes around X that are `seen` only, those behind gaps left out or not.
    fn evaluate_seeing(
        &self,
        X: &Vector3,
        seen: impl Fn(u32) -> bool,
        by_sight: bool,
        scratch: &mut Scratch,
        support: &mut Support,
    ) -> Result<(), PoorSupport> {
        let mut enlargement = 1.0;
        let level = Level::new();
        loop {
            support.clear(enlargement);
            self.find(X, enlargement, &seen, &mut scratch.near);
            if let (true, Some(visibility)) = (by_sight, &self.visibility) {
                visibility.keep_seen(X, &mut scratch.near.nodes);
            }
            let result = with_vectors!(level, (simd, _numbers) => {
                self.evaluate_near(simd, X, enlargement, &mut scratch.near, support)
            });
            enlargement *= 1.1;
            if result.is_ok() || enlargement > LARGEST_ENLARGEMENT {
                return result;
            }
        }
    }

    /// The nodes that cover X and are `seen`, ascending.
    fn find(&self, X: &Vector3, enlargement: f64, seen: impl Fn(u32) -> bool, near: &mut Near) {
        near.nodes.clear();
        let reach = self.reach(X, enlargement);
        self.neighbours.for_each_within(X, reach, |node, offset| {
            let radius = self.influence_radius[node] * enlargement;
            if offset.norm_squared() < radius * radius && seen(node as u32) {
                near.nodes.push(node as u32);
            }
        });
        near.nodes.sort_unstable();
    }

    /// From the nodes that were found.
    #[inline(always)]
    fn evaluate_near<S: Simd>(
        &self,
        simd: S,
        X: &Vector3,
        enlargement: f64,
        near: &mut Near,
        support: &mut Support,
    ) -> Result<(), PoorSupport> {
        if near.nodes.len() < self.smallest_support() {
            let support_size = near.nodes.len();
            return Err(PoorSupport { support_size, condition: f64::INFINITY });
        }
        let (s, total) = self.weigh(simd, X, enlargement, near);
        match self.basis_size() {
            3 => self.evaluate_with::<S, 3>(simd, s, total, near, support),
            4 => self.evaluate_with::<S, 4>(simd, s, total, near, support),
            6 => self.evaluate_with::<S, 6>(simd, s, total, near, support),
            _ => self.evaluate_with::<S, 10>(simd, s, total, near, support),
        }
    }

    /// From the nodes that cover a point, the length s \[m\] and Σw.
    #[inline(always)]
    fn evaluate_with<S: Simd, const M: usize>(
        &self,
        simd: S,
        s: f64,
        total: f64,
        near: &Near,
        support: &mut Support,
    ) -> Result<(), PoorSupport> {
        let mut A = moment_matrix::<S, M>(simd, near);
        let poor = |condition| PoorSupport { support_size: near.nodes.len(), condition };
        let penalty = regularise(self.basis, self.components, &mut A, near, total, s);
        let inverse = inverse(&A).ok_or(poor(f64::INFINITY))?;
        let linear = penalty.and_then(|_| linear_part(&A, self.components + 1));
        let condition = match (penalty, &linear) {
            (None, _) => norm_1(&A) * norm_1(&inverse),
            (Some(_), Some((_, condition))) => *condition,
            (Some(_), None) => f64::INFINITY,
        };
        if condition.is_nan() || condition > self.largest_condition() {
            return Err(poor(condition));
        }
        support.condition = condition;
        // A regularised matrix may be ill conditioned: one step of iterative
        // refinement reduces the residual.
        let solve = |right: SVector<f64, M>| {
            let x = inverse * right;
            if penalty.is_some() { x + inverse * (right - A * x) } else { x }
        };
        let mut right = SVector::<f64, M>::zeros();
        right[0] = 1.0;
        let c = if penalty.is_some() { solve(right) } else { inverse.column(0).into_owned() };
        let moments = slope_moments(simd, near, &c);
        let slopes = slope_right_sides(moments, penalty, &c, s).map(solve);
        fill(simd, near, &c, &slopes, support);
        if let Some((inverse, _)) = linear {
            restore_linear::<M>(self.components, support, near, &inverse, s);
        }
        Ok(())
    }

    /// Weighs the nodes that were found. Returns the root of their weighted mean squared
    /// distance s \[m\], by which offsets are scaled (method book, eq. 6.1), and Σw.
    #[inline(always)]
    fn weigh<S: Simd>(
        &self,
        simd: S,
        X: &Vector3,
        enlargement: f64,
        near: &mut Near,
    ) -> (f64, f64) {
        let Near { nodes, fours } = near;
        fours.clear();
        let zero = f64x4::splat(simd, 0.0);
        let (mut total, mut moment) = (zero, zero);
        for nodes in nodes.chunks(4) {
            // Where there is no node, one beyond its radius.
            let (mut offsets, mut radii) = ([[2.0; 4]; 3], [1.0; 4]);
            for (lane, &node) in nodes.iter().enumerate() {
                let position = &self.nodes[node as usize];
                (0..3).for_each(|k| offsets[k][lane] = position[k] - X[k]);
                radii[lane] = self.influence_radius[node as usize] * enlargement;
            }
            let (four, weight, square) = weigh(simd, self.weight_function, offsets, radii);
            (total, moment) = (total + weight, moment + square);
            fours.push(four);
        }
        let (total, moment) = (total.reduce_sum(), moment.reduce_sum());
        let s = (moment / total).sqrt();
        let inverse = 1.0 / s;
        for four in fours {
            four.scaled.iter_mut().flatten().for_each(|x| *x *= inverse);
        }
        (s, total)
    }
}

/// e_{k+1}/s − A,_k c from the second term: with A⁻¹ they give the derivatives of the
/// coefficients A⁻¹ p(X) along the directions k.
fn slope_right_sides<const M: usize>(
    moments: [SVector<f64, M>; 3],
    penalty: Option<Vector3>,
    c: &SVector<f64, M>,
    s: f64,
) -> [SVector<f64, M>; 3] {
    let mut right = moments.map(|moment| -moment);
    for (k, column) in right.iter_mut().enumerate().take(dimension(M)) {
        column[k + 1] += 1.0 / s;
        let Some(slope) = penalty else { continue };
        for i in dimension(M) + 1..M {
            column[i] -= slope[k] * c[i];
        }
    }
    right
}
