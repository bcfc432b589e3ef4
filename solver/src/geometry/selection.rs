//! Which nodes or boundary points a condition acts on.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::boundary::Panel;
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

/// An edge belongs to both of its faces: normals are taken this far from it too, over the size
/// of the body \[–\].
const NEXT_TO: f64 = 1e-4;
/// Of cosines \[–\].
const ROUND_OFF: f64 = 1e-9;

/// Cosine of the largest angle at which one face lies along another \[–\].
const ALONG: f64 = 0.999;
/// A level beyond all others \[m\].
const BEYOND: f64 = 1e300;

/// Places next to X on both sides along every axis.
fn around(X: &Vector3, distance: f64) -> impl Iterator<Item = Vector3> {
    (0..3).flat_map(move |axis| [-distance, distance].map(|way| X + Vector3::ith(axis, way)))
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
    /// Where the boundary of a solid faces a direction; away from the boundary, where its
    /// nearest place does.
    Facing {
        /// The solid.
        body: Box<Shape>,
        /// Unit vector.
        direction: Vector3,
        /// The largest angle between the outward normal and the direction \[rad\].
        angle: f64,
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
        self.selects(X, None)
    }

    /// Whether it says in some words that it selects everything.
    pub fn is_everything(&self) -> bool {
        match self {
            Selector::All => true,
            Selector::Not(part) => part.is_nothing(),
            Selector::Union(parts) => parts.iter().any(Selector::is_everything),
            Selector::Intersection(parts) => parts.iter().all(Selector::is_everything),
            _ => false,
        }
    }

    fn is_nothing(&self) -> bool {
        match self {
            Selector::Not(part) => part.is_everything(),
            Selector::Union(parts) => parts.iter().all(Selector::is_nothing),
            Selector::Intersection(parts) => parts.iter().any(Selector::is_nothing),
            _ => false,
        }
    }

    /// Whether a piece of the boundary is selected, by its centre and its normal.
    pub fn contains_panel(&self, panel: &Panel) -> bool {
        self.selects(&panel.centre, Some(&panel.normal))
    }

    /// At most 0 where X, on the boundary with its outward normal there, is selected \[m\].
    /// Tolerances of at most `thin` \[m\] are there for round-off: faces that lie along one of
    /// the selection count as on it, and outlines across faces, as borders within the body, are
    /// where they would be without.
    pub(crate) fn level(&self, X: &Vector3, normal: Option<&Vector3>, thin: f64) -> f64 {
        let sign = |is_selected: bool| if is_selected { -1.0 } else { 1.0 };
        let of = |part: &Selector| part.level(X, normal, thin);
        // Of a distance from a face, which has the gradient there.
        let beside = |distance: f64, tolerance: f64, gradient: &dyn Fn() -> Vector3| match normal {
            _ if tolerance > thin => distance - tolerance,
            Some(normal) if distance.abs() <= tolerance && gradient().dot(normal).abs() > ALONG => {
                -tolerance
            }
            _ => distance,
        };
        match (self, normal) {
            (Selector::All, _) => -BEYOND,
            (Selector::Plane { point, normal, tolerance }, _) => {
                beside((X - point).dot(normal).abs(), *tolerance, &|| *normal)
            }
            (Selector::Inside { shape, tolerance }, _) => {
                beside(shape.signed_distance(X), *tolerance, &|| shape.gradient(X))
            }
            (Selector::Label { map, label }, _) => sign(map.label_at(X) == *label),
            (Selector::Facing { direction, angle, .. }, Some(normal)) => {
                angle.cos() - ROUND_OFF - normal.dot(direction)
            }
            (Selector::Facing { .. }, None) => sign(self.contains(X)),
            (Selector::Union(parts), _) => parts.iter().map(of).fold(BEYOND, f64::min),
            (Selector::Intersection(parts), _) => parts.iter().map(of).fold(-BEYOND, f64::max),
            (Selector::Not(part), _) => -of(part),
        }
    }

    /// The most that [`Self::level`] changes over a length; infinite for labels, and for
    /// directions unless they are those of a flat surface \[–\].
    pub(crate) fn steepness(&self, is_flat: bool) -> f64 {
        match self {
            Selector::Facing { .. } if is_flat => 1.0,
            Selector::Label { .. } | Selector::Facing { .. } => f64::INFINITY,
            Selector::Inside { shape, .. } => shape.steepness(),
            Selector::All | Selector::Plane { .. } => 1.0,
            Selector::Union(parts) | Selector::Intersection(parts) => {
                parts.iter().map(|part| part.steepness(is_flat)).fold(1.0, f64::max)
            }
            Selector::Not(part) => part.steepness(is_flat),
        }
    }

    fn selects(&self, X: &Vector3, normal: Option<&Vector3>) -> bool {
        match self {
            Selector::All => true,
            Selector::Plane { point, normal, tolerance } => {
                (X - point).dot(normal).abs() <= *tolerance
            }
            Selector::Inside { shape, tolerance } => shape.signed_distance(X) <= *tolerance,
            Selector::Label { map, label } => map.label_at(X) == *label,
            Selector::Facing { body, direction, angle } => {
                let faces = |normal: &Vector3| normal.dot(direction) >= angle.cos() - ROUND_OFF;
                let beside = || around(X, NEXT_TO * body.size());
                normal.map_or_else(
                    || faces(&body.gradient(X)) || beside().any(|X| faces(&body.gradient(&X))),
                    faces,
                )
            }
            Selector::Union(parts) => parts.iter().any(|part| part.selects(X, normal)),
            Selector::Intersection(parts) => parts.iter().all(|part| part.selects(X, normal)),
            Selector::Not(part) => !part.selects(X, normal),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Dimension;

    fn facing(body: Shape, direction: Vector3, angle: f64) -> Selector {
        Selector::Facing { body: Box::new(body), direction: direction.normalize(), angle }
    }

    #[test]
    fn the_flat_faces_of_a_turned_block_are_selected_with_their_edges() {
        let axis = Vector3::new(1.0, 2.0, -2.0) / 3.0;
        let cylinder =
            Shape::Cylinder { base: Vector3::new(0.1, 0.2, 0.3), axis, radius: 0.2, height: 0.5 };
        let end = facing(cylinder.clone(), axis, 0.1);
        let points = cylinder.boundary_points(0.03, &Dimension::Three).unwrap();
        let on_end = |X: &Vector3| (X - Vector3::new(0.1, 0.2, 0.3)).dot(&axis) > 0.5 - 1e-9;
        assert!(points.iter().filter(|X| on_end(X)).count() > 50);
        for X in &points {
            assert_eq!(end.contains(X), on_end(X), "{X}");
        }
    }

    #[test]
    fn the_side_of_a_ball_that_faces_a_direction_is_a_cap() {
        let ball = Shape::Sphere { centre: Vector3::zeros(), radius: 0.5 };
        let cap = facing(ball.clone(), Vector3::new(0.0, -2.0, 0.0), 0.8);
        for panel in ball.boundary_panels(0.05, &Dimension::Three).unwrap() {
            let angle = (-panel.centre.normalize().y).acos();
            if (angle - 0.8).abs() > 1e-3 {
                assert_eq!(cap.contains_panel(&panel), angle < 0.8, "{angle}");
                assert_eq!(cap.contains(&panel.centre), angle < 0.8, "{angle}");
            }
        }
    }
}
