//! Moving least squares: φ and Grad φ at a point (method book, section 6).

mod approximation;
mod held_sides;
mod inverse;
mod radii;
mod regularised;
mod sides;
mod stiffness;
mod sums;
mod support;
mod visibility;

pub use approximation::{Approximation, LARGEST_ENLARGEMENT};
pub(crate) use held_sides::ON_BORDER;
pub(crate) use inverse::inverse;
pub use stiffness::Stiffness;
pub(crate) use stiffness::{Crossing, are_opposite};
pub(crate) use support::Scratch;
pub use support::{PoorSupport, Support};

#[cfg(test)]
mod tests;
