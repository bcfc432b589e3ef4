//! Obstacles where they are at a time: gaps, normals, and places on their surface.
#![allow(non_snake_case)]

use super::plan::{Components, ContactPlan};
use crate::algebra::tensor::{Vector3, bounding_box};
use crate::geometry::indices;
use crate::problem::{Obstacle, ObstacleSide};
use nalgebra::{Isometry3, Point3};

/// Least part of a normal in the free components, over its length, with which an obstacle
/// pushes \[–\].
const PUSHES: f64 = 0.1;
/// Gap left after a node is moved to the surface, over the depth of its entry \[–\].
const LEFT_OPEN: f64 = 1e-6;
/// Secants towards the surface; a gap that is a distance needs none.
const MOST_SECANTS: usize = 6;
/// Instants at which what moves is followed.
const INSTANTS: usize = 33;

/// An obstacle where it is at a time.
#[derive(Debug, Clone, Copy)]
pub struct Placed<'a> {
    /// As stated in the problem; in a plane its section.
    pub obstacle: &'a Obstacle,
    /// Nothing where it stands still.
    place: Option<Isometry3<f64>>,
}

impl Placed<'_> {
    /// Where a place \[m\] was before the obstacle moved, seen from it.
    pub(crate) fn own(&self, x: &Vector3) -> Vector3 {
        self.place.map_or(*x, |place| place.inverse_transform_point(&Point3::from(*x)).coords)
    }

    /// Where a place of the obstacle is now \[m\].
    pub(crate) fn now(&self, own: &Vector3) -> Vector3 {
        self.place.map_or(*own, |place| place.transform_point(&Point3::from(*own)).coords)
    }

    /// Signed gap \[m\] at current position `x` \[m\], open if positive (method book, eq. 16.1).
    pub fn gap(&self, x: &Vector3) -> f64 {
        let distance = self.obstacle.shape.signed_distance(&self.own(x)) - self.obstacle.offset;
        match self.obstacle.side {
            ObstacleSide::Outside => distance,
            ObstacleSide::Inside => -distance,
        }
    }

    /// The unit normal that points out of the obstacle towards the body, in the free components
    /// (method book, eq. 16.3); zero where the obstacle faces along the others.
    pub(crate) fn normal(&self, x: &Vector3, free: Components) -> Vector3 {
        let gradient = self.obstacle.shape.gradient(&self.own(x));
        let gradient = self.place.map_or(gradient, |place| place.rotation * gradient);
        let outward = match self.obstacle.side {
            ObstacleSide::Outside => gradient,
            ObstacleSide::Inside => -gradient,
        };
        let part = Vector3::from_fn(|k, _| if free[k] { outward[k] } else { 0.0 });
        let least = (PUSHES * outward.norm()).max(1e-12);
        part.try_normalize(least).unwrap_or_else(Vector3::zeros)
    }

    /// Moves `x` \[m\], where the gap is `opening` \[m\], along the normal to the surface; where that
    /// is zero, `x` stays. A gap that is not a distance, as between the samples of a label map, would leave it beside
    /// the surface by a length in proportion to its last move, and each change of the step or
    /// of the damping would strike all nodes in contact.
    pub(crate) fn onto_surface(&self, x: &Vector3, opening: f64, free: Components) -> Vector3 {
        let n = self.normal(x, free);
        let (mut last, mut moved) = ((0.0, opening), -opening);
        for _ in 0..MOST_SECANTS {
            let left = self.gap(&(x + n * moved));
            let slope = (left - last.1) / (moved - last.0);
            if left.abs() <= LEFT_OPEN * opening.abs() || slope.is_nan() || slope < 0.1 {
                break;
            }
            last = (moved, left);
            moved -= left / slope;
        }
        x + n * moved
    }

    /// The way \[m\] of its material at `x` \[m\] since it was elsewhere.
    pub(super) fn way_since(&self, before: &Placed, x: &Vector3) -> Vector3 {
        if self.place.is_none() {
            return Vector3::zeros();
        }
        x - before.now(&self.own(x))
    }

    /// A box of places \[m\] as the obstacle sees it: one around it.
    pub(super) fn own_box(&self, (lower, upper): (Vector3, Vector3)) -> (Vector3, Vector3) {
        if self.place.is_none() {
            return (lower, upper);
        }
        let own: Vec<Vector3> = corners(lower, upper).map(|corner| self.own(&corner)).collect();
        bounding_box(&own)
    }
}

impl ContactPlan {
    /// An obstacle where it is at time `t` \[s\].
    pub fn placed(&self, obstacle: u32, t: f64) -> Placed<'_> {
        let obstacle = &self.obstacles[obstacle as usize];
        Placed { obstacle, place: obstacle.place(t) }
    }

    /// An obstacle that has not moved.
    pub(super) fn at_rest(&self, obstacle: u32) -> Placed<'_> {
        Placed { obstacle: &self.obstacles[obstacle as usize], place: None }
    }

    /// Whether any obstacle moves.
    pub(crate) fn has_moving(&self) -> bool {
        self.obstacles.iter().any(|obstacle| !obstacle.motions.is_empty())
    }

    /// All of them in their order.
    pub fn all_placed(&self, t: f64) -> impl Iterator<Item = (u32, Placed<'_>)> {
        (0..self.obstacles.len() as u32).map(move |index| (index, self.placed(index, t)))
    }

    /// A box \[m\] around the places of another as an obstacle sees them until time `end` \[s\].
    pub(super) fn seen_from(
        &self,
        obstacle: u32,
        around: (Vector3, Vector3),
        end: f64,
    ) -> (Vector3, Vector3) {
        let seen = instants(end).map(|t| self.placed(obstacle, t).own_box(around));
        let both = |a: (Vector3, Vector3), b: (Vector3, Vector3)| (a.0.inf(&b.0), a.1.sup(&b.1));
        seen.reduce(both).unwrap_or(around)
    }

    /// Largest way \[m\] of any obstacle between two times \[s\] past a place in a box \[m\]: the
    /// change of the place as the obstacle sees it, which is affine, so that a corner has the largest.
    pub(crate) fn travel(&self, (from, to): (f64, f64), (lower, upper): (Vector3, Vector3)) -> f64 {
        let of = |index: u32| {
            let (before, after) = (self.placed(index, from), self.placed(index, to));
            let ways = corners(lower, upper).map(|x| (after.own(&x) - before.own(&x)).norm());
            ways.fold(0.0, f64::max)
        };
        let moving = (0..).zip(&self.obstacles).filter(|(_, o)| !o.motions.is_empty());
        moving.map(|(index, _)| of(index)).fold(0.0, f64::max)
    }
}

/// Instants at which what moves is followed until time `end` \[s\].
pub(super) fn instants(end: f64) -> impl Iterator<Item = f64> {
    (0..INSTANTS).map(move |instant| end * instant as f64 / (INSTANTS - 1) as f64)
}

fn corners(lower: Vector3, upper: Vector3) -> impl Iterator<Item = Vector3> {
    indices([2; 3])
        .map(move |ijk| Vector3::from_fn(|k, _| if ijk[k] == 0 { lower[k] } else { upper[k] }))
}
