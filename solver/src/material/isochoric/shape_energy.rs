//! The part of an energy that resists a change of shape.
#![allow(non_snake_case)]

use crate::algebra::real::Real;
use crate::algebra::tensor::{Tensor, map};
use crate::material::constants::MaterialError;
use std::fmt::Debug;

/// A constant of a law, as case files and messages name it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Constant {
    /// Such as `b_f`.
    pub name: &'static str,
    /// SI, `–` for a number.
    pub unit: &'static str,
    /// Whether it is 0 where it is not given.
    pub is_optional: bool,
}

impl Constant {
    /// Of a constant that must be given.
    pub const fn needed(name: &'static str, unit: &'static str) -> Constant {
        Constant { name, unit, is_optional: false }
    }

    /// Of a constant that is 0 where it is not given.
    pub const fn zero_if_left_out(name: &'static str, unit: &'static str) -> Constant {
        Constant { name, unit, is_optional: true }
    }
}

/// The part ψ̄ of an energy that resists a change of shape. Where it has fibres, tensors are those of
/// the fibre frame: the first axis along the fibres, the second along the sheets, the third normal
/// to both.
pub trait ShapeEnergy: Copy + Send + Sync + PartialEq + Debug {
    /// The law with this energy in case files.
    const NAME: &'static str;
    /// ψ in words and signs, for people and other programs, with the constants by their names.
    const ENERGY: &'static str;
    /// What [`ShapeEnergy::new`] takes, in this order.
    const CONSTANTS: &'static [Constant];
    /// Whether it depends on the directions of fibres.
    const HAS_FIBRES: bool;
    /// From its constants; refused where there are more or fewer, and where a body would lose its stiffness.
    fn new(constants: &[f64]) -> Result<Self, MaterialError>;
    /// ψ̄(C̄) \[Pa\], 0 at rest.
    fn energy(&self, C: &Tensor<f64>) -> f64;
    /// S̄ = 2 ∂ψ̄/∂C̄ \[Pa\].
    fn stress<R: Real>(&self, C: &Tensor<R>) -> Tensor<R>;
    /// A bound μ of the stiffness at rest in every direction, ψ̄ ≤ μ ε:ε for small strains ε without
    /// a change of volume; the shear modulus itself where there are no fibres \[Pa\].
    fn shear_modulus(&self) -> f64;
    /// Whether it needs the direction of sheets too.
    fn has_sheets(&self) -> bool {
        false
    }
}

/// s I.
#[inline(always)]
pub fn spherical<R: Real>(s: R) -> Tensor<R> {
    let zero = s * 0.0;
    map(
        #[inline(always)]
        |i, j| if i == j { s } else { zero },
    )
}

/// tr C̄ − 3.
#[inline(always)]
pub fn first_invariant_above_rest<R: Real>(C: &Tensor<R>) -> R {
    (C[0][0] - 1.0) + (C[1][1] - 1.0) + (C[2][2] - 1.0)
}

/// Refuses a constant that is negative or no number.
pub fn not_negative(name: &'static str, value: f64) -> Result<(), MaterialError> {
    if value >= 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(MaterialError::Negative { name, value })
    }
}

/// The constants of a law, as many as it takes.
pub fn exactly<const N: usize>(constants: &[f64]) -> Result<[f64; N], MaterialError> {
    let counts = MaterialError::Constants { given: constants.len(), taken: N };
    constants.try_into().map_err(|_| counts)
}
