//! Moving least squares: φ and Grad φ at a point.
#![allow(non_snake_case)]

mod inverse;
mod regularised;

use crate::algebra::tensor::Vector3;
use crate::discretisation::neighbours::Neighbours;
use crate::problem::{Basis, Dimension, WeightFunction};
pub(crate) use inverse::inverse;
use inverse::norm_1;
use nalgebra::{SMatrix, SVector};

/// Nodes with their influence domains, ready to be evaluated anywhere.
#[derive(Debug, Clone)]
pub struct Approximation {
    /// Reference positions \[node\] \[m\].
    pub nodes: Vec<Vector3>,
    /// \[node\] \[m\]
    pub influence_radius: Vec<f64>,
    pub basis: Basis,
    pub weight_function: WeightFunction,
    components: usize,
    smallest_radius: f64,
    largest_radius: f64,
    neighbours: Neighbours,
}

/// φ and Grad φ of the nodes whose influence domains cover one point.
#[derive(Debug, Clone, Default)]
pub struct Support {
    /// Ascending node indices \[support\].
    pub nodes: Vec<u32>,
    /// \[support\] \[–\]
    pub phi: Vec<f64>,
    /// \[support\] \[1/m\]; the third component is 0 in a plane.
    pub grad_phi: Vec<Vector3>,
    /// Condition number of the moment matrix in the local scaled basis,
    /// 1-norm; of its linear part where the rest is regularised.
    pub condition: f64,
    /// Factor by which influence radii were enlarged here; 1 for none.
    pub enlargement: f64,
}

/// Why no sound approximation exists at a point, even with radii enlarged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoorSupport {
    pub support_size: usize,
    /// Infinite for a singular moment matrix.
    pub condition: f64,
}

/// Influence radii are enlarged at a point by at most this factor.
pub const LARGEST_ENLARGEMENT: f64 = 2.0;

