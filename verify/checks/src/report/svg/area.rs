//! The part of a plot inside its axes.

use super::axis::Scale;

/// The frame that the curves are drawn in.
pub(super) struct Area {
    pub x: Scale,
    pub y: Scale,
    /// Edges in pixels.
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

impl Area {
    /// Pixels of a point, None where it cannot be drawn.
    pub(crate) fn place(&self, (x, y): (f64, f64)) -> Option<[f64; 2]> {
        Some([self.x.position(x)?, self.y.position(y)?])
    }
}
