//! Which nodes or boundary points a condition acts on.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::{LabelMap, Shape};
use std::sync::Arc;

/// Whether a selection takes its candidates from the boundary of the body or
/// from all of its nodes. Scenes must say which: "fixed where z < c" means
/// different things for the two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// Nodes on the boundary of the body only.
    Surface,
    /// Every node of the body, boundary nodes included.
    Volume,
}

/// A predicate on reference positions.
#[derive(Debug, Clone)]
pub enum Selector {
    /// Every candidate.
    All,
    /// Within `tolerance` of the plane through `point` with unit `normal`.
    Plane {
        point: Vector3,
        normal: Vector3,
        /// \[m\]
        tolerance: f64,
    },
    /// Inside or on a solid, within a tolerance \[m\]: half-space, box, sphere,
    /// or any other shape.
    Inside { shape: Shape, tolerance: f64 },
    /// In a voxel of this label.
    Label { map: Arc<LabelMap>, label: u32 },
    /// In at least one of these.
    Union(Vec<Selector>),
    /// In all of these.
    Intersection(Vec<Selector>),
    /// Not in this one.
    Not(Box<Selector>),
}

impl Selector {
    /// Whether the reference position `X` \[m\] is selected.
    pub fn contains(&self, X: &Vector3) -> bool {
        match self {
            Selector::All => true,
            Selector::Plane { point, normal, tolerance } => {
                (X - point).dot(normal).abs() <= *tolerance
            }
            Selector::Inside { shape, tolerance } => shape.signed_distance(X) <= *tolerance,
            Selector::Label { map, label } => map.label_at(X) == *label,
            Selector::Union(parts) => parts.iter().any(|part| part.contains(X)),
            Selector::Intersection(parts) => parts.iter().all(|part| part.contains(X)),
            Selector::Not(part) => !part.contains(X),
        }
    }
}
