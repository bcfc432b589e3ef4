//! Quadrature points in blocks that the internal force runs over (method book,
//! section 11).

mod block;
mod local_vectors;
mod numbering;
mod packed_points;
mod packing;
mod partition;
mod stored_gradients;
mod summation;

pub use block::{Block, Chunk};
pub use local_vectors::{Adder, LocalVectors, Place, QUAD, Reader};
pub use packed_points::PackedPoints;
pub(crate) use stored_gradients::with_gradients;
pub use stored_gradients::{GradientQuad, StoredGradients};
