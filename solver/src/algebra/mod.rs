//! Numbers, vectors and matrices that everything else is written in.

pub(crate) mod lanes;
pub(crate) mod packed;
pub mod real;
pub mod tensor;
