//! The law of a shape energy and a volumetric one.
#![allow(non_snake_case)]

use super::shape_energy::ShapeEnergy;
use crate::algebra::real::Real;
use crate::algebra::tensor::{
    Matrix3, Tensor, contract, map, right_cauchy_green, tensor, times_symmetric,
};
use crate::material::constants::{ElasticConstants, MaterialError, positive};
use crate::material::constitutive_law::{ConstitutiveLaw, Deformation};
use crate::material::volumetric_term::VolumetricTerm;

/// ψ = ψ̄(C̄) + U(J) \[Pa\] (method book, eq. 3.20).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Isochoric<W> {
    shape: W,
    bulk_modulus: f64,
    volumetric: VolumetricTerm,
}

impl<W: ShapeEnergy> Isochoric<W> {
    /// From ψ̄, the bulk modulus at rest \[Pa\] and the volumetric energy.
    pub fn new(
        shape: W,
        bulk_modulus: f64,
        volumetric: VolumetricTerm,
    ) -> Result<Self, MaterialError> {
        positive("bulk_modulus", bulk_modulus)?;
        Ok(Isochoric { shape, bulk_modulus, volumetric })
    }

    /// ψ̄.
    pub fn shape(&self) -> &W {
        &self.shape
    }
}

impl<W: ShapeEnergy> ConstitutiveLaw for Isochoric<W> {
    const HAS_FIBRES: bool = W::HAS_FIBRES;

    fn strain_energy(&self, F: &Matrix3) -> f64 {
        let J = F.determinant();
        let C = tensor(&(F.transpose() * F / J.cbrt().powi(2)));
        self.shape.energy(&C) + self.bulk_energy(J)
    }

    /// P = J^(−2/3) F S̄ + [U'(J) − S̄:C̄/3J] cof F (method book, eq. 3.21).
    #[inline(always)]
    fn first_piola_kirchhoff<R: Real>(&self, state: &Deformation<R>) -> Tensor<R> {
        let Deformation { F, cof, J } = state;
        let (C, scale) = (right_cauchy_green(F), J.power_minus_two_thirds());
        let C = map(
            #[inline(always)]
            |i, j| C[i][j] * scale,
        );
        let S = self.shape.stress(&C);
        let mean = contract(&S, &C) / *J * (1.0 / 3.0);
        let (FS, factor) = (times_symmetric(F, &S), self.bulk_slope(*J) - mean);
        map(
            #[inline(always)]
            |i, j| cof[i][j].times_plus(factor, FS[i][j] * scale),
        )
    }

    fn bulk_energy(&self, J: f64) -> f64 {
        self.volumetric.energy(self.bulk_modulus, J)
    }

    #[inline(always)]
    fn bulk_slope<R: Real>(&self, J: R) -> R {
        self.volumetric.slope(self.bulk_modulus, J)
    }

    fn constants(&self) -> ElasticConstants {
        ElasticConstants {
            shear_modulus: self.shape.shear_modulus(),
            bulk_modulus: self.bulk_modulus,
        }
    }
}
