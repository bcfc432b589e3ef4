//! Motions that the quadrature hardly sees: zero-energy modes.
//!
//! A motion v counts as a zero-energy mode where the quadrature of the model
//! captures less than [`ZERO_ENERGY_FRACTION`] of the strain energy that a finer
//! rule over the same shape functions gives (method book, eq. 22.1):
//!
//! (vᵀK v + δ vᵀM v)/(vᵀK̂ v + δ vᵀM v) < 0.05, v as the conditions allow,
//!
//! with vᵀK v = Σ_q w_q ε_q : ε_q, K̂ the same by the finer rule, M the volumes of
//! the nodes and δ = 10⁻⁴/L², L the size of the body. The ratio has no unit and
//! does not depend on the spacing; it is near 1 for smooth motions however soft
//! they are, and by the terms with δ for rigid ones. Materials play no part: every
//! sound one resists ε at each point by its shear and the pointwise part of its
//! bulk term, so that the motions without any energy are the same for all.

mod detection;
mod least_captured;
mod neighbourhood;
mod pencil;

pub use detection::{
    ZERO_ENERGY_FRACTION, ZeroEnergyModes, refuse_zero_energy_modes, tested_points,
    zero_energy_modes,
};
pub use least_captured::CapturedMotion;
