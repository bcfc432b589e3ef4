//! Numbers, vectors, tensors and packed fields.

pub(crate) mod block_matrix;
pub(crate) mod lanes;
pub(crate) mod lowest_modes;
pub(crate) mod packed;
pub(crate) mod pseudo_inverse;
pub mod random;
pub mod real;
pub(crate) mod sets;
pub(crate) mod sparse;
pub(crate) mod sparse_cholesky;
pub mod spectral;
pub(crate) mod spline_lattice;
pub mod tensor;
