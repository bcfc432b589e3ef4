//! Solids as signed distance: negative inside, positive outside \[m\].
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::distance_function::DistanceFunction;
use crate::geometry::polygon::Outline;
use crate::geometry::primitives;
use crate::geometry::surface::Surface;
use crate::geometry::voxels::LabelField;
use std::sync::Arc;

/// How far faces of a hole that lie in faces of its body are moved beyond them \[size of the hole\].
const BEYOND: f64 = 1e-3;
/// Places across a face of a hole where it is looked for those of its body.
const ACROSS: usize = 6;
/// Places closer to a face lie in it \[size of the body\].
const SAME_FACE: f64 = 1e-9;
/// Cosine of the largest angle between normals of one face.
const ALONG: f64 = 1.0 - 1e-6;

/// A solid in space.
#[derive(Debug, Clone)]
pub enum Shape {
    /// An axis-parallel box.
    Box {
        /// Lower corner \[m\].
        min: Vector3,
        /// Upper corner \[m\].
        max: Vector3,
    },
    /// A circular cylinder.
    Cylinder {
        /// Centre of the first end \[m\].
        base: Vector3,
        /// Unit vector from there to the other end.
        axis: Vector3,
        /// \[m\]
        radius: f64,
        /// \[m\]
        height: f64,
    },
    /// A ball.
    Sphere {
        /// \[m\]
        centre: Vector3,
        /// \[m\]
        radius: f64,
    },
    /// An axis-parallel ellipsoid. With an infinite third semi-axis it is an
    /// elliptic cylinder without ends, the form of plane cross-sections.
    Ellipsoid {
        /// \[m\]
        centre: Vector3,
        /// Semi-axes \[m\].
        radii: Vector3,
    },
    /// A simple polygon in the x–y plane, extruded along z.
    Polygon {
        /// Corners \[m\], either way round.
        points: Outline,
        /// Lower and upper end \[m\]; may be infinite.
        z: (f64, f64),
    },
    /// Everything behind a plane: (X − point)·normal ≤ 0.
    HalfSpace {
        /// A point on the plane \[m\].
        point: Vector3,
        /// Unit vector out of the solid.
        normal: Vector3,
    },
    /// All of these together.
    Union(Vec<Shape>),
    /// What all of these have in common.
    Intersection(Vec<Shape>),
    /// The first without the second.
    Difference(Box<Shape>, Box<Shape>),
    /// The voxels of some labels of a label map, with a smooth surface.
    Labels(Arc<LabelField>),
    /// What a closed triangulated surface encloses.
    Surface(Arc<Surface>),
    /// What a function of the caller encloses; its boundary is sampled.
    Function(DistanceFunction),
}

impl Shape {
    /// Signed distance \[m\]: negative inside. Exact for single shapes; for a
    /// union exact outside, for an intersection or a difference a bound of the right sign.
    pub fn signed_distance(&self, X: &Vector3) -> f64 {
        match self {
            Shape::Box { min, max } => primitives::box_distance(X, min, max),
            Shape::Cylinder { base, axis, radius, height } => {
                primitives::cylinder_distance(X, base, axis, *radius, *height)
            }
            Shape::Sphere { centre, radius } => (X - centre).norm() - radius,
            Shape::Ellipsoid { centre, radii } => {
                primitives::ellipsoid_distance(&(X - centre), radii)
            }
            Shape::Polygon { points, z } => primitives::product_distance(
                points.signed_distance(X.x, X.y),
                (z.0 - X.z).max(X.z - z.1),
            ),
            Shape::HalfSpace { point, normal } => (X - point).dot(normal),
            Shape::Union(members) => {
                members.iter().map(|m| m.signed_distance(X)).fold(f64::INFINITY, f64::min)
            }
            Shape::Intersection(members) => {
                members.iter().map(|m| m.signed_distance(X)).fold(f64::NEG_INFINITY, f64::max)
            }
            Shape::Difference(body, hole) => body.signed_distance(X).max(-hole.signed_distance(X)),
            Shape::Labels(field) => field.signed_distance(X),
            Shape::Surface(surface) => surface.signed_distance(X),
            Shape::Function(function) => function.at(X),
        }
    }

