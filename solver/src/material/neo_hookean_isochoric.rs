//! Neo-Hookean law with the isochoric split and one of two volumetric terms.
#![allow(non_snake_case)]

use crate::algebra::real::Real;
use crate::algebra::tensor::{Matrix3, Tensor, contract, map};
use crate::material::constants::ElasticConstants;
use crate::material::constitutive_law::{ConstitutiveLaw, Deformation};
use crate::material::volumetric_term::VolumetricTerm;

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
        self.volumetric.energy(self.constants.bulk_modulus, J)
    }

    #[inline(always)]
    fn bulk_slope<R: Real>(&self, J: R) -> R {
        self.volumetric.slope(self.constants.bulk_modulus, J)
    }

    fn constants(&self) -> ElasticConstants {
        self.constants
    }
}
