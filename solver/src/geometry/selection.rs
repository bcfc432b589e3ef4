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
    /// Every node of the body, boundary nodes included. What is held as a volume for ever, in all
    /// components, does not deform.
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

/// Whether any is true, where that is known.
fn whether_any(mut all: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    all.try_fold(Some(false), |any, one| match (any, one) {
        (_, Some(true)) => Err(Some(true)),
        (Some(false), Some(false)) => Ok(Some(false)),
        _ => Ok(None),
    })
    .unwrap_or_else(|any| any)
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
        /// The image; of a body made of labels the one that is [filled](LabelMap::filled) with them, or a skin
        /// of its smooth surface has no label.
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

    /// The same with fewer words: what is not in what is not in a part is in it.
    pub(crate) fn in_few_words(&self) -> &Selector {
        match self {
            Selector::Not(part) => match &**part {
                Selector::Not(part) => part.in_few_words(),
                _ => self,
            },
            _ => self,
        }
    }

    /// The solid whose part in a body it selects; `None` where it is none, such as a plane or
    /// directions, where voxels decide, and where it reaches beyond its shape by more than `thin` \[m\].
    pub(crate) fn solid(&self, body: &Shape, thin: f64) -> Option<Shape> {
        let all = |parts: &[Selector]| {
            let parts = parts.iter().filter(|part| !part.is_everything());
            parts.map(|part| part.solid(body, thin)).collect::<Option<Vec<Shape>>>()
        };
        match self.in_few_words() {
            part if part.is_everything() => Some(body.clone()),
            Selector::Inside { shape, tolerance } if *tolerance <= thin => Some(shape.clone()),
            Selector::Union(parts) => Some(Shape::Union(all(parts)?)),
            Selector::Intersection(parts) => Some(Shape::Intersection(all(parts)?)),
            Selector::Not(part) => {
                let hole = Box::new(part.solid(body, thin)?);
                Some(Shape::Difference(Box::new(body.clone()), hole))
            }
            _ => None,
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

    /// Whether all places within `reach` \[m\] of X are selected, or none of them; `None` where
    /// that is not known.
    pub(crate) fn holds_around(&self, X: &Vector3, reach: f64) -> Option<bool> {
        let of = |part: &Selector| part.holds_around(X, reach);
        let beyond = |level: f64, reach: f64| (level.abs() > reach).then_some(level < 0.0);
        match self {
            Selector::All => Some(true),
            Selector::Plane { point, normal, tolerance } => {
                beyond((X - point).dot(normal).abs() - tolerance, reach)
            }
            Selector::Inside { shape, tolerance } => {
                beyond(shape.signed_distance(X) - tolerance, shape.steepness() * reach)
            }
            Selector::Label { map, label } => match map.range_around(X, reach) {
                (low, high) if low == high => Some(low == *label),
                (low, high) => (*label < low || *label > high).then_some(false),
            },
            Selector::Facing { .. } => None,
            Selector::Union(parts) => whether_any(parts.iter().map(of)),
            Selector::Intersection(parts) => {
                whether_any(parts.iter().map(|part| of(part).map(|holds| !holds))).map(|any| !any)
            }
            Selector::Not(part) => of(part).map(|holds| !holds),
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

    #[test]
    fn what_is_known_about_a_place_holds_at_every_place_about_it() {
        let size = [9, 8, 7];
        let label = |n: usize| [0, 4, 4, 2, 7][n / 29 % 5];
        let labels = (0..size.iter().product()).map(label).collect();
        let directions = nalgebra::Matrix3::identity() * 0.1;
        let map = Arc::new(LabelMap::new(size, Vector3::zeros(), directions, labels).unwrap());
        let label = |label| Selector::Label { map: map.clone(), label };
        let ball = Shape::Sphere { centre: Vector3::repeat(0.4), radius: 0.3 };
        let ball = Selector::Inside { shape: ball, tolerance: 0.01 };
        let (point, normal) = (Vector3::repeat(0.3), Vector3::new(0.6, 0.0, 0.8));
        let plane = Selector::Plane { point, normal, tolerance: 0.05 };
        let not = |part: &Selector| Selector::Not(Box::new(part.clone()));
        let simple = [label(4), label(2), label(5), ball, plane, Selector::All];
        let mut all = simple.to_vec();
        for one in &simple {
            all.extend([not(one)]);
            for other in &simple {
                all.push(Selector::Union(vec![one.clone(), not(other)]));
                all.push(Selector::Intersection(vec![one.clone(), other.clone()]));
            }
        }
        let mut known = 0;
        for (selector, n) in all.iter().flat_map(|one| (0..150).map(move |n| (one, n as f64))) {
            let random = |seed: f64| ((n + 0.7) * seed).fract();
            let X = Vector3::new(random(0.137), random(0.291), random(0.511));
            let reach = 0.15 * random(0.619);
            let Some(holds) = selector.holds_around(&X, reach) else { continue };
            known += 1;
            for m in 0..27 {
                let way = Vector3::new((m % 3) as f64, (m / 3 % 3) as f64, (m / 9) as f64);
                let way = (way - Vector3::repeat(1.0)).try_normalize(0.0).unwrap_or_default();
                assert_eq!(
                    selector.contains(&(X + reach * way)),
                    holds,
                    "{selector:?} {X} {reach}"
                );
            }
        }
        assert!(known > 3000, "{known}");
    }
}
