//! A solid given by a function of the caller.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use std::fmt;
use std::sync::Arc;

/// Signed distance as a function of the position, and a box that holds the solid.
#[derive(Clone)]
pub struct DistanceFunction {
    function: Arc<dyn Fn(&Vector3) -> f64 + Send + Sync>,
    bounds: (Vector3, Vector3),
}

impl DistanceFunction {
    /// Of a function that is negative inside and, near the boundary, the distance to it
    /// \[m\]; elsewhere its sign and a bound on the distance are enough. The solid must lie
    /// between `lower` and `upper` \[m\].
    pub fn new(
        lower: Vector3,
        upper: Vector3,
        function: impl Fn(&Vector3) -> f64 + Send + Sync + 'static,
    ) -> DistanceFunction {
        DistanceFunction { function: Arc::new(function), bounds: (lower, upper) }
    }

    /// Signed distance \[m\], negative inside.
    pub fn at(&self, X: &Vector3) -> f64 {
        (self.function)(X)
    }

    pub(crate) fn bounds(&self) -> (Vector3, Vector3) {
        self.bounds
    }

    /// The same function on cross-sections, without ends.
    pub(crate) fn without_ends(&self) -> DistanceFunction {
        let (mut lower, mut upper) = self.bounds;
        (lower.z, upper.z) = (f64::NEG_INFINITY, f64::INFINITY);
        DistanceFunction { function: self.function.clone(), bounds: (lower, upper) }
    }
}

impl fmt::Debug for DistanceFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DistanceFunction").field("bounds", &self.bounds).finish_non_exhaustive()
    }
}
