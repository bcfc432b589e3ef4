//! Cross-sections for plane problems: solids without ends in z.

use crate::algebra::tensor::Vector3;
use crate::geometry::dimension::Dimension;
use crate::geometry::error::GeometryError;
use crate::geometry::polygon::polygon_area;
use crate::geometry::shape::Shape;
use crate::geometry::surface::Surface;
use std::sync::Arc;

const WITHOUT_END: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

impl Shape {
    /// The solid itself in three dimensions; in a plane the cross-section at
    /// height z, extended along z without end, so that its signed distance is
    /// that of the outline. The section of a section is the section.
    pub fn section(&self, dimension: &Dimension) -> Result<Shape, GeometryError> {
        match dimension {
            Dimension::Three => Ok(self.clone()),
            Dimension::PlaneStrain { z, .. } => self.section_at(*z),
        }
    }

    pub(super) fn section_at(&self, z: f64) -> Result<Shape, GeometryError> {
        let shape = self.name();
        let empty = GeometryError::SectionEmpty { shape, z };
        let unsupported = GeometryError::SectionUnsupported { shape, z };
        let between = |lower: f64, upper: f64| lower <= z && z <= upper;
        match self {
            Shape::Box { min, max } if between(min.z, max.z) => Ok(Shape::Polygon {
                points: vec![[min.x, min.y], [max.x, min.y], [max.x, max.y], [min.x, max.y]].into(),
                z: WITHOUT_END,
            }),
            Shape::Cylinder { axis, .. } if axis.z.abs() < 1.0 - 1e-12 => Err(unsupported),
            Shape::Cylinder { base, axis, radius, height } => {
                let top = base.z + height * axis.z;
                let crossed = between(base.z.min(top), base.z.max(top));
                if crossed { Ok(ellipse(base, *radius, *radius)) } else { Err(empty) }
            }
            Shape::Sphere { centre, radius } if (z - centre.z).abs() < *radius => {
                let reach = (radius * radius - (z - centre.z).powi(2)).sqrt();
                Ok(ellipse(centre, reach, reach))
            }
            Shape::Ellipsoid { centre, radii } if radii.z.is_infinite() => {
                Ok(ellipse(centre, radii.x, radii.y))
            }
            Shape::Ellipsoid { centre, radii } if (z - centre.z).abs() < radii.z => {
                let scale = (1.0 - ((z - centre.z) / radii.z).powi(2)).sqrt();
                Ok(ellipse(centre, scale * radii.x, scale * radii.y))
            }
            Shape::Polygon { points, z: (from, to) } if between(*from, *to) => {
                Ok(Shape::Polygon { points: points.clone(), z: WITHOUT_END })
            }
            Shape::HalfSpace { point, normal } => half_plane(point, normal, z).ok_or(unsupported),
            Shape::Union(members) => union_section(members, z, empty),
            Shape::Intersection(members) => {
                let sections: Result<_, _> = members.iter().map(|m| m.section_at(z)).collect();
                Ok(Shape::Intersection(sections?))
            }
            Shape::Difference(body, hole) => {
                let body = body.section_at(z)?;
                match hole.section_at(z) {
                    Ok(hole) => Ok(Shape::Difference(Box::new(body), Box::new(hole))),
                    Err(GeometryError::SectionEmpty { .. }) => Ok(body),
                    Err(error) => Err(error),
                }
            }
            Shape::Labels(field) => Ok(Shape::Labels(Arc::new(field.slice(z)?))),
            Shape::Surface(surface) => surface_section(surface, z, empty),
            Shape::Function(function) if between(function.bounds().0.z, function.bounds().1.z) => {
                Ok(Shape::Function(function.without_ends()))
            }
            _ => Err(empty),
        }
    }

    /// Bounding box, flat at z in a plane; refused if it is not finite.
    pub(crate) fn finite_bounds(
        &self,
        dimension: &Dimension,
    ) -> Result<(Vector3, Vector3), GeometryError> {
        let unbounded = GeometryError::Unbounded { shape: self.name() };
        let (mut lower, mut upper) = self.bounding_box().ok_or(unbounded.clone())?;
        if let Dimension::PlaneStrain { z, .. } = dimension {
            (lower.z, upper.z) = (*z, *z);
        }
        let finite = lower.iter().chain(upper.iter()).all(|c| c.is_finite());
        if finite { Ok((lower, upper)) } else { Err(unbounded) }
    }
}

fn ellipse(centre: &Vector3, a: f64, b: f64) -> Shape {
    Shape::Ellipsoid {
        centre: Vector3::new(centre.x, centre.y, 0.0),
        radii: Vector3::new(a, b, f64::INFINITY),
    }
}

/// The section of a half-space, unless its plane is level.
fn half_plane(point: &Vector3, normal: &Vector3, z: f64) -> Option<Shape> {
    let level = Vector3::new(normal.x, normal.y, 0.0);
    let length = level.norm();
    let to_plane = (point.z - z) * normal.z / length;
    let unit = level / length;
    (length >= 1e-12).then(|| Shape::HalfSpace { point: point + to_plane * unit, normal: unit })
}

fn union_section(members: &[Shape], z: f64, empty: GeometryError) -> Result<Shape, GeometryError> {
    let mut sections = Vec::new();
    for member in members {
        match member.section_at(z) {
            Ok(section) => sections.push(section),
            Err(GeometryError::SectionEmpty { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    union(sections).ok_or(empty)
}

/// The loops in which the plane cuts the surface: the outer ones together, less
/// the holes.
fn surface_section(
    surface: &Surface,
    z: f64,
    empty: GeometryError,
) -> Result<Shape, GeometryError> {
    let (outer, holes): (Vec<_>, Vec<_>) =
        surface.loops(z).into_iter().partition(|points| polygon_area(points) > 0.0);
    let polygon = |points: Vec<_>| Shape::Polygon { points: points.into(), z: WITHOUT_END };
    let join = |loops: Vec<Vec<[f64; 2]>>| union(loops.into_iter().map(polygon).collect());
    let body = join(outer).ok_or(empty)?;
    Ok(match join(holes) {
        None => body,
        Some(holes) => Shape::Difference(Box::new(body), Box::new(holes)),
    })
}

/// All members as one shape, if there are any.
fn union(mut members: Vec<Shape>) -> Option<Shape> {
    match members.len() {
        0 | 1 => members.pop(),
        _ => Some(Shape::Union(members)),
    }
}
