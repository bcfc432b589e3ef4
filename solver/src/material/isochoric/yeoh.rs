//! Yeoh's law.
#![allow(non_snake_case)]

use super::shape_energy::{Constant, ShapeEnergy, exactly, first_invariant_above_rest, spherical};
use crate::algebra::real::Real;
use crate::algebra::tensor::Tensor;
use crate::material::constants::{MaterialError, positive};

/// ψ̄ = C₁ x + C₂ x² + C₃ x³ \[Pa\] with x = Ī₁ − 3 (Yeoh, Rubber Chem. Technol. 66, 754, 1993).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Yeoh {
    factors: [f64; 3],
}

impl ShapeEnergy for Yeoh {
    const NAME: &'static str = "yeoh";
    const ENERGY: &'static str =
        "C1 x + C2 x² + C3 x³ + U(J), x = Ī₁ − 3 [Pa]; C2 and C3 are 0 if left out";
    const CONSTANTS: &'static [Constant] = &[
        Constant::needed("C1", "Pa"),
        Constant::zero_if_left_out("C2", "Pa"),
        Constant::zero_if_left_out("C3", "Pa"),
    ];
    const HAS_FIBRES: bool = false;

    /// C₁ > 0; refused where the slope C₁ + 2 C₂ x + 3 C₃ x² is not positive for every x ≥ 0.
    fn new(constants: &[f64]) -> Result<Yeoh, MaterialError> {
        let [c1, c2, c3] = exactly(constants)?;
        positive("C1", c1)?;
        let sound = c2.is_finite() && c3.is_finite() && c3 >= 0.0;
        // The vertex of the parabola lies at x > 0 where C₂ < 0.
        if !sound || (c2 < 0.0 && c2 * c2 >= 3.0 * c1 * c3) {
            return Err(MaterialError::UnstableYeoh { c1, c2, c3 });
        }
        Ok(Yeoh { factors: [c1, c2, c3] })
    }

    fn energy(&self, C: &Tensor<f64>) -> f64 {
        let ([c1, c2, c3], x) = (self.factors, first_invariant_above_rest(C));
        x * (c1 + x * (c2 + x * c3))
    }

    #[inline(always)]
    fn stress<R: Real>(&self, C: &Tensor<R>) -> Tensor<R> {
        let ([c1, c2, c3], x) = (self.factors, first_invariant_above_rest(C));
        spherical((x * (6.0 * c3) + 4.0 * c2) * x + 2.0 * c1)
    }

    fn shear_modulus(&self) -> f64 {
        2.0 * self.factors[0]
    }
}
