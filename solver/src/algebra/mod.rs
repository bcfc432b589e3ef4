//! Numbers, vectors, tensors and packed fields.

pub(crate) mod lanes;
pub(crate) mod packed;
pub mod random;
pub mod real;
pub mod spectral;
pub mod tensor;
