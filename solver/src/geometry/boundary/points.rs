//! Positions of boundary nodes.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::boundary::creases::creases;
use crate::geometry::boundary::features::{Features, of_section, of_solid};
use crate::geometry::boundary::panel::pieces_of_box;
use crate::geometry::boundary::target_spacing::TargetSpacing;
use crate::geometry::dimension::Dimension;
use crate::geometry::error::{GeometryError, positive};
use crate::geometry::point_hash::PointHash;
use crate::geometry::shape::Shape;
use crate::geometry::size_limit::BOUNDARY_NODES;
use rayon::prelude::*;

/// Points on the boundary \[m\]; the first `fixed` lie on corners and edges.
pub(crate) struct BoundaryPoints {
    pub points: Vec<Vector3>,
    pub fixed: usize,
}

/// Candidates that are looked at side by side.
const BATCH: usize = 512;
/// Points at just the distance asked for are not too close, whatever the round-off and the
/// tolerance of a projection \[–\].
const ROUND_OFF: f64 = 1e-6;
/// Closest that points of different origin may be \[spacing\].
const CLOSEST: f64 = 0.6;
/// Farther than this from every point, the boundary gets another \[spacing\].
const FILL: f64 = 0.8;

impl Shape {
    /// Points on the boundary about `spacing` \[m\] apart: corners, evenly
    /// divided edges, then faces. In a plane they lie on the outline of the
    /// cross-section.
    pub fn boundary_points(
        &self,
        spacing: f64,
        dimension: &Dimension,
    ) -> Result<Vec<Vector3>, GeometryError> {
        positive("the nodal spacing", spacing)?;
        let target = TargetSpacing { at: &|_| spacing, smallest: spacing, largest: spacing };
        Ok(boundary_points(self, &target, dimension)?.points)
    }
}

/// As [`Shape::boundary_points`], with a spacing that may vary.
pub(crate) fn boundary_points(
    shape: &Shape,
    target: &TargetSpacing,
    dimension: &Dimension,
) -> Result<BoundaryPoints, GeometryError> {
    let section = shape.section(dimension)?;
    refuse_too_many(&section, target, dimension)?;
    let mut features = Features::default();
    collect(&section, &section, target, dimension, &mut features)?;
    let mut chosen = Chosen {
        shape: &section,
        target,
        hash: PointHash::new(FILL * target.smallest, FILL * target.largest),
        points: Vec::new(),
        has_gaps: !section.is_convex(),
    };
    let panels = section.boundary_panels(0.3 * target.smallest, dimension)?;
    let centres: Vec<Vector3> = panels.iter().map(|panel| panel.centre).collect();
    let in_plane = matches!(dimension, Dimension::PlaneStrain { .. });
    let mut meeting = creases(&section, &centres, target, in_plane);
    features.corners.append(&mut meeting.corners);
    features.edges.append(&mut meeting.edges);
    chosen.add(&features.corners, 0.3);
    chosen.add(&features.edges, CLOSEST);
    let fixed = chosen.points.len();
    chosen.add(&features.faces, CLOSEST);
    chosen.add(&centres, FILL);
    Ok(BoundaryPoints { points: chosen.points, fixed })
}

/// A rough count before anything is allocated.
fn refuse_too_many(
    shape: &Shape,
    target: &TargetSpacing,
    dimension: &Dimension,
) -> Result<(), GeometryError> {
    let (lower, upper) = shape.finite_bounds(dimension)?;
    BOUNDARY_NODES.check(pieces_of_box(&(upper - lower), target.smallest, dimension))
}

struct Chosen<'a> {
    shape: &'a Shape,
    target: &'a TargetSpacing<'a>,
    hash: PointHash,
    points: Vec<Vector3>,
    has_gaps: bool,
}

