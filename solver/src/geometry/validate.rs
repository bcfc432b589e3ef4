//! What makes a shape admissible.

use crate::algebra::tensor::Vector3;
use crate::geometry::error::{GeometryError, positive};
use crate::geometry::polygon::Outline;
use crate::geometry::shape::Shape;
use std::cmp::Ordering;

impl Shape {
    /// Refuses shapes whose numbers describe no solid. A half-space passes;
    /// as a body it is refused where a bounded one is needed.
    pub fn validate(&self) -> Result<(), GeometryError> {
        match self {
            Shape::Box { min, max } => {
                let length = max - min;
                match (0..3).find(|&axis| length[axis] == f64::INFINITY) {
                    Some(axis) => Err(empty(axis, min, max)),
                    None => open_box(min, max),
                }
            }
            Shape::Cylinder { base, axis, radius, height } => {
                finite("the cylinder base", base)?;
                unit("the cylinder axis", axis)?;
                positive("the cylinder radius", *radius)?;
                positive("the cylinder height", *height)
            }
            Shape::Sphere { centre, radius } => {
                finite("the sphere centre", centre)?;
                positive("the sphere radius", *radius)
            }
            Shape::Ellipsoid { centre, radii } => {
                finite("the ellipsoid centre", centre)?;
                positive("the ellipsoid radius in x", radii.x)?;
                positive("the ellipsoid radius in y", radii.y)?;
                let cylinder = radii.z == f64::INFINITY;
                if cylinder { Ok(()) } else { positive("the ellipsoid radius in z", radii.z) }
            }
            Shape::Polygon { points, z: (from, to) } => {
                if from >= to || from.is_nan() || to.is_nan() {
                    return Err(GeometryError::EmptyExtrusion { from: *from, to: *to });
                }
                polygon(points)
            }
            Shape::HalfSpace { point, normal } => {
                finite("the half-space point", point)?;
                unit("the half-space normal", normal)
            }
            Shape::Union(members) | Shape::Intersection(members) if members.is_empty() => {
                Err(GeometryError::NoMembers { shape: self.name() })
            }
            Shape::Union(members) => members.iter().try_for_each(Shape::validate),
            Shape::Intersection(members) => {
                members.iter().try_for_each(Shape::validate)?;
                self.bounding_box()
                    .map_or(Ok(()), |(lower, upper)| open_box(&lower, &upper))
                    .map_err(|_| GeometryError::NothingInCommon)
            }
            Shape::Difference(body, hole) => {
                body.validate()?;
                hole.validate()
            }
            Shape::Function(function) => {
                let (lower, upper) = function.bounds();
                finite("the lower corner of the distance function", &lower)?;
                finite("the upper corner of the distance function", &upper)?;
                open_box(&lower, &upper)
            }
            // Checked when they were made.
            Shape::Labels(_) | Shape::Surface(_) => Ok(()),
        }
    }

    /// As [`validate`](Shape::validate), and the solid must have an end.
    pub fn validate_body(&self) -> Result<(), GeometryError> {
        self.validate()?;
        match self.bounding_box() {
            Some((lower, upper)) if (upper - lower).xy().iter().all(|l| l.is_finite()) => Ok(()),
            _ => Err(GeometryError::Unbounded { shape: self.name() }),
        }
    }
}

/// Refuses a box without volume.
fn open_box(lower: &Vector3, upper: &Vector3) -> Result<(), GeometryError> {
    match (0..3).find(|&axis| lower[axis].partial_cmp(&upper[axis]) != Some(Ordering::Less)) {
        Some(axis) => Err(empty(axis, lower, upper)),
        None => Ok(()),
    }
}

fn empty(axis: usize, min: &Vector3, max: &Vector3) -> GeometryError {
    GeometryError::EmptyBox { axis, min: min[axis], max: max[axis] }
}

fn finite(name: &'static str, vector: &Vector3) -> Result<(), GeometryError> {
    if vector.iter().all(|c| c.is_finite()) {
        Ok(())
    } else {
        Err(GeometryError::NotFinite { name })
    }
}

fn unit(name: &'static str, vector: &Vector3) -> Result<(), GeometryError> {
    let length = vector.norm();
    if (length - 1.0).abs() < 1e-9 { Ok(()) } else { Err(GeometryError::NotUnit { name, length }) }
}

fn polygon(points: &Outline) -> Result<(), GeometryError> {
    let n = points.len();
    if n < 3 {
        return Err(GeometryError::TooFewPoints { count: n });
    }
    if !points.iter().flatten().all(|c| c.is_finite()) {
        return Err(GeometryError::NotFinite { name: "the polygon" });
    }
    match points.crossing() {
        Some((first, second)) => Err(GeometryError::PolygonCrosses { first, second }),
        None => Ok(()),
    }
}
