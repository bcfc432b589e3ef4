//! Quadrature points in blocks that the internal force runs over (method book,
//! section 11).

mod block;
mod partition;
mod stored_gradients;
mod summation;

pub use block::{Block, Chunk};
pub use partition::blocks;
pub(crate) use stored_gradients::with_gradients;
pub use stored_gradients::{StoredGradients, StoredNumber};
pub use summation::Sums;
