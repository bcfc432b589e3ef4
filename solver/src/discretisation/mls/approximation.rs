//! Moving least squares on a cloud: φ and Grad φ at a point.
#![allow(non_snake_case)]

use crate::algebra::lanes::with_vectors;
use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::held_sides::HeldSides;
use crate::discretisation::mls::inverse::{inverse, norm_1};
use crate::discretisation::mls::regularised::{linear_part, regularise, restore_linear};
use crate::discretisation::mls::sides::Sides;
use crate::discretisation::mls::stiffness::Stiffness;
use crate::discretisation::mls::sums::{
    fill, moment_matrix, slope_moments, slope_right_sides, weigh,
};
use crate::discretisation::mls::support::{Near, PoorSupport, Scratch, Support};
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
    /// Where a part is held as a volume.
    held: Option<HeldSides>,
    /// Where gaps of the body bar the way to some of them.
    visibility: Option<Visibility>,
    pub(super) smallest_radius: f64,
    pub(super) largest_radius: f64,
    pub(super) neighbours: Neighbours,
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
        let reaches = if smallest_radius == largest_radius {
            Vec::new()
        } else {
            neighbours.reaches(&influence_radius)
        };
        Approximation {
            nodes,
            influence_radius,
            basis,
            weight_function,
            components,
            sides: None,
            held: None,
            visibility: None,
            smallest_radius,
            largest_radius,
            neighbours,
            reaches,
        }
    }

    /// No node farther away covers X \[m\] with radii enlarged by a factor.
    pub(super) fn reach(&self, X: &Vector3, enlargement: f64) -> f64 {
        if self.reaches.is_empty() || enlargement > 1.0 {
            self.largest_radius * enlargement
        } else {
            self.reaches[self.neighbours.cell_of(X)]
        }
    }

    /// The same where points do not see nodes that are softer than they are.
    /// Radii are `dilation` spacings.
    pub fn with_sides(self, stiffness: Stiffness, body: &Shape, dilation: f64) -> Approximation {
        let nodes = (&self.nodes[..], &self.influence_radius[..]);
        let sides = Sides::new(stiffness, body, nodes, dilation);
        let sides = Some(sides);
        Approximation { sides, ..self }
    }

    /// The same where a part is held as a volume, whose border nobody sees through.
    pub fn with_held(self, held: &Shape, dilation: f64) -> Approximation {
        let held = Some(HeldSides::new(held, &self.nodes, self.smallest_radius / dilation));
        Approximation { held, ..self }
    }

    /// Makes places within what is held see what is held, after the rows of what deforms.
    pub fn open_held(&mut self) {
        self.held.as_mut().into_iter().for_each(HeldSides::open);
    }

    /// Whether what deforms sees a node.
    fn deforms(&self, node: u32) -> bool {
        self.held.as_ref().is_none_or(|held| held.deforms(node))
    }

    /// The same where points see nodes through the body, or what deforms of it, only.
    pub fn within(self, body: &Shape, dilation: f64) -> Approximation {
        let Approximation { nodes, influence_radius: radii, neighbours, .. } = &self;
        let has = |node: usize| self.deforms(node as u32);
        let visibility = Visibility::new(body, (nodes, radii), neighbours, dilation, &has);
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
        if let Some(held) = self.held.as_ref().filter(|held| held.is_held(X)) {
            let seen = |node: u32| held.holds(node);
            if self.evaluate_seeing(X, seen, |_| {}, scratch, support).is_ok() {
                return Ok(());
            }
            // So little is held here that its border alone has nodes.
            return self.evaluate_seeing(X, |_| true, |_| {}, scratch, support);
        }
        let through_body = |nodes: &mut Vec<u32>| self.keep_seen(X, nodes);
        if let Some(sides) = &self.sides {
            let softest = sides.softest_seen(X);
            let seen = |node: u32| sides.is_seen(node, softest) && self.deforms(node);
            let through_material = |nodes: &mut Vec<u32>| {
                through_body(nodes);
                sides.keep_seen(X, softest, nodes);
            };
            if self.evaluate_seeing(X, seen, through_material, scratch, support).is_ok() {
                return Ok(());
            }
        }
        let deforms = |node: u32| self.deforms(node);
        let result = self.evaluate_seeing(X, deforms, through_body, scratch, support);
        if result.is_ok() || self.visibility.is_none() {
            return result;
        }
        let result = self.evaluate_seeing(X, deforms, |_| {}, scratch, support);
        support.across_gap = result.is_ok();
        result
    }

    /// From those nodes around X that are `seen` and that `keep` keeps.
    fn evaluate_seeing(
        &self,
        X: &Vector3,
        seen: impl Fn(u32) -> bool,
        keep: impl Fn(&mut Vec<u32>),
        scratch: &mut Scratch,
        support: &mut Support,
    ) -> Result<(), PoorSupport> {
        let mut enlargement = 1.0;
        let level = Level::new();
        loop {
            support.clear(enlargement);
            self.find(X, enlargement, &seen, &mut scratch.near);
            keep(&mut scratch.near.nodes);
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
