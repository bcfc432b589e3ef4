//! Curves along which the members of a composite meet, and corners where these end
//! (method book, section 5).
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::boundary::features::{Features, divide};
use crate::geometry::boundary::target_spacing::TargetSpacing;
use crate::geometry::point_hash::PointHash;
use crate::geometry::primitives::perpendicular;
use crate::geometry::shape::Shape;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Curves are looked for this far from the places given; not round, since the first place decides
/// where a curve starts, and round-off must not decide which is the first \[spacing\].
const REACH: f64 = 0.807_3;
/// Longest step along a curve \[spacing\].
const STEP: f64 = 0.2;
/// Where no step as short as this succeeds, a curve ends \[spacing\].
const SHORTEST: f64 = 1e-8;
/// Distance from the members, and from the boundary, of a point of a curve \[spacing\].
const ON_MEMBERS: f64 = 1e-10;
const ON_BOUNDARY: f64 = 1e-8;
/// Faces that enclose less than some 20° do not make an edge: the cosine.
const SMOOTH: f64 = 0.94;
/// A step that turns a curve by more than 30° is too long, or passes a corner: the cosine; below
/// this length \[spacing\] one that turns it more than in proportion is.
const STRAIGHT: f64 = 0.866;
const SHORT: f64 = 0.01;
/// Radius of the circle on which the angle of an edge is sampled \[spacing\], and its samples.
const AROUND: f64 = 0.05;
const SAMPLES: usize = 48;
/// Difference of the inside fraction of that circle from one half at an edge of some 20° \[–\].
const BENT: f64 = 0.05;
/// Steps along one curve; no body has longer ones.
const MOST_STEPS: usize = 1_000_000;

/// Candidates along the curves where two members of a composite meet at an angle and at the
/// corners of these, found from `places` on the boundary; in a plane the places where outlines
/// meet are corners. A shape that is no composite has none.
pub(super) fn creases(
    whole: &Shape,
    places: &[Vector3],
    target: &TargetSpacing,
    in_plane: bool,
) -> Features {
    let mut members = Vec::new();
    leaves(whole, &mut members);
    let mut features = Features::default();
    for (n, second) in members.iter().enumerate() {
        for first in &members[..n] {
            let pair = Pair { whole, members: [first, second], target };
            let found = places.par_iter().filter_map(|place| pair.near_place(place, in_plane));
            let found: Vec<Vector3> = found.collect();
            if in_plane {
                features.corners.extend(found);
            } else {
                pair.trace_all(&found, &mut features);
            }
        }
    }
    features
}

/// The members of a composite that are no composites themselves.
fn leaves<'a>(shape: &'a Shape, found: &mut Vec<&'a Shape>) {
    match shape {
        Shape::Union(members) | Shape::Intersection(members) => {
            members.iter().for_each(|member| leaves(member, found));
        }
        Shape::Difference(body, hole) => {
            leaves(body, found);
            leaves(hole, found);
        }
        _ => found.push(shape),
    }
}

/// Two members of a composite, which may meet on its boundary.
struct Pair<'a> {
    whole: &'a Shape,
    members: [&'a Shape; 2],
    target: &'a TargetSpacing<'a>,
}

