//! What the internal force needs of a law.
#![allow(non_snake_case)]

use crate::algebra::real::Real;
use crate::algebra::tensor::{Matrix3, Tensor, dot, tensor_cofactor};
use crate::material::constants::ElasticConstants;

/// F with what every law computes from it.
#[derive(Debug, Clone, Copy)]
pub struct Deformation<R> {
    /// Deformation gradient \[–\]
    pub F: Tensor<R>,
    /// cof F = J F⁻ᵀ \[–\]
    pub cof: Tensor<R>,
    /// det F \[–\]
    pub J: R,
}

impl<R: Real> Deformation<R> {
    /// From the deformation gradient.
    #[inline(always)]
    pub fn new(F: Tensor<R>) -> Deformation<R> {
        let cof = tensor_cofactor(&F);
        Deformation { F, cof, J: dot(&F[0], &cof[0]) }
    }
}

/// What the internal force needs of a law; the loops over the stresses are
/// compiled once per law.
pub trait ConstitutiveLaw: Copy + Send + Sync {
    /// Whether F is given in the fibre frame, F Q with the directions of fibres, sheets and their
    /// normals as columns of Q, and P as P Q.
    const HAS_FIBRES: bool = false;
    /// Strain energy per reference volume ψ \[Pa\].
    fn strain_energy(&self, F: &Matrix3) -> f64;
    /// First Piola–Kirchhoff stress P \[Pa\].
    fn first_piola_kirchhoff<R: Real>(&self, state: &Deformation<R>) -> Tensor<R>;
    /// Shear and bulk modulus at rest.
    fn constants(&self) -> ElasticConstants;

    /// The part U(J) of ψ that resists a change of volume \[Pa\], convex, with
    /// U'(1) = 0; λ/2 (J − 1)² where ψ has no such part (method book, eq. 3.12).
    fn bulk_energy(&self, J: f64) -> f64 {
        0.5 * self.constants().lame_modulus() * (J - 1.0).powi(2)
    }

    /// U'(J) \[Pa\].
    #[inline(always)]
    fn bulk_slope<R: Real>(&self, J: R) -> R {
        (J - 1.0) * self.constants().lame_modulus()
    }
}
