//! Which nodes the points beside a held volume see.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::Shape;
use rayon::prelude::*;

/// Nodes that are closer to the border lie on it \[spacing\].
pub(crate) const ON_BORDER: f64 = 1e-6;

/// The two sides of the border of what is held as a volume. What deforms sees its own nodes and
/// those on the border, and so does what is held (method book, section 6).
#[derive(Debug, Clone)]
pub(super) struct HeldSides {
    held: Shape,
    /// Deeper places are held \[m\].
    on_border: f64,
    /// \[node\]
    side: Vec<Side>,
    /// Whether places that are held see what is held.
    is_open: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    Deforms,
    Border,
    Held,
}

impl HeldSides {
    pub fn new(held: &Shape, nodes: &[Vector3], smallest_spacing: f64) -> HeldSides {
        let on_border = ON_BORDER * smallest_spacing;
        let side = |X: &Vector3| match held.signed_distance(X) {
            distance if distance.abs() <= on_border => Side::Border,
            distance if distance < 0.0 => Side::Held,
            _ => Side::Deforms,
        };
        let side = nodes.par_iter().map(side).collect();
        HeldSides { held: held.clone(), on_border, side, is_open: false }
    }

    /// From here on, what is held has places too. Until then every place is one of what deforms:
    /// near a curved border, points of its quadrature and its boundary lie within what is held.
    pub fn open(&mut self) {
        self.is_open = true;
    }

    /// Whether a place lies within what is held; its border does not.
    pub fn is_held(&self, X: &Vector3) -> bool {
        self.is_open && self.held.signed_distance(X) < -self.on_border
    }

    /// Whether what deforms sees a node.
    pub fn deforms(&self, node: u32) -> bool {
        self.side[node as usize] != Side::Held
    }

    /// Whether what is held sees a node.
    pub fn holds(&self, node: u32) -> bool {
        self.side[node as usize] != Side::Deforms
    }
}