    /// Unit gradient of the signed distance, the outward normal on the
    /// boundary. Where several boundary points are nearest, it is one of their
    /// directions or the mean; it is never NaN.
    pub fn gradient(&self, X: &Vector3) -> Vector3 {
        match self {
            Shape::Sphere { centre, .. } => {
                (X - centre).try_normalize(0.0).unwrap_or_else(Vector3::x)
            }
            Shape::Ellipsoid { centre, radii } => {
                primitives::ellipsoid_normal(&(X - centre), radii)
            }
            Shape::HalfSpace { normal, .. } => *normal,
            Shape::Union(members) => {
                let nearest = members
                    .iter()
                    .min_by(|a, b| a.signed_distance(X).total_cmp(&b.signed_distance(X)));
                nearest.map_or_else(Vector3::x, |member| member.gradient(X))
            }
            Shape::Intersection(members) => {
                let farthest = members
                    .iter()
                    .max_by(|a, b| a.signed_distance(X).total_cmp(&b.signed_distance(X)));
                farthest.map_or_else(Vector3::x, |member| member.gradient(X))
            }
            Shape::Difference(body, hole) => {
                if body.signed_distance(X) >= -hole.signed_distance(X) {
                    body.gradient(X)
                } else {
                    -hole.gradient(X)
                }
            }
            Shape::Labels(field) => self.gradient_by_differences(X, 0.25 * field.voxel()),
            _ => self.gradient_by_differences(X, 1e-6 * self.size()),
        }
    }

    /// Whether it is from an image, in part.
    pub(crate) fn has_labels(&self) -> bool {
        match self {
            Shape::Union(members) | Shape::Intersection(members) => {
                members.iter().any(Shape::has_labels)
            }
            Shape::Difference(body, hole) => body.has_labels() || hole.has_labels(),
            _ => matches!(self, Shape::Labels(_)),
        }
    }

    /// This solid without a hole. Where a flat end, face or side of the hole lies in a face of the solid,
    /// it is moved a little beyond: [`Shape::Difference`] as such has a boundary there, the mouth
    /// of the hole, on both sides of which it is empty.
    pub fn without(self, hole: Shape) -> Shape {
        let hole = hole.through_faces_of(&self);
        Shape::Difference(Box::new(self), Box::new(hole))
    }

    /// With flat faces that lie in those of a `body` moved beyond them.
    fn through_faces_of(self, body: &Shape) -> Shape {
        let all = |members: Vec<Shape>| {
            members.into_iter().map(|member| member.through_faces_of(body)).collect()
        };
        // Of what has faces across an axis.
        let moved = |axis: usize, side: f64| {
            let Some((min, max)) = self.bounding_box() else { return 0.0 };
            let half = 0.5 * (max - min);
            let along = |axis: usize| Vector3::ith(axis % 3, half[axis % 3]);
            let middle = 0.5 * (min + max) + side * along(axis);
            let ways = [along(axis + 1), along(axis + 2)];
            self.step_beyond(body, middle, Vector3::ith(axis, side), ways)
        };
        match self {
            Shape::Box { min, max } => Shape::Box {
                min: min - Vector3::from_fn(|axis, _| moved(axis, -1.0)),
                max: max + Vector3::from_fn(|axis, _| moved(axis, 1.0)),
            },
            Shape::Cylinder { base, axis, radius, height } => {
                let across = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
                let ways = [radius * across, radius * axis.cross(&across)];
                let below = self.step_beyond(body, base, -axis, ways);
                let above = self.step_beyond(body, base + height * axis, axis, ways);
                let (base, height) = (base - below * axis, height + below + above);
                Shape::Cylinder { base, axis, radius, height }
            }
            Shape::Polygon { ref points, z: (lower, upper) } => {
                let z = (lower - moved(2, -1.0), upper + moved(2, 1.0));
                // Places in the plane where it has no ends.
                let (middle, half) = if (upper - lower).is_finite() {
                    (0.5 * (lower + upper), 0.5 * (upper - lower))
                } else {
                    (0.0, 0.0)
                };
                let points = points.with_edges_moved(|[x, y], normal, way| {
                    let ways = [Vector3::new(way[0], way[1], 0.0), half * Vector3::z()];
                    let normal = Vector3::new(normal[0], normal[1], 0.0);
                    self.step_beyond(body, Vector3::new(x, y, middle), normal, ways)
                });
                Shape::Polygon { points, z }
            }
            Shape::Union(members) => Shape::Union(all(members)),
            Shape::Intersection(members) => Shape::Intersection(all(members)),
            other => other,
        }
    }

