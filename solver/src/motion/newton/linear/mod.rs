//! The linear systems of corrections.

mod coarse_space;
mod conjugate_gradients;
mod due_factors;
mod elimination_order;
mod factors;
mod guide;
mod minimal_residuals;
mod nodal_values;
mod preconditioner;
mod system;

pub(super) use conjugate_gradients::Solver;
pub(super) use guide::Guide;
pub(super) use minimal_residuals::MOST as MOST_WITH_PRESSURES;
pub(super) use system::{Correction, Saddle, SaddlePatch, System};
