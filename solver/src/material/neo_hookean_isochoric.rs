//! Neo-Hookean law with the isochoric split and one of two volumetric terms.
#![allow(non_snake_case)]

use crate::algebra::real::Real;
use crate::algebra::tensor::{Matrix3, Tensor, contract, map};
use crate::material::constants::ElasticConstants;
use crate::material::constitutive_law::{ConstitutiveLaw, Deformation};

/// The volumetric energy U(J) of [`NeoHookeanIsochoric`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumetricTerm {
    /// U = K/2 (J − 1)².
    Quadratic,
    /// U = K/4 (J² − 1 − 2 ln J) (Simo, Taylor 1991).
    SimoTaylor,
}

/// ψ = μ/2 (J^(−2/3) I₁ − 3) + U(J) \[Pa\] (method book, eq. 3.4).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeoHookeanIsochoric {
    constants: ElasticConstants,
    volumetric: VolumetricTerm,
}

impl NeoHookeanIsochoric {
    /// From the constants at rest and the volumetric energy.
    pub fn new(constants: ElasticConstants, volumetric: VolumetricTerm) -> Self {
        NeoHookeanIsochoric { constants, volumetric }
    }
}

impl ConstitutiveLaw for NeoHookeanIsochoric {
    fn strain_energy(&self, F: &Matrix3) -> f64 {
        let mu = self.constants.shear_modulus;
        let J = F.determinant();
        0.5 * mu * (F.dot(F) / J.cbrt().powi(2) - 3.0) + self.bulk_energy(J)
    }

    /// P = μ J^(−2/3) (F − I₁/3 F⁻ᵀ) + U'(J) cof F.
    #[inline(always)]
    fn first_piola_kirchhoff<R: Real>(&self, state: &Deformation<R>) -> Tensor<R> {
        let Deformation { F, cof, J } = state;
        let factor = J.power_minus_two_thirds() * self.constants.shear_modulus;
        let volumetric = self.bulk_slope(*J) - factor * contract(F, F) / (*J * 3.0);
        map(
            #[inline(always)]
            |i, j| cof[i][j].times_plus(volumetric, F[i][j] * factor),
        )
    }

    fn bulk_energy(&self, J: f64) -> f64 {
        let K = self.constants.bulk_modulus;
        match self.volumetric {
            VolumetricTerm::Quadratic => 0.5 * K * (J - 1.0).powi(2),
            VolumetricTerm::SimoTaylor => 0.25 * K * (J * J - 1.0 - 2.0 * J.ln()),
        }
    }

    #[inline(always)]
    fn bulk_slope<R: Real>(&self, J: R) -> R {
        let K = self.constants.bulk_modulus;
        match self.volumetric {
            VolumetricTerm::Quadratic => (J - 1.0) * K,
            VolumetricTerm::SimoTaylor => (J * J - 1.0) / J * (0.5 * K),
        }
    }

    fn constants(&self) -> ElasticConstants {
        self.constants
    }
}