    /// How far a flat face of this hole moves beyond the face of a `body` that it lies in, 0 where
    /// it lies in none; by its middle, its normal and two ways from there to its rim.
    fn step_beyond(
        &self,
        body: &Shape,
        middle: Vector3,
        normal: Vector3,
        ways: [Vector3; 2],
    ) -> f64 {
        let beyond = BEYOND * self.size();
        let share = |i: usize| (2 * i + 1) as f64 / ACROSS as f64 - 1.0;
        let mut places = (0..ACROSS * ACROSS)
            .map(|i| middle + share(i % ACROSS) * ways[0] + share(i / ACROSS) * ways[1])
            .filter(|X| self.signed_distance(X) < SAME_FACE * self.size());
        let lies_in_face = |X: Vector3| {
            body.signed_distance(&X).abs() < SAME_FACE * body.size()
                && body.gradient(&X).dot(&normal) > ALONG
                && body.signed_distance(&(X + beyond * normal)) > 0.5 * beyond
        };
        if places.any(lies_in_face) { beyond } else { 0.0 }
    }

    /// The most that the signed distance changes over a length \[–\].
    pub(crate) fn steepness(&self) -> f64 {
        match self {
            Shape::Union(members) | Shape::Intersection(members) => {
                members.iter().map(Shape::steepness).fold(1.0, f64::max)
            }
            Shape::Difference(body, hole) => body.steepness().max(hole.steepness()),
            // Distances of neighbouring voxels differ by little more than theirs.
            Shape::Labels(_) => 2.0,
            _ => 1.0,
        }
    }

    fn gradient_by_differences(&self, X: &Vector3, step: f64) -> Vector3 {
        // On a medial axis the differences cancel; beside it they do not.
        for offset in [Vector3::zeros(), Vector3::new(1.3, 2.1, 3.7) * step] {
            let difference = Vector3::from_fn(|k, _| {
                let mut shift = Vector3::zeros();
                shift[k] = step;
                let there = X + offset;
                self.signed_distance(&(there + shift)) - self.signed_distance(&(there - shift))
            });
            if difference.norm() > 0.2 * step {
                return difference.normalize();
            }
        }
        Vector3::x()
    }

    /// Largest finite edge of the bounding box \[m\]; 1 if there is none.
    pub(crate) fn size(&self) -> f64 {
        let edges = self.bounding_box().map(|(lower, upper)| upper - lower);
        edges
            .map(|e| e.iter().copied().filter(|l| l.is_finite()).fold(0.0, f64::max))
            .filter(|&l| l > 0.0)
            .unwrap_or(1.0)
    }

    /// Lower and upper corner of an axis-parallel box around the solid \[m\],
    /// `None` if it is unbounded in the x–y plane. A plane cross-section has
    /// infinite z.
    pub fn bounding_box(&self) -> Option<(Vector3, Vector3)> {
        match self {
            Shape::Box { min, max } => Some((*min, *max)),
            Shape::Cylinder { base, axis, radius, height } => {
                let top = base + *height * axis;
                let reach = axis.map(|a| radius * (1.0 - a * a).max(0.0).sqrt());
                Some((base.inf(&top) - reach, base.sup(&top) + reach))
            }
            Shape::Sphere { centre, radius } => {
                let reach = Vector3::repeat(*radius);
                Some((centre - reach, centre + reach))
            }
            Shape::Ellipsoid { centre, radii } => Some((centre - radii, centre + radii)),
            Shape::Polygon { points, z } => {
                let (lower, upper) = points.bounds();
                Some((Vector3::new(lower[0], lower[1], z.0), Vector3::new(upper[0], upper[1], z.1)))
            }
            Shape::HalfSpace { .. } => None,
            Shape::Union(members) => {
                let mut boxes = members.iter().map(Shape::bounding_box);
                let first = boxes.next()??;
                boxes.try_fold(first, |(l, u), next| next.map(|(nl, nu)| (l.inf(&nl), u.sup(&nu))))
            }
            Shape::Intersection(members) => {
                let bounded = members.iter().filter_map(Shape::bounding_box);
                bounded.reduce(|(l, u), (nl, nu)| (l.sup(&nl), u.inf(&nu)))
            }
            Shape::Difference(body, _) => body.bounding_box(),
            Shape::Labels(field) => Some(field.bounding_box()),
            Shape::Surface(surface) => Some(surface.bounding_box()),
            Shape::Function(function) => Some(function.bounds()),
        }
    }

    /// Name of the shape in messages.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Shape::Box { .. } => "box",
            Shape::Cylinder { .. } => "cylinder",
            Shape::Sphere { .. } => "sphere",
            Shape::Ellipsoid { .. } => "ellipsoid",
            Shape::Polygon { .. } => "polygon",
            Shape::HalfSpace { .. } => "half-space",
            Shape::Union(_) => "union",
            Shape::Intersection(_) => "intersection",
            Shape::Difference(..) => "difference",
            Shape::Labels(_) => "label map",
            Shape::Surface(_) => "surface",
            Shape::Function(_) => "distance function",
        }
    }
}
