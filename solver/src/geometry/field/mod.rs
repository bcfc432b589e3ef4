//! Vectors that depend on the reference position.

mod scattered;
mod vector_field;

pub use scattered::{Scattered, TooFewData};
pub use vector_field::Field;
