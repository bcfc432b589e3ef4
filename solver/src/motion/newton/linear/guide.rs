//! A spring that leads a body along a motion.
#![allow(non_snake_case)]

use crate::algebra::packed::{axpy, dot};

/// The force β (s − a) c on displacements, with their amplitude a = c·(u − u₀) along a motion
/// (method book, eq. 20.8).
#[derive(Debug, Clone)]
pub(crate) struct Guide {
    /// c \[component of node\] \[–\], whose product with the motion is 1.
    pub weights: Vec<f64>,
    /// β \[N/m\]
    pub stiffness: f64,
    /// c·u₀ \[m\]
    pub origin: f64,
    /// s \[m\]
    pub amplitude: f64,
}

impl Guide {
    /// a of displacements `u` \[m\].
    pub fn reached(&self, u: &[f64]) -> f64 {
        dot(&self.weights, u) - self.origin
    }

    /// Adds the force at displacements `u` \[m\] to forces \[N\].
    pub fn add_force(&self, u: &[f64], force: &mut [f64]) {
        axpy(force, self.stiffness * (self.amplitude - self.reached(u)), &self.weights);
    }

    /// Adds the product of the stiffness with `v` to a product with K.
    pub fn add_stiffness_times(&self, v: &[f64], product: &mut [f64]) {
        axpy(product, self.stiffness * dot(&self.weights, v), &self.weights);
    }
}
