//! Quadrature over the boundary (method book, section 8).

mod panel_fractions;
mod rule;

pub use rule::SurfaceRule;
pub(crate) use rule::is_held;
