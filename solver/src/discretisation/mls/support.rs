//! The nodes that cover a point, with their weights and shape functions.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use nalgebra::SVector;

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
    /// Number of nodes whose influence domains cover the point.
    pub support_size: usize,
    /// Condition number of the moment matrix \[–\]; infinite for a singular one.
    pub condition: f64,
}

impl Support {
    pub(super) fn clear(&mut self, enlargement: f64) {
        self.nodes.clear();
        self.phi.clear();
        self.grad_phi.clear();
        (self.condition, self.enlargement) = (0.0, enlargement);
    }

    /// φ_a = w_a cᵀp and its gradient from those of w_a and c.
    pub(super) fn fill<const M: usize>(
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

/// Memory that evaluations reuse.
#[derive(Default)]
pub(crate) struct Scratch {
    pub(super) found: Vec<u32>,
    pub(super) near: Vec<Weighed>,
}

/// A node as seen from the evaluation point.
pub(super) struct Weighed {
    pub node: u32,
    /// X_a − X \[m\]
    pub offset: Vector3,
    /// (X_a − X)/s \[–\]
    pub scaled: Vector3,
    pub weight: f64,
    /// ∂w_a/∂X \[1/m\]
    pub gradient: Vector3,
}

/// Dimension of the space in which a complete basis has so many monomials.
pub(super) const fn dimension(monomials: usize) -> usize {
    match monomials {
        3 | 6 => 2,
        _ => 3,
    }
}

/// Monomials up to first or second order.
#[inline(always)]
pub(super) fn monomials<const M: usize>(xi: &Vector3) -> SVector<f64, M> {
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
