//! Moving least squares: φ and Grad φ at a point.
#![allow(non_snake_case)]

use crate::neighbours::Neighbours;
use crate::problem::{Basis, Dimension, WeightFunction};
use crate::tensor::Vector3;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};

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
        let (mut sum, mut count) = (0.0, 0.0);
        self.neighbours.for_each_near(X, self.largest_radius, |node| {
            let radius = self.influence_radius[node];
            if (self.nodes[node] - X).norm_squared() < radius * radius {
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
        let mut enlargement = 1.0;
        loop {
            let result = match self.basis_size() {
                3 => self.evaluate_with::<3>(X, enlargement),
                4 => self.evaluate_with::<4>(X, enlargement),
                6 => self.evaluate_with::<6>(X, enlargement),
                _ => self.evaluate_with::<10>(X, enlargement),
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
    ) -> Result<Support, PoorSupport> {
        let near = self.weigh(X, enlargement);
        let n = near.len();
        if n < self.smallest_support() {
            return Err(PoorSupport { support_size: n, condition: f64::INFINITY });
        }
        // Monomials in (X_a − X)/s with s the weighted mean distance: values
        // and gradients are read at the origin, wherever X is.
        let total: f64 = near.iter().map(|a| a.weight).sum();
        let s =
            (near.iter().map(|a| a.weight * a.offset.norm_squared()).sum::<f64>() / total).sqrt();
        let monomials: Vec<SVector<f64, M>> =
            near.iter().map(|a| monomials::<M>(&(a.offset / s), self.components)).collect();
        let mut A = SMatrix::<f64, M, M>::zeros();
        for (a, p) in near.iter().zip(&monomials) {
            A.ger(a.weight, p, p, 1.0);
        }
        let poor = |condition| PoorSupport { support_size: n, condition };
        let held = self.regularise(&mut A, &near, total, s);
        let inverse = A.cholesky().map(|factor| factor.inverse()).ok_or(poor(f64::INFINITY))?;
        let linear = held.and_then(|_| linear_part(&A, self.components + 1));
        let condition = match (held, &linear) {
            (None, _) => norm_1(&A) * norm_1(&inverse),
            (Some(_), Some((_, condition))) => *condition,
            (Some(_), None) => f64::INFINITY,
        };
        if condition.is_nan() || condition > self.largest_condition() {
            return Err(poor(condition));
        }
        let mut support = Support { condition, enlargement, ..Support::default() };
        // A regularised matrix is ill conditioned where it is needed: one
        // refinement brings the residual down.
        let solve = |right: SVector<f64, M>| {
            let x = inverse * right;
            if held.is_some() { x + inverse * (right - A * x) } else { x }
        };
        let mut right = SVector::<f64, M>::zeros();
        right[0] = 1.0;
        let c = if held.is_some() { solve(right) } else { inverse.column(0).into_owned() };
        let slopes = self.slope_right_sides(&near, &monomials, held, &c, s).map(solve);
        for (a, p) in near.iter().zip(&monomials) {
            let value = c.dot(p);
            support.nodes.push(a.node as u32);
            support.phi.push(a.weight * value);
            let mut gradient = a.gradient * value;
            for k in 0..self.components {
                gradient[k] += a.weight * slopes[k].dot(p);
            }
            support.grad_phi.push(gradient);
        }
        if let Some((inverse, _)) = linear {
            self.restore_linear(&mut support, &near, &monomials, &inverse, s);
        }
        Ok(support)
    }

    /// Takes out what round-off has cost the reproduction of linear fields:
    /// second-order coefficients reach 1/μ and cancel in φ, which leaves about
    /// 1e-16/μ. `inverse` is that of the linear part of A.
    fn restore_linear<const M: usize>(
        &self,
        support: &mut Support,
        near: &[Weighed],
        monomials: &[SVector<f64, M>],
        inverse: &DMatrix<f64>,
        s: f64,
    ) {
        let size = self.components + 1;
        let lacking = |target: DVector<f64>, value: &dyn Fn(usize) -> f64| {
            let lack = monomials
                .iter()
                .enumerate()
                .fold(target, |lack, (a, p)| lack - DVector::from_fn(size, |i, _| p[i] * value(a)));
            inverse * lack
        };
        let unit = |i: usize, value: f64| {
            DVector::from_fn(size, |row, _| if row == i { value } else { 0.0 })
        };
        let values = lacking(unit(0, 1.0), &|a| support.phi[a]);
        let slopes: Vec<DVector<f64>> = (0..self.components)
            .map(|k| lacking(unit(k + 1, 1.0 / s), &|a| support.grad_phi[a][k]))
            .collect();
        for (a, p) in monomials.iter().enumerate() {
            let part =
                |c: &DVector<f64>| near[a].weight * (0..size).map(|i| c[i] * p[i]).sum::<f64>();
            support.phi[a] += part(&values);
            for (k, slope) in slopes.iter().enumerate() {
                support.grad_phi[a][k] += part(slope);
            }
        }
    }

    /// Adds μ Σw to the second-order diagonal of A in the scaled basis (Joldes
    /// et al. 2015, eq. 12, there without Σw) and returns μ times the gradient
    /// of what was added: with R = Σ w |X_a − X|² it is Σw s⁴ = R²/Σw in metres,
    /// so that s⁻⁴ ∂(R²/Σw) = 2 s⁻² ∂R − ∂Σw.
    fn regularise<const M: usize>(
        &self,
        A: &mut SMatrix<f64, M, M>,
        near: &[Weighed],
        total: f64,
        s: f64,
    ) -> Option<Vector3> {
        let Basis::ModifiedQuadratic { regularisation } = self.basis else { return None };
        for i in self.components + 1..M {
            A[(i, i)] += regularisation * total;
        }
        let mut slope = Vector3::zeros();
        for a in near {
            let moment = a.gradient * a.offset.norm_squared() - a.offset * (2.0 * a.weight);
            slope += moment * (2.0 / (s * s)) - a.gradient;
        }
        Some(slope * regularisation)
    }

    /// e_{k+1}/s − A,_k c: with A⁻¹ they give the derivatives of the
    /// coefficients A⁻¹ p(X) along the directions k.
    fn slope_right_sides<const M: usize>(
        &self,
        near: &[Weighed],
        monomials: &[SVector<f64, M>],
        held: Option<Vector3>,
        c: &SVector<f64, M>,
        s: f64,
    ) -> [SVector<f64, M>; 3] {
        let mut right = [SVector::<f64, M>::zeros(); 3];
        for (k, column) in right.iter_mut().enumerate().take(self.components) {
            column[k + 1] = 1.0 / s;
            for (a, p) in near.iter().zip(monomials) {
                column.axpy(-a.gradient[k] * c.dot(p), p, 1.0);
            }
            if let Some(slope) = held {
                for i in self.components + 1..M {
                    column[i] -= slope[k] * c[i];
                }
            }
        }
        right
    }

    /// The nodes that cover X with their weights, ascending.
    fn weigh(&self, X: &Vector3, enlargement: f64) -> Vec<Weighed> {
        let mut near = Vec::with_capacity(64);
        self.neighbours.for_each_near(X, self.largest_radius * enlargement, |node| {
            let offset = self.nodes[node] - X;
            let radius = self.influence_radius[node] * enlargement;
            let distance_squared = offset.norm_squared();
            if distance_squared < radius * radius {
                let distance = distance_squared.sqrt();
                let (weight, slope) = self.weight_function.value_and_derivative(distance / radius);
                let gradient = match distance > 1e-12 * radius {
                    true => offset * (-slope / (radius * distance)),
                    false => Vector3::zeros(),
                };
                near.push(Weighed { node, offset, weight, gradient });
            }
        });
        near.sort_unstable_by_key(|a| a.node);
        near
    }
}

/// A node seen from the evaluation point.
struct Weighed {
    node: usize,
    /// X_a − X \[m\]
    offset: Vector3,
    weight: f64,
    /// ∂w_a/∂X \[1/m\]
    gradient: Vector3,
}

/// Monomials up to first or second order; M and the number of components
/// tell which.
fn monomials<const M: usize>(xi: &Vector3, components: usize) -> SVector<f64, M> {
    let mut p = SVector::<f64, M>::zeros();
    p[0] = 1.0;
    let mut next = 1;
    for k in 0..components {
        p[next] = xi[k];
        next += 1;
    }
    if M > components + 1 {
        for i in 0..components {
            for j in i..components {
                p[next] = xi[i] * xi[j];
                next += 1;
            }
        }
    }
    p
}

/// Inverse and condition (1-norm) of the first `size` rows and columns.
fn linear_part<const M: usize>(A: &SMatrix<f64, M, M>, size: usize) -> Option<(DMatrix<f64>, f64)> {
    let norm = |part: &DMatrix<f64>| {
        part.column_iter().map(|column| column.abs().sum()).fold(0.0, f64::max)
    };
    let part = DMatrix::from_fn(size, size, |i, j| A[(i, j)]);
    let inverse = part.clone().cholesky()?.inverse();
    let condition = norm(&part) * norm(&inverse);
    Some((inverse, condition))
}

fn norm_1<const M: usize>(matrix: &SMatrix<f64, M, M>) -> f64 {
    matrix.column_iter().map(|column| column.abs().sum()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
