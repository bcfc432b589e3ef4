//! The isotropic exponential law of Demiray.
#![allow(non_snake_case)]

use super::shape_energy::{Constant, ShapeEnergy, exactly, first_invariant_above_rest, spherical};
use crate::algebra::real::Real;
use crate::algebra::tensor::Tensor;
use crate::material::constants::{MaterialError, positive};

/// ψ̄ = μ/2b (e^(b (Ī₁ − 3)) − 1) \[Pa\] (Demiray, J. Biomech. 5, 309, 1972).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Demiray {
    mu: f64,
    b: f64,
}

impl ShapeEnergy for Demiray {
    const NAME: &'static str = "demiray";
    const ENERGY: &'static str = "mu/2b (exp(b (Ī₁ − 3)) − 1) + U(J)";
    const CONSTANTS: &'static [Constant] =
        &[Constant::needed("mu", "Pa"), Constant::needed("b", "–")];
    const HAS_FIBRES: bool = false;

    fn new(constants: &[f64]) -> Result<Demiray, MaterialError> {
        let [mu, b] = exactly(constants)?;
        positive("mu", mu)?;
        positive("b", b)?;
        Ok(Demiray { mu, b })
    }

    fn energy(&self, C: &Tensor<f64>) -> f64 {
        0.5 * self.mu / self.b * (self.b * first_invariant_above_rest(C)).exp_m1()
    }

    #[inline(always)]
    fn stress<R: Real>(&self, C: &Tensor<R>) -> Tensor<R> {
        spherical((first_invariant_above_rest(C) * self.b).exp() * self.mu)
    }

    fn shear_modulus(&self) -> f64 {
        self.mu
    }
}
