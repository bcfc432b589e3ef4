//! The nodes that cover a point, with their weights and shape functions.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use fearless_simd::{Simd, f64x4, prelude::*};
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
    /// Whether nodes behind a gap of the body are among them, for want of others.
    pub across_gap: bool,
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
        (self.condition, self.enlargement, self.across_gap) = (0.0, enlargement, false);
    }
}

/// Memory that evaluations reuse.
#[derive(Default)]
pub(crate) struct Scratch {
    pub(super) near: Near,
}

/// The nodes that cover a point.
#[derive(Default)]
pub(super) struct Near {
    /// Ascending.
    pub nodes: Vec<u32>,
    /// The same, four side by side; what fills the last four up has no weight.
    pub fours: Vec<Four>,
}

/// Four nodes as seen from the evaluation point.
pub(super) struct Four {
    /// (X_a − X)/s by component \[–\]
    pub scaled: [[f64; 4]; 3],
    pub weight: [f64; 4],
    /// ∂w_a/∂X by component \[1/m\]
    pub gradient: [[f64; 4]; 3],
}

/// A node as seen from the evaluation point.
pub(super) struct Weighed {
    /// (X_a − X)/s \[–\]
    pub scaled: Vector3,
    pub weight: f64,
    /// ∂w_a/∂X \[1/m\]
    pub gradient: Vector3,
}

impl Near {
    /// One after the other.
    pub fn iter(&self) -> impl Iterator<Item = Weighed> {
        let lane = |four: &Four, l: usize| Weighed {
            scaled: Vector3::from_fn(|k, _| four.scaled[k][l]),
            weight: four.weight[l],
            gradient: Vector3::from_fn(|k, _| four.gradient[k][l]),
        };
        (0..self.nodes.len()).map(move |a| lane(&self.fours[a / 4], a % 4))
    }
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

/// As [`monomials`], of four nodes.
#[inline(always)]
pub(super) fn monomials_of<S: Simd, const M: usize>(simd: S, four: &Four) -> [f64x4<S>; M] {
    let xi: [f64x4<S>; 3] = [
        four.scaled[0].simd_into(simd),
        four.scaled[1].simd_into(simd),
        four.scaled[2].simd_into(simd),
    ];
    let mut p = [f64x4::splat(simd, 1.0); M];
    let mut next = 1;
    for &x in &xi[..dimension(M)] {
        p[next] = x;
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
