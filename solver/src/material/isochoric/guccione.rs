//! The transversely isotropic exponential law of Guccione.
#![allow(non_snake_case)]

use super::shape_energy::{Constant, ShapeEnergy, exactly};
use crate::algebra::real::Real;
use crate::algebra::tensor::{Tensor, contract, map};
use crate::material::constants::{MaterialError, positive};

/// ψ̄ = C/2 (e^Q − 1) \[Pa\], Q = b_f E₁₁² + b_t (E₂₂² + E₃₃² + 2 E₂₃²) + 2 b_fs (E₁₂² + E₁₃²) with
/// Ē = (C̄ − 1)/2 in the fibre frame (Guccione, McCulloch, Waldman, J. Biomech. Eng. 113, 42, 1991;
/// as in Land et al., Proc. R. Soc. A 471:20150641, 2015, eq. 2.1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guccione {
    C: f64,
    b_f: f64,
    b_t: f64,
    b_fs: f64,
}

impl Guccione {
    /// Half of C̄ − 1, and b of each of its entries.
    #[inline(always)]
    fn strain<R: Real>(&self, C: &Tensor<R>) -> Tensor<R> {
        map(
            #[inline(always)]
            |i, j| if i == j { (C[i][i] - 1.0) * 0.5 } else { C[i][j] * 0.5 },
        )
    }

    #[inline(always)]
    fn factor(&self, i: usize, j: usize) -> f64 {
        match (i, j) {
            (0, 0) => self.b_f,
            (0, _) | (_, 0) => self.b_fs,
            _ => self.b_t,
        }
    }
}

impl ShapeEnergy for Guccione {
    const NAME: &'static str = "guccione";
    const ENERGY: &'static str = "C/2 (exp Q − 1) + U(J), Q = b_f E₁₁² + b_t (E₂₂² + E₃₃² + 2 E₂₃²) + 2 b_fs (E₁₂² + E₁₃²), \
         E = (C̄ − 1)/2 with axis 1 along the fibres";
    const CONSTANTS: &'static [Constant] = &[
        Constant::needed("C", "Pa"),
        Constant::needed("b_f", "–"),
        Constant::needed("b_t", "–"),
        Constant::needed("b_fs", "–"),
    ];
    const HAS_FIBRES: bool = true;

    fn new(constants: &[f64]) -> Result<Guccione, MaterialError> {
        let [C, b_f, b_t, b_fs] = exactly(constants)?;
        for (name, value) in [("C", C), ("b_f", b_f), ("b_t", b_t), ("b_fs", b_fs)] {
            positive(name, value)?;
        }
        Ok(Guccione { C, b_f, b_t, b_fs })
    }

    fn energy(&self, C: &Tensor<f64>) -> f64 {
        let E = self.strain(C);
        let squares = (0..9).map(|n| self.factor(n / 3, n % 3) * E[n / 3][n % 3].powi(2));
        0.5 * self.C * squares.sum::<f64>().exp_m1()
    }

    #[inline(always)]
    fn stress<R: Real>(&self, C: &Tensor<R>) -> Tensor<R> {
        let E = self.strain(C);
        let bE = map(
            #[inline(always)]
            |i, j| E[i][j] * self.factor(i, j),
        );
        let factor = contract(&bE, &E).exp() * self.C;
        map(
            #[inline(always)]
            |i, j| bE[i][j] * factor,
        )
    }

    fn shear_modulus(&self) -> f64 {
        0.5 * self.C * self.b_f.max(self.b_t).max(self.b_fs)
    }
}