impl Pair<'_> {
    /// The point of an edge that is close to a place on the boundary.
    fn near_place(&self, place: &Vector3, in_plane: bool) -> Option<Vector3> {
        let size = (self.target.at)(place);
        let near = |member: &&Shape| member.signed_distance(place).abs() < REACH * size;
        if !self.members.iter().all(near) {
            return None;
        }
        let X = self.meet(place, 1.5 * REACH * size, size)?;
        let around = if in_plane { Vector3::z() } else { self.tangent(&X)? };
        self.is_bent(&X, &around, size).then_some(X)
    }

    /// The point of both members, and of the boundary, that Newton's method of least length
    /// reaches from `X` within `reach` \[m\].
    fn meet(&self, X: &Vector3, reach: f64, size: f64) -> Option<Vector3> {
        let mut at = *X;
        for _ in 0..40 {
            let [d, e] = self.members.map(|member| member.signed_distance(&at));
            if d.abs().max(e.abs()) <= ON_MEMBERS * size {
                let off = self.whole.signed_distance(&at).abs();
                return (off <= ON_BOUNDARY * size).then_some(at);
            }
            let [g, h] = self.members.map(|member| member.gradient(&at));
            let cosine = g.dot(&h);
            if cosine.abs() > SMOOTH {
                return None;
            }
            let gram = 1.0 - cosine * cosine;
            at -= ((d - cosine * e) * g + (e - cosine * d) * h) / gram;
            if (at - X).norm() > reach {
                return None;
            }
        }
        None
    }

    /// The direction of the curve, unless the faces are tangent.
    fn tangent(&self, X: &Vector3) -> Option<Vector3> {
        let [g, h] = self.members.map(|member| member.gradient(X));
        if g.dot(&h).abs() > SMOOTH { None } else { g.cross(&h).try_normalize(0.0) }
    }

    /// Whether the boundary bends at a point: where a face of one member goes on in a face of
    /// another, half of a small circle about the curve lies inside.
    fn is_bent(&self, X: &Vector3, around: &Vector3, size: f64) -> bool {
        let (u, v) = perpendicular(around);
        let inside = (0..SAMPLES).filter(|&n| {
            let (sin, cos) = ((n as f64 + 0.5) * TAU / SAMPLES as f64).sin_cos();
            self.whole.signed_distance(&(X + AROUND * size * (cos * u + sin * v))) < 0.0
        });
        (inside.count() as f64 / SAMPLES as f64 - 0.5).abs() > BENT
    }

    /// Follows the curves through the points `found`, each once.
    fn trace_all(&self, found: &[Vector3], features: &mut Features) {
        let mut known = PointHash::new(STEP * self.target.smallest, STEP * self.target.largest);
        for X in found {
            if known.any_within(X, STEP * (self.target.at)(X)) {
                continue;
            }
            let Some(tangent) = self.tangent(X) else { continue };
            let (mut curve, closed) = self.trace(X, &tangent);
            if !closed {
                let (mut back, _) = self.trace(X, &-tangent);
                back.reverse();
                back.extend(curve.drain(1..));
                curve = back;
                features.corners.extend([curve[0], curve[curve.len() - 1]]);
            }
            curve.iter().for_each(|X| known.insert(*X));
            if curve.len() > 1 {
                // From the chords onto the curve.
                let onto = |X: Vector3| {
                    let size = (self.target.at)(&X);
                    self.meet(&X, STEP * size, size)
                };
                let divided = divide(&curve, self.target, closed);
                features.edges.extend(divided.into_iter().filter_map(onto));
            }
        }
    }

    /// The curve from a point along a direction to where it ends or closes, with which it is.
    fn trace(&self, start: &Vector3, along: &Vector3) -> (Vec<Vector3>, bool) {
        let (mut curve, mut along, mut length) = (vec![*start], *along, 0.0);
        let mut step = STEP;
        while step > SHORTEST && curve.len() < MOST_STEPS {
            let at = curve[curve.len() - 1];
            let size = (self.target.at)(&at);
            let Some((next, tangent)) = self.advance(&at, &along, step * size, size) else {
                step *= 0.5;
                continue;
            };
            let way = (next - at).norm();
            let passed = (start - at).dot(&along);
            let beside = (start - at - passed * along).norm();
            if length > 2.0 * way && (0.0..=way).contains(&passed) && beside < 0.5 * way {
                return (curve, true);
            }
            length += way;
            curve.push(next);
            (along, step) = (tangent, (2.0 * step).min(STEP));
        }
        let last = curve.len() - 1;
        curve[last] = self.end_beyond(&curve[last], &along);
        (curve, false)
    }

    /// Where a curve ends that could be followed to a point: just before a corner directions that
    /// come from differences are those of two faces. As far as the straight way is on both members.
    fn end_beyond(&self, at: &Vector3, along: &Vector3) -> Vector3 {
        let size = (self.target.at)(at);
        let is_on = |X: &Vector3| {
            let off = |member: &&Shape| member.signed_distance(X).abs() <= ON_MEMBERS * size;
            self.members.iter().all(off)
                && self.whole.signed_distance(X).abs() <= ON_BOUNDARY * size
        };
        let (mut end, mut step) = (*at, SHORT);
        while step > SHORTEST {
            let next = end + step * size * along;
            if is_on(&next) {
                end = next;
            }
            step *= 0.5;
        }
        end
    }

    /// The next point of the curve and its direction there, unless the step is too long or
    /// passes its end.
    fn advance(
        &self,
        at: &Vector3,
        along: &Vector3,
        step: f64,
        size: f64,
    ) -> Option<(Vector3, Vector3)> {
        let next = self.meet(&(at + step * along), 0.5 * step, size)?;
        let tangent = self.tangent(&next)?;
        let turned = tangent.dot(along);
        let tangent = if turned < 0.0 { -tangent } else { tangent };
        let is_onward = (next - at).dot(along) > 0.5 * step;
        let part = (step / (SHORT * size)).min(1.0);
        let is_smooth = 1.0 - turned.abs() < (1.0 - STRAIGHT) * part * part;
        (is_smooth && is_onward).then_some((next, tangent))
    }
}