impl Approximation {
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
        Approximation {
            nodes,
            influence_radius,
            basis,
            weight_function,
            components,
            smallest_radius,
            largest_radius,
            neighbours,
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

    /// Fewest nodes that a support may have: twice the basis where it is
    /// linear (8 in space) or regularised beyond, a half more than the basis
    /// where it is quadratic.
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
        self.neighbours.for_each_within(X, self.largest_radius, |node, offset| {
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

    /// φ_a(X) = pᵀ(X) A⁻¹(X) b_a(X) and its full derivatives (Lancaster and
    /// Salkauskas 1981; Belytschko, Lu, Gu 1994, eqs. 9–18). Where the support
    /// is poor the radii are enlarged in steps of 10 %.
    pub fn evaluate(&self, X: &Vector3) -> Result<Support, PoorSupport> {
        let mut support = Support::default();
        self.evaluate_into(X, &mut Scratch::default(), &mut support)?;
        Ok(support)
    }

    /// As [`Approximation::evaluate`] into memory that is kept from point to
    /// point; after an error the support is empty.
    pub(crate) fn evaluate_into(
        &self,
        X: &Vector3,
        scratch: &mut Scratch,
        support: &mut Support,
    ) -> Result<(), PoorSupport> {
        let mut enlargement = 1.0;
        loop {
            support.clear(enlargement);
            let result = match self.basis_size() {
                3 => self.evaluate_with::<3>(X, enlargement, scratch, support),
                4 => self.evaluate_with::<4>(X, enlargement, scratch, support),
                6 => self.evaluate_with::<6>(X, enlargement, scratch, support),
                _ => self.evaluate_with::<10>(X, enlargement, scratch, support),
            };
            enlargement *= 1.1;
            if result.is_ok() || enlargement > LARGEST_ENLARGEMENT {
                return result;
            }
        }
    }

    fn evaluate_with<const M: usize>(
        &self,
        X: &Vector3,
        enlargement: f64,
        scratch: &mut Scratch,
        support: &mut Support,
    ) -> Result<(), PoorSupport> {
        let (s, total) = self.weigh(X, enlargement, scratch);
        let near = &scratch.near[..];
        let n = near.len();
        if n < self.smallest_support() {
            return Err(PoorSupport { support_size: n, condition: f64::INFINITY });
        }
        let mut A = SMatrix::<f64, M, M>::zeros();
        for a in near {
            let p = monomials::<M>(&a.scaled);
            A.ger(a.weight, &p, &p, 1.0);
        }
        let poor = |condition| PoorSupport { support_size: n, condition };
        let held = self.regularise(&mut A, near, total, s);
        let inverse = inverse(&A).ok_or(poor(f64::INFINITY))?;
        let linear = held.and_then(|_| regularised::linear_part(&A, self.components + 1));
        let condition = match (held, &linear) {
            (None, _) => norm_1(&A) * norm_1(&inverse),
            (Some(_), Some((_, condition))) => *condition,
            (Some(_), None) => f64::INFINITY,
        };
        if condition.is_nan() || condition > self.largest_condition() {
            return Err(poor(condition));
        }
        support.condition = condition;
        // A regularised matrix is ill conditioned where it is needed: one
        // refinement brings the residual down.
        let solve = |right: SVector<f64, M>| {
            let x = inverse * right;
            if held.is_some() { x + inverse * (right - A * x) } else { x }
        };
        let mut right = SVector::<f64, M>::zeros();
        right[0] = 1.0;
        let c = if held.is_some() { solve(right) } else { inverse.column(0).into_owned() };
        let slopes = self.slope_right_sides(near, held, &c, s).map(solve);
        support.fill(near, &c, &slopes);
        if let Some((inverse, _)) = linear {
            self.restore_linear::<M>(support, near, &inverse, s);
        }
        Ok(())
    }

    /// e_{k+1}/s − A,_k c: with A⁻¹ they give the derivatives of the
    /// coefficients A⁻¹ p(X) along the directions k.
    fn slope_right_sides<const M: usize>(
        &self,
        near: &[Weighed],
        held: Option<Vector3>,
        c: &SVector<f64, M>,
        s: f64,
    ) -> [SVector<f64, M>; 3] {
        let mut right = [SVector::<f64, M>::zeros(); 3];
        for (k, column) in right.iter_mut().enumerate().take(dimension(M)) {
            column[k + 1] = 1.0 / s;
        }
        for a in near {
            let p = monomials::<M>(&a.scaled);
            let value = c.dot(&p);
            for (k, column) in right.iter_mut().enumerate().take(dimension(M)) {
                column.axpy(-a.gradient[k] * value, &p, 1.0);
            }
        }
        if let Some(slope) = held {
            for (k, column) in right.iter_mut().enumerate().take(dimension(M)) {
                for i in dimension(M) + 1..M {
                    column[i] -= slope[k] * c[i];
                }
            }
        }
        right
    }

    /// Leaves the nodes that cover X with their weights in `scratch`, ascending.
    /// Returns their weighted mean distance s \[m\], by which offsets are scaled
    /// so that values and gradients are read at the origin wherever X is, and Σw.
    fn weigh(&self, X: &Vector3, enlargement: f64, scratch: &mut Scratch) -> (f64, f64) {
        let Scratch { found, near } = scratch;
        found.clear();
        near.clear();
        self.neighbours.for_each_within(X, self.largest_radius * enlargement, |node, offset| {
            let radius = self.influence_radius[node] * enlargement;
            if offset.norm_squared() < radius * radius {
                found.push(node as u32);
            }
        });
        found.sort_unstable();
        let (mut total, mut moment) = (0.0, 0.0);
        for &node in found.iter() {
            let offset = self.nodes[node as usize] - X;
            let radius = self.influence_radius[node as usize] * enlargement;
            let distance_squared = offset.norm_squared();
            let distance = distance_squared.sqrt();
            let (weight, slope) = self.weight_function.value_and_derivative(distance / radius);
            let gradient = match distance > 1e-12 * radius {
                true => offset * (-slope / (radius * distance)),
                false => Vector3::zeros(),
            };
            total += weight;
            moment += weight * distance_squared;
            near.push(Weighed { node, offset, scaled: offset, weight, gradient });
        }
        let s = (moment / total).sqrt();
        near.iter_mut().for_each(|a| a.scaled = a.offset / s);
        (s, total)
    }
}

impl Support {
    fn clear(&mut self, enlargement: f64) {
        self.nodes.clear();
        self.phi.clear();
        self.grad_phi.clear();
        (self.condition, self.enlargement) = (0.0, enlargement);
    }

    /// φ_a = w_a cᵀp and its gradient from those of w_a and c.
    fn fill<const M: usize>(
        &mut self,
        near: &[Weighed],
        c: &SVector<f64, M>,
        slopes: &[SVector<f64, M>; 3],
    ) {
        self.nodes.reserve(near.len());
        self.phi.reserve(near.len());
        self.grad_phi.reserve(near.len());
        for a in near {
            let p = monomials::<M>(&a.scaled);
            let value = c.dot(&p);
            self.nodes.push(a.node);
            self.phi.push(a.weight * value);
            let mut gradient = a.gradient * value;
            for k in 0..dimension(M) {
                gradient[k] += a.weight * slopes[k].dot(&p);
            }
            self.grad_phi.push(gradient);
        }
    }
}

/// Memory for evaluations, kept from point to point.
#[derive(Default)]
pub(crate) struct Scratch {
    found: Vec<u32>,
    near: Vec<Weighed>,
}

/// A node seen from the evaluation point.
struct Weighed {
    node: u32,
    /// X_a − X \[m\]
    offset: Vector3,
    /// (X_a − X)/s \[–\]
    scaled: Vector3,
    weight: f64,
    /// ∂w_a/∂X \[1/m\]
    gradient: Vector3,
}

/// Dimension of the space in which a complete basis has so many monomials.
const fn dimension(monomials: usize) -> usize {
    match monomials {
        3 | 6 => 2,
        _ => 3,
    }
}

/// Monomials up to first or second order.
#[inline(always)]
fn monomials<const M: usize>(xi: &Vector3) -> SVector<f64, M> {
    let mut p = SVector::<f64, M>::zeros();
    p[0] = 1.0;
    let mut next = 1;
    for k in 0..dimension(M) {
        p[next] = xi[k];
        next += 1;
    }
    if M > dimension(M) + 1 {
        for i in 0..dimension(M) {
            for j in i..dimension(M) {
                p[next] = xi[i] * xi[j];
                next += 1;
            }
        }
    }
    p
}

#[cfg(test)]
mod tests;
