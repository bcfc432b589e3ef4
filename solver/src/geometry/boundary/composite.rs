//! Panels of unions, intersections and differences from those of their members.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::boundary::patch::{Level, Patch};
use crate::geometry::error::GeometryError;
use crate::geometry::shape::Shape;
use rayon::prelude::*;

type PatchesOf<'a> = &'a dyn Fn(&Shape) -> Result<Vec<Patch>, GeometryError>;

/// Which panels of one member remain, depending on where they lie on another.
#[derive(Clone, Copy, PartialEq)]
enum Keep {
    /// Outside the other; on a face of it, if the normals agree.
    OutsideOrAlong,
    /// Outside the other; on a face of it, if the normals are opposite.
    OutsideOrAgainst,
    Outside,
    /// Inside the other; on a face of it, if the normals agree.
    InsideOrAlong,
    Inside,
}

/// Slope of a distance along the normal of a face that is a face of the other too; it is 1, and
/// a half on its edge \[–\].
const SAME_FACE: f64 = 0.25;
/// Less than this fraction of a panel beside the edge of another member is round-off \[–\].
const NOTHING: f64 = 1e-5;
/// Halvings of a panel that another member cuts.
const DEEPEST: usize = 6;

impl Keep {
    /// At most 0 where a place on one member, with its normal there, remains in view of the
    /// other \[m\].
    fn level(
        self,
        X: &Vector3,
        normal: &dyn Fn() -> Vector3,
        other: &Shape,
        tolerance: f64,
    ) -> f64 {
        let distance = other.signed_distance(X);
        if distance.abs() <= tolerance {
            let normal = normal();
            let beside = |way: f64| other.signed_distance(&(X + way * normal));
            let step = 10.0 * tolerance;
            let along = (beside(step) - beside(-step)) / (2.0 * step);
            if along.abs() > SAME_FACE {
                let remains = match self {
                    Keep::OutsideOrAlong | Keep::InsideOrAlong => along > 0.0,
                    Keep::OutsideOrAgainst => along < 0.0,
                    Keep::Outside | Keep::Inside => false,
                };
                return if remains { -tolerance } else { tolerance };
            }
        }
        match self {
            Keep::Inside | Keep::InsideOrAlong => distance,
            _ => -distance,
        }
    }
}

/// Panels of the members that lie on the boundary of the composite and end where members
/// meet. Of coinciding faces at most one remains.
pub(super) fn composite_patches(shape: &Shape, of: PatchesOf) -> Result<Vec<Patch>, GeometryError> {
    let tolerance = 1e-9 * shape.size();
    let mut kept = Vec::new();
    let cut = |patches: Vec<Patch>, others: &[(&Shape, Keep)]| -> Vec<Patch> {
        let steepness = others.iter().map(|(other, _)| other.steepness()).fold(1.0, f64::max);
        let at = |X: &Vector3, normal: &dyn Fn() -> Vector3| {
            let levels = others.iter().map(|(other, keep)| keep.level(X, normal, other, tolerance));
            levels.fold(f64::NEG_INFINITY, f64::max)
        };
        let level = Level { at: &at, steepness };
        let remaining = |patch: &Patch| patch.cut(&level, DEEPEST, NOTHING);
        let kept: Vec<_> = patches.par_iter().map(remaining).collect();
        // All of a solid has its own rule, which closes.
        if kept.iter().all(|kept| kept.as_ref().is_some_and(|(_, fraction)| *fraction == 1.0)) {
            return patches;
        }
        kept.into_iter().flatten().map(|(kept, _)| kept.exact()).collect()
    };
    match shape {
        Shape::Union(members) | Shape::Intersection(members) => {
            let [first, later] = match shape {
                Shape::Union(_) => [Keep::OutsideOrAlong, Keep::Outside],
                _ => [Keep::InsideOrAlong, Keep::Inside],
            };
            for (n, member) in members.iter().enumerate() {
                let rule = |other| if n < other { first } else { later };
                let others = members.iter().enumerate().filter(|(other, _)| *other != n);
                let others: Vec<_> = others.map(|(other, shape)| (shape, rule(other))).collect();
                kept.extend(cut(of(member)?, &others));
            }
        }
        Shape::Difference(body, hole) => {
            kept = cut(of(body)?, &[(&**hole, Keep::OutsideOrAgainst)]);
            let walls = cut(of(hole)?, &[(&**body, Keep::Inside)]);
            kept.extend(walls.into_iter().map(Patch::flipped));
        }
        _ => {}
    }
    Ok(kept)
}
