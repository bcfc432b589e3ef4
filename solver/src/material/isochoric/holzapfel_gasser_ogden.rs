//! The arterial law of Gasser, Ogden and Holzapfel: two families of fibres, each dispersed.
#![allow(non_snake_case)]

use super::shape_energy::{Constant, ShapeEnergy, exactly, first_invariant_above_rest};
use crate::algebra::real::Real;
use crate::algebra::tensor::{Tensor, map};
use crate::material::constants::{MaterialError, positive};

/// ψ̄ = μ/2 (Ī₁ − 3) + k₁/2k₂ Σ_i (e^(k₂ E_i²) − 1) \[Pa\] over two families i of fibres, with
/// E_i = ⟨κ (Ī₁ − 3) + (1 − 3κ)(Ī₄_i − 1)⟩, 0 where the fibres are compressed, and Ī₄_i = M_i·C̄M_i;
/// M_i lie at ± `angle` from the fibre direction towards that of the sheets (Gasser, Ogden, Holzapfel,
/// J. R. Soc. Interface 3, 15, 2006, eqs. 4.1 to 4.5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HolzapfelGasserOgden {
    mu: f64,
    k1: f64,
    k2: f64,
    kappa: f64,
    /// M_i ⊗ M_i.
    families: [[[f64; 2]; 2]; 2],
}

impl HolzapfelGasserOgden {
    /// E_i before its negative part is cut off.
    #[inline(always)]
    fn strain<R: Real>(&self, C: &Tensor<R>, M: &[[f64; 2]; 2]) -> R {
        let along = C[0][0] * M[0][0] + C[0][1] * (2.0 * M[0][1]) + C[1][1] * M[1][1] - 1.0;
        first_invariant_above_rest(C) * self.kappa + along * (1.0 - 3.0 * self.kappa)
    }
}

impl ShapeEnergy for HolzapfelGasserOgden {
    const NAME: &'static str = "holzapfel_gasser_ogden";
    const ENERGY: &'static str = "mu/2 (Ī₁ − 3) + k1/2k2 Σ (exp(k2 E²) − 1) + U(J), E = max(0, kappa (Ī₁ − 3) + (1 − 3 kappa)(m·C̄m − 1)) of \
         two families m of fibres at ± angle [rad] from `fibres` towards `sheets`; kappa and angle are 0 if left out";
    const CONSTANTS: &'static [Constant] = &[
        Constant::needed("mu", "Pa"),
        Constant::needed("k1", "Pa"),
        Constant::needed("k2", "–"),
        Constant::zero_if_left_out("kappa", "–"),
        Constant::zero_if_left_out("angle", "rad"),
    ];
    const HAS_FIBRES: bool = true;

    fn new(constants: &[f64]) -> Result<HolzapfelGasserOgden, MaterialError> {
        let [mu, k1, k2, kappa, angle] = exactly(constants)?;
        for (name, value) in [("mu", mu), ("k1", k1), ("k2", k2)] {
            positive(name, value)?;
        }
        if !(0.0..=1.0 / 3.0 + 1e-12).contains(&kappa) {
            return Err(MaterialError::Dispersion { value: kappa });
        }
        if !angle.is_finite() {
            return Err(MaterialError::Angle { value: angle });
        }
        let (sine, cosine) = angle.sin_cos();
        let family = |s: f64| [[cosine * cosine, cosine * s], [cosine * s, s * s]];
        let families = [family(sine), family(-sine)];
        Ok(HolzapfelGasserOgden { mu, k1, k2, kappa, families })
    }

    fn energy(&self, C: &Tensor<f64>) -> f64 {
        let fibres = self.families.iter().map(|M| {
            let strain = self.strain(C, M).max(0.0);
            0.5 * self.k1 / self.k2 * (self.k2 * strain * strain).exp_m1()
        });
        0.5 * self.mu * first_invariant_above_rest(C) + fibres.sum::<f64>()
    }

    #[inline(always)]
    fn stress<R: Real>(&self, C: &Tensor<R>) -> Tensor<R> {
        let [a, b] = self.families.map(
            #[inline(always)]
            |M| {
                let strain = self.strain(C, &M);
                let strain = strain.where_not_negative(strain);
                (strain * strain * self.k2).exp() * strain * (2.0 * self.k1)
            },
        );
        let [M, N] = &self.families;
        let (all, own) = ((a + b) * self.kappa + self.mu, 1.0 - 3.0 * self.kappa);
        map(
            #[inline(always)]
            |i, j| {
                let zero = all * 0.0;
                let start = if i == j { all } else { zero };
                if i < 2 && j < 2 {
                    start + a * (own * M[i][j]) + b * (own * N[i][j])
                } else {
                    start
                }
            },
        )
    }

    /// μ + 8/3 k₁ (1 − 3κ)²: fibres of both families in tension along one direction.
    fn shear_modulus(&self) -> f64 {
        self.mu + 8.0 / 3.0 * self.k1 * (1.0 - 3.0 * self.kappa).powi(2)
    }

    fn has_sheets(&self) -> bool {
        self.families[0][1][1] > 0.0
    }
}