impl Chosen<'_> {
    /// Moves candidates onto the boundary and keeps those at least `apart` times
    /// the local spacing away from all kept before.
    fn add(&mut self, candidates: &[Vector3], apart: f64) {
        for batch in candidates.chunks(BATCH) {
            // Side by side, then one after the other those that no point before the batch is
            // close to.
            let placed = |candidate| Some((candidate, self.placed(candidate, apart)?));
            let placed: Vec<(&Vector3, Vector3)> = batch.par_iter().filter_map(placed).collect();
            for (candidate, X) in placed {
                if !self.is_crowded(candidate, apart) && !self.has_near(&X, apart) {
                    self.hash.insert(X);
                    self.points.push(X);
                }
            }
        }
    }

    /// The candidate moved onto the boundary, unless a point is near.
    fn placed(&self, candidate: &Vector3, apart: f64) -> Option<Vector3> {
        // First without the projection, which costs more.
        if self.is_crowded(candidate, apart) {
            return None;
        }
        let X = project(self.shape, candidate);
        (!self.has_near(&X, apart)).then_some(X)
    }

    /// Whether a point is so near that none is possible about here.
    fn is_crowded(&self, candidate: &Vector3, apart: f64) -> bool {
        // First without the local spacing, which costs more.
        let near = |size: f64| self.has_within(candidate, 0.7 * apart * size);
        near(self.target.smallest) || near((self.target.at)(candidate))
    }

    fn has_near(&self, X: &Vector3, apart: f64) -> bool {
        self.has_within(X, apart * (self.target.at)(X))
    }

    /// Whether a point on this side of a gap is closer than `radius` \[m\].
    fn has_within(&self, X: &Vector3, radius: f64) -> bool {
        let mut found = false;
        self.hash.visit(X, radius * (1.0 - ROUND_OFF), |index, distance| {
            // Between a point and itself round-off would make a gap.
            let is_same = distance <= ROUND_OFF * radius;
            let no_gap = || !self.shape.has_gap_between(X, &self.points[index]);
            found = !self.has_gaps || is_same || no_gap();
            !found
        });
        found
    }
}

/// The point moved along the gradient onto the boundary; where it is on it
/// already, to rounding, the same point.
pub(crate) fn project(shape: &Shape, X: &Vector3) -> Vector3 {
    let tolerance = 1e-10 * shape.size();
    let (mut at, mut distance) = (*X, shape.signed_distance(X));
    for _ in 0..8 {
        if distance.abs() <= tolerance {
            break;
        }
        // Along one direction by secants: between the samples of a label map the distance
        // grows faster or slower than the way.
        let direction = shape.gradient(&at);
        let mut way = distance;
        for _ in 0..6 {
            at -= way * direction;
            let left = shape.signed_distance(&at);
            let slope = (distance - left) / way;
            distance = left;
            if left.abs() <= tolerance || !(0.3..3.0).contains(&slope) {
                break;
            }
            way = left / slope;
        }
    }
    at
}

/// Features of the shape, or of the members of a composite as far as they
/// lie on its boundary.
fn collect(
    shape: &Shape,
    whole: &Shape,
    target: &TargetSpacing,
    dimension: &Dimension,
    features: &mut Features,
) -> Result<(), GeometryError> {
    match shape {
        Shape::Union(members) | Shape::Intersection(members) => {
            return members.iter().try_for_each(|m| collect(m, whole, target, dimension, features));
        }
        Shape::Difference(body, hole) => {
            collect(body, whole, target, dimension, features)?;
            return collect(hole, whole, target, dimension, features);
        }
        _ => {}
    }
    let mut own = match dimension {
        Dimension::Three => of_solid(shape, target),
        Dimension::PlaneStrain { z, .. } => of_section(shape, *z, target)?,
    };
    for points in [&mut own.corners, &mut own.edges, &mut own.faces] {
        // Outlines are chords and may be a little off their own curve.
        points.iter_mut().for_each(|X| *X = project(shape, X));
        points.retain(|X| whole.signed_distance(X).abs() < 1e-6 * target.smallest);
    }
    features.corners.append(&mut own.corners);
    features.edges.append(&mut own.edges);
    features.faces.append(&mut own.faces);
    Ok(())
}
