//! Masses at the nodes.

mod lumped;
mod moments;

pub use lumped::{fictitious_mass, lumped_mass, masses};
pub use moments::fit_moments;
