//! Where boundary nodes go.
#![allow(non_snake_case)]

use super::features::{Features, of_section, of_solid};
use super::{GeometryError, PointHash, Shape, positive};
use crate::algebra::tensor::Vector3;
use crate::geometry::dimension::Dimension;

/// Wanted distance of neighbouring points \[m\] and its bounds.
pub(crate) struct Sizes<'a> {
    pub at: &'a (dyn Fn(&Vector3) -> f64 + Sync),
    pub smallest: f64,
    pub largest: f64,
}

impl Sizes<'_> {
    pub(super) fn uniform(&self) -> bool {
        self.smallest == self.largest
    }
}

/// Points on the boundary \[m\]; the first `fixed` lie on corners and edges.
pub(crate) struct BoundaryPoints {
    pub points: Vec<Vector3>,
    pub fixed: usize,
}

/// Closest that points of different origin may be \[spacing\].
const CLOSEST: f64 = 0.6;
/// Farther than this from every point, the boundary gets another \[spacing\].
const FILL: f64 = 0.8;
const MOST_POINTS: f64 = 2e7;

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
        let sizes = Sizes { at: &|_| spacing, smallest: spacing, largest: spacing };
        Ok(boundary_points_sized(self, &sizes, dimension)?.points)
    }
}

/// As [`Shape::boundary_points`], with a spacing that may vary.
pub(crate) fn boundary_points_sized(
    shape: &Shape,
    sizes: &Sizes,
    dimension: &Dimension,
) -> Result<BoundaryPoints, GeometryError> {
    let section = shape.section(dimension)?;
    refuse_too_many(&section, sizes, dimension)?;
    let mut features = Features::default();
    collect(&section, &section, sizes, dimension, &mut features)?;
    let mut chosen = Chosen {
        shape: &section,
        sizes,
        hash: PointHash::new(FILL * sizes.smallest, FILL * sizes.largest),
        points: Vec::new(),
    };
    chosen.take(&features.corners, 0.3);
    chosen.take(&features.edges, CLOSEST);
    let fixed = chosen.points.len();
    chosen.take(&features.faces, CLOSEST);
    let panels = section.boundary_panels(0.3 * sizes.smallest, dimension)?;
    let centres: Vec<Vector3> = panels.iter().map(|panel| panel.centre).collect();
    chosen.take(&centres, FILL);
    Ok(BoundaryPoints { points: chosen.points, fixed })
}

/// A rough count before anything is allocated.
fn refuse_too_many(
    shape: &Shape,
    sizes: &Sizes,
    dimension: &Dimension,
) -> Result<(), GeometryError> {
    let (lower, upper) = shape.finite_bounds(dimension)?;
    let n = (upper - lower) / sizes.smallest;
    let count = match dimension {
        Dimension::Three => 2.0 * (n.x * n.y + n.y * n.z + n.z * n.x),
        Dimension::PlaneStrain { .. } => 2.0 * (n.x + n.y),
    };
    let limit = MOST_POINTS;
    let what = "boundary nodes";
    if count <= limit { Ok(()) } else { Err(GeometryError::TooMany { what, count, limit }) }
}

struct Chosen<'a> {
    shape: &'a Shape,
    sizes: &'a Sizes<'a>,
    hash: PointHash,
    points: Vec<Vector3>,
}

impl Chosen<'_> {
    /// Takes the candidates that are at least `apart` times the local spacing
    /// away from all taken before, moved onto the boundary.
    fn take(&mut self, candidates: &[Vector3], apart: f64) {
        for candidate in candidates {
            let size = (self.sizes.at)(candidate);
            // First without the projection, which costs more.
            if self.hash.any_within(candidate, 0.7 * apart * size) {
                continue;
            }
            let X = project(self.shape, candidate);
            if !self.hash.any_within(&X, apart * (self.sizes.at)(&X)) {
                self.hash.insert(X);
                self.points.push(X);
            }
        }
    }
}

/// The point moved along the gradient onto the boundary; where it is on it
/// already, to rounding, the same point.
pub(crate) fn project(shape: &Shape, X: &Vector3) -> Vector3 {
    let tolerance = 1e-10 * shape.size();
    let mut at = *X;
    for _ in 0..8 {
        let distance = shape.signed_distance(&at);
        if distance.abs() <= tolerance {
            break;
        }
        at -= distance * shape.gradient(&at);
    }
    at
}

/// Features of the shape, or of the members of a composite as far as they
/// lie on its boundary.
fn collect(
    shape: &Shape,
    whole: &Shape,
    sizes: &Sizes,
    dimension: &Dimension,
    features: &mut Features,
) -> Result<(), GeometryError> {
    match shape {
        Shape::Union(members) => {
            return members.iter().try_for_each(|m| collect(m, whole, sizes, dimension, features));
        }
        Shape::Difference(body, hole) => {
            collect(body, whole, sizes, dimension, features)?;
            return collect(hole, whole, sizes, dimension, features);
        }
        _ => {}
    }
    let mut own = match dimension {
        Dimension::Three => of_solid(shape, sizes),
        Dimension::PlaneStrain { z, .. } => of_section(shape, *z, sizes)?,
    };
    for points in [&mut own.corners, &mut own.edges, &mut own.faces] {
        // Outlines are chords and may be a little off their own curve.
        points.iter_mut().for_each(|X| *X = project(shape, X));
        points.retain(|X| whole.signed_distance(X).abs() < 1e-6 * sizes.smallest);
    }
    features.corners.append(&mut own.corners);
    features.edges.append(&mut own.edges);
    features.faces.append(&mut own.faces);
    Ok(())
}
