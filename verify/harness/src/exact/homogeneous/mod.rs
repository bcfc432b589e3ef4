//! Bodies that deform homogeneously.

pub mod biaxial;
mod roots;
pub mod shear;
pub mod uniaxial;
