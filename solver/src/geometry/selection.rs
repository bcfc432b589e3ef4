//! Which nodes or boundary points a condition acts on.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::shape::Shape;
use crate::geometry::voxels::LabelMap;
use std::sync::Arc;

/// Whether a selection applies to the boundary of the body or to all of its
/// nodes; "fixed where z < c" means different things for the two.
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
    /// Within `tolerance` of a plane.
    Plane {
        /// A point on the plane \[m\].
        point: Vector3,
        /// Unit vector perpendicular to it.
        normal: Vector3,
        /// \[m\]
        tolerance: f64,
    },
    /// Inside or on a solid, within a tolerance.
    Inside {
        /// The solid.
        shape: Shape,
        /// \[m\]
        tolerance: f64,
    },
    /// In a voxel of one label.
    Label {
        /// The image.
        map: Arc<LabelMap>,
        /// The label in it.
        label: u32,
    },
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
