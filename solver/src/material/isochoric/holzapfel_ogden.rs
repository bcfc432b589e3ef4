//! The law of Holzapfel and Ogden for the passive muscle of the heart.
#![allow(non_snake_case)]

use super::shape_energy::{
    Constant, ShapeEnergy, exactly, first_invariant_above_rest, not_negative, spherical,
};
use crate::algebra::real::Real;
use crate::algebra::tensor::Tensor;
use crate::material::constants::{MaterialError, positive};

/// ψ̄ = a/2b (e^(b (Ī₁ − 3)) − 1) + Σ_{i = f, s} a_i/2b_i (e^(b_i ⟨Ī₄_i − 1⟩²) − 1) +
/// a_fs/2b_fs (e^(b_fs Ī₈²) − 1) \[Pa\] with Ī₄_f = C̄₁₁, Ī₄_s = C̄₂₂, Ī₈ = C̄₁₂ in the fibre frame;
/// compressed fibres carry nothing (Holzapfel, Ogden, Phil. Trans. R. Soc. A 367, 3445, 2009, eq. 5.38).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HolzapfelOgden {
    matrix: Exponential,
    fibre: Exponential,
    sheet: Exponential,
    shear: Exponential,
}

/// a/2b (e^(b x) − 1).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Exponential {
    a: f64,
    b: f64,
}

impl Exponential {
    fn energy(&self, x: f64) -> f64 {
        if self.a == 0.0 { 0.0 } else { 0.5 * self.a / self.b * (self.b * x).exp_m1() }
    }

    /// The derivative of a/2b e^(b x²), a x e^(b x²).
    #[inline(always)]
    fn of_square<R: Real>(&self, x: R) -> R {
        (x * x * self.b).exp() * x * self.a
    }
}

impl ShapeEnergy for HolzapfelOgden {
    const NAME: &'static str = "holzapfel_ogden";
    const ENERGY: &'static str = "a/2b (exp(b (Ī₁ − 3)) − 1) + a_f/2b_f (exp(b_f max(0, C̄₁₁ − 1)²) − 1) + a_s/2b_s (exp(b_s max(0, C̄₂₂ − 1)²) \
         − 1) + a_fs/2b_fs (exp(b_fs C̄₁₂²) − 1) + U(J), axis 1 along the fibres, 2 in the sheets normal to them; terms of \
         sheets are left out with their constants";
    const CONSTANTS: &'static [Constant] = &[
        Constant::needed("a", "Pa"),
        Constant::needed("b", "–"),
        Constant::needed("a_f", "Pa"),
        Constant::needed("b_f", "–"),
        Constant::zero_if_left_out("a_s", "Pa"),
        Constant::zero_if_left_out("b_s", "–"),
        Constant::zero_if_left_out("a_fs", "Pa"),
        Constant::zero_if_left_out("b_fs", "–"),
    ];
    const HAS_FIBRES: bool = true;

    fn new(constants: &[f64]) -> Result<HolzapfelOgden, MaterialError> {
        let [a, b, a_f, b_f, a_s, b_s, a_fs, b_fs] = exactly(constants)?;
        positive("a", a)?;
        positive("b", b)?;
        let pairs = [("a_f", "b_f", a_f, b_f), ("a_s", "b_s", a_s, b_s)];
        for (name, exponent, a, b) in pairs.into_iter().chain([("a_fs", "b_fs", a_fs, b_fs)]) {
            not_negative(name, a)?;
            not_negative(exponent, b)?;
            if a > 0.0 {
                positive(exponent, b)?;
            }
        }
        let [matrix, fibre, sheet, shear] =
            [(a, b), (a_f, b_f), (a_s, b_s), (a_fs, b_fs)].map(|(a, b)| Exponential { a, b });
        Ok(HolzapfelOgden { matrix, fibre, sheet, shear })
    }

    fn energy(&self, C: &Tensor<f64>) -> f64 {
        let stretched = |along: f64| (along - 1.0).max(0.0).powi(2);
        self.matrix.energy(first_invariant_above_rest(C))
            + self.fibre.energy(stretched(C[0][0]))
            + self.sheet.energy(stretched(C[1][1]))
            + self.shear.energy(C[0][1] * C[0][1])
    }

    #[inline(always)]
    fn stress<R: Real>(&self, C: &Tensor<R>) -> Tensor<R> {
        let exponent = first_invariant_above_rest(C) * self.matrix.b;
        let mut S = spherical(exponent.exp() * self.matrix.a);
        for (axis, family) in [(0, &self.fibre), (1, &self.sheet)] {
            let strain = C[axis][axis] - 1.0;
            let pull = family.of_square(strain.where_not_negative(strain)) * 2.0;
            S[axis][axis] = S[axis][axis] + pull;
        }
        let shear = self.shear.of_square(C[0][1]);
        (S[0][1], S[1][0]) = (S[0][1] + shear, S[1][0] + shear);
        S
    }

    /// a + 4/3 (a_f + a_s) + a_fs: fibres and sheets in tension.
    fn shear_modulus(&self) -> f64 {
        self.matrix.a + 4.0 / 3.0 * (self.fibre.a + self.sheet.a) + self.shear.a
    }

    fn has_sheets(&self) -> bool {
        self.sheet.a > 0.0 || self.shear.a > 0.0
    }
}
