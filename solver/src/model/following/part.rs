//! Parts of stiffnesses that are not symmetric.

/// Which part of the stiffness of a load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Following {
    /// A symmetric part, which conjugate gradients take.
    Symmetric,
    /// Kᵀ.
    Transposed,
}
