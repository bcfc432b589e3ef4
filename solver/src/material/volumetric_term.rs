//! The volumetric energies of laws with an isochoric split.
#![allow(non_snake_case)]

use crate::algebra::real::Real;

/// The volumetric energy U(J) of a law with an isochoric split (method book, eq. 3.5).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum VolumetricTerm {
    /// U = K/2 (J − 1)².
    #[default]
    Quadratic,
    /// U = K/4 (J² − 1 − 2 ln J) (Simo, Taylor 1991).
    SimoTaylor,
}

impl VolumetricTerm {
    /// U(J) \[Pa\] with the bulk modulus K \[Pa\].
    pub fn energy(&self, K: f64, J: f64) -> f64 {
        match self {
            VolumetricTerm::Quadratic => 0.5 * K * (J - 1.0).powi(2),
            VolumetricTerm::SimoTaylor => 0.25 * K * (J * J - 1.0 - 2.0 * J.ln()),
        }
    }

    /// U'(J) \[Pa\].
    #[inline(always)]
    pub fn slope<R: Real>(&self, K: f64, J: R) -> R {
        match self {
            VolumetricTerm::Quadratic => (J - 1.0) * K,
            VolumetricTerm::SimoTaylor => (J * J - 1.0) / J * (0.5 * K),
        }
    }
}
