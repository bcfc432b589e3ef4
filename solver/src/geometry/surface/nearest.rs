//! The place on triangles that is nearest to a point, found in a tree of boxes that lie along
//! the surface.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::primitives::perpendicular;
use crate::geometry::triangles::{Triangle, area_vector, parry};
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::{Triangle as ParryTriangle, TrianglePointLocation};

/// Triangles of a box that is not divided.
const FEW: usize = 4;
/// Boxes that wait for their turn; a tree of 2³² triangles is half as deep.
const WAITING: usize = 64;

/// The nearest place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Number of the triangle.
    pub triangle: u32,
    pub X: Vector3,
    pub feature: Feature,
}

/// Where on a triangle a place is.
#[derive(Debug, Clone, Copy)]
pub(super) enum Feature {
    Vertex(usize),
    /// From the vertex of this number to the next.
    Edge(usize),
    Face,
}

/// Triangles in boxes within boxes, each with one edge along the mean normal of what it holds:
/// so it is as thin as the surface is flat, and hardly nearer to a point than the surface.
#[derive(Debug, Clone)]
pub(super) struct Nearest {
    boxes: Vec<Node>,
    /// In the order of the boxes, with their numbers, about `origin` \[m\].
    triangles: Vec<(ParryTriangle, u32)>,
    origin: Vector3,
}

#[derive(Debug, Clone)]
struct Node {
    axes: [Vector3; 3],
    lower: [f64; 3],
    upper: [f64; 3],
    holds: Holds,
}

#[derive(Debug, Clone, Copy)]
enum Holds {
    /// The next box and this one.
    Boxes(u32),
    /// Triangles from one number to before another.
    Triangles(u32, u32),
}

impl Node {
    /// Squared distance from a point \[m²\], 0 inside.
    fn distance(&self, X: &Vector3) -> f64 {
        let beyond = |k: usize| {
            let along = self.axes[k].dot(X);
            (self.lower[k] - along).max(along - self.upper[k]).max(0.0)
        };
        (0..3).map(|k| beyond(k).powi(2)).sum()
    }
}

impl Nearest {
    /// Of at least one triangle.
    pub fn new(triangles: impl Iterator<Item = Triangle>, origin: Vector3) -> Nearest {
        let mut all: Vec<(Triangle, u32)> =
            triangles.map(|t| t.map(|v| v - origin)).zip(0..).collect();
        let mut boxes = Vec::with_capacity(all.len());
        divide(&mut all, 0, &mut boxes);
        let own = |(t, number): &(Triangle, u32)| {
            (ParryTriangle::new(parry(&t[0]), parry(&t[1]), parry(&t[2])), *number)
        };
        Nearest { boxes, triangles: all.iter().map(own).collect(), origin }
    }

    /// The nearest place.
    pub fn to(&self, X: &Vector3) -> Place {
        let from = X - self.origin;
        let mut best = Place { triangle: 0, X: *X, feature: Feature::Face };
        let mut least = f64::INFINITY;
        let mut waiting = [(0.0, 0_u32); WAITING];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (bound, number) = waiting[count];
            if bound >= least {
                continue;
            }
            match self.boxes[number as usize].holds {
                Holds::Triangles(first, end) => {
                    for (triangle, number) in &self.triangles[first as usize..end as usize] {
                        let (found, location) =
                            triangle.project_local_point_and_get_location(parry(&from), false);
                        let distance = (found.point - parry(&from)).length_squared();
                        if distance < least {
                            least = distance;
                            let X = Vector3::new(found.point.x, found.point.y, found.point.z);
                            best = Place { triangle: *number, X, feature: feature(location) };
                        }
                    }
                }
                Holds::Boxes(second) => {
                    let next = [number + 1, second];
                    let [a, b] = next.map(|n| (self.boxes[n as usize].distance(&from), n));
                    let (near, far) = if a.0 <= b.0 { (a, b) } else { (b, a) };
                    waiting[count] = far;
                    waiting[count + 1] = near;
                    count += 2;
                }
            }
        }
        best.X += self.origin;
        best
    }

    /// The first result of `visit` for the numbers of triangles that may be within `radius`
    /// \[m\] of a point.
    pub fn find_near<T>(
        &self,
        X: &Vector3,
        radius: f64,
        mut visit: impl FnMut(u32) -> Option<T>,
    ) -> Option<T> {
        let from = X - self.origin;
        let mut waiting = vec![0];
        while let Some(number) = waiting.pop() {
            let node = &self.boxes[number as usize];
            if node.distance(&from) > radius * radius {
                continue;
            }
            match node.holds {
                Holds::Boxes(second) => waiting.extend([second, number + 1]),
                Holds::Triangles(first, end) => {
                    let inside = &self.triangles[first as usize..end as usize];
                    let found = inside.iter().find_map(|(_, number)| visit(*number));
                    if found.is_some() {
                        return found;
                    }
                }
            }
        }
        None
    }
}

fn feature(location: TrianglePointLocation) -> Feature {
    match location {
        TrianglePointLocation::OnVertex(k) => Feature::Vertex(k as usize),
        TrianglePointLocation::OnEdge(k, _) => Feature::Edge(k as usize),
        TrianglePointLocation::OnFace(..) | TrianglePointLocation::OnSolid => Feature::Face,
    }
}

/// Adds the box around some triangles, of which the first has a number, and those within it.
fn divide(triangles: &mut [(Triangle, u32)], first: u32, boxes: &mut Vec<Node>) {
    let own = boxes.len();
    boxes.push(around(triangles));
    let count = triangles.len();
    if count <= FEW {
        boxes[own].holds = Holds::Triangles(first, first + count as u32);
        return;
    }
    let middle = |(t, _): &(Triangle, u32)| t[0] + t[1] + t[2];
    let (mut lower, mut upper) = (middle(&triangles[0]), middle(&triangles[0]));
    for triangle in triangles.iter() {
        let at = middle(triangle);
        (lower, upper) = (lower.inf(&at), upper.sup(&at));
    }
    let axis = (upper - lower).imax();
    let half = count / 2;
    triangles.select_nth_unstable_by(half, |a, b| {
        middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.1.cmp(&b.1))
    });
    let (left, right) = triangles.split_at_mut(half);
    divide(left, first, boxes);
    boxes[own].holds = Holds::Boxes(boxes.len() as u32);
    divide(right, first + half as u32, boxes);
}

/// The box around triangles with an edge along their mean normal.
fn around(triangles: &[(Triangle, u32)]) -> Node {
    let areas = triangles.iter().map(|(t, _)| area_vector(t));
    let (mean, sum) =
        areas.fold((Vector3::zeros(), 0.0), |(mean, sum), area| (mean + area, sum + area.norm()));
    let axes = if mean.norm() > 0.5 * sum {
        let normal = mean.normalize();
        let (u, v) = perpendicular(&normal);
        [normal, u, v]
    } else {
        [Vector3::x(), Vector3::y(), Vector3::z()]
    };
    let (mut lower, mut upper) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for vertex in triangles.iter().flat_map(|(t, _)| t) {
        for k in 0..3 {
            let along = axes[k].dot(vertex);
            (lower[k], upper[k]) = (lower[k].min(along), upper[k].max(along));
        }
    }
    Node { axes, lower, upper, holds: Holds::Triangles(0, 0) }
}
