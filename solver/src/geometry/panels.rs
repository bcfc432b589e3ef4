//! The boundary as small panels, for surface integrals.
#![allow(non_snake_case)]

use super::primitives::anticlockwise;
use super::triangles::{Triangle, area_vector, subdivide, triangulate};
use super::{GeometryError, Shape, marching, positive};
use crate::algebra::tensor::Vector3;
use crate::geometry::dimension::Dimension;
use std::f64::consts::TAU;

/// A piece of the boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Panel {
    pub centre: Vector3,
    /// \[m²\]; in plane strain length times thickness.
    pub area: f64,
    /// Unit vector out of the solid.
    pub normal: Vector3,
}

const MOST_PANELS: f64 = 1e8;

impl Shape {
    /// Panels with edges of at most `size` \[m\] that cover the boundary, in
    /// a plane that of the cross-section without its ends. Areas and normals
    /// are exact for flat faces, cylinders and spheres. Where members of a
    /// union or difference meet, the areas of the panels there are cut in
    /// proportion and their centres stay.
    pub fn boundary_panels(
        &self,
        size: f64,
        dimension: &Dimension,
    ) -> Result<Vec<Panel>, GeometryError> {
        positive("the panel size", size)?;
        match dimension {
            Dimension::Three => surface_panels(self, size, self.finite_bounds(dimension)?),
            Dimension::PlaneStrain { thickness, z } => {
                let section = self.section_at(*z)?;
                let around = section.finite_bounds(dimension)?;
                let mut panels = curve_panels(&section, size, *z, around)?;
                panels.iter_mut().for_each(|panel| panel.area *= thickness);
                Ok(panels)
            }
        }
    }
}

/// Corners of the box outside which half-spaces need no panels \[m\].
type Bounds = (Vector3, Vector3);

/// The part of a plane that passes the box: its middle and half its edge.
fn patch(point: &Vector3, normal: &Vector3, (lower, upper): Bounds) -> (Vector3, f64) {
    let middle = 0.5 * (lower + upper);
    (middle - (middle - point).dot(normal) * normal, 0.5 * (upper - lower).norm())
}

/// Panels whose area is a length, of a section.
fn curve_panels(
    shape: &Shape,
    size: f64,
    z: f64,
    around: Bounds,
) -> Result<Vec<Panel>, GeometryError> {
    match shape {
        Shape::Polygon { points, .. } => Ok(line_panels(&anticlockwise(points), size, z)),
        Shape::Ellipsoid { centre, radii } => Ok(ellipse_panels(centre, radii, size, z)),
        Shape::HalfSpace { point, normal } => {
            let (middle, reach) = patch(point, normal, around);
            let along = reach * Vector3::new(-normal.y, normal.x, 0.0);
            let (a, b) = (middle - along, middle + along);
            Ok(segment_panels([a.x, a.y], [b.x, b.y], size, z).collect())
        }
        Shape::Labels(field) => {
            let curves = marching::contours(shape, z, (0.7 * size).min(field.voxel()))?;
            Ok(curves.iter().flat_map(|curve| line_panels(curve, size, z)).collect())
        }
        Shape::Union(_) | Shape::Difference(..) => {
            composite_panels(shape, |panel| panel.area, &|member| {
                curve_panels(member, size, z, around)
            })
        }
        _ => Err(GeometryError::Unbounded { shape: shape.name() }),
    }
}

/// Number of pieces of at most `size` in `length`.
fn pieces(length: f64, size: f64) -> usize {
    ((length / size) * (1.0 - 1e-9)).ceil().max(1.0) as usize
}

/// Along a closed polyline with the solid to its left.
fn line_panels(points: &[[f64; 2]], size: f64, z: f64) -> Vec<Panel> {
    (0..points.len())
        .flat_map(|n| segment_panels(points[n], points[(n + 1) % points.len()], size, z))
        .collect()
}

fn segment_panels(a: [f64; 2], b: [f64; 2], size: f64, z: f64) -> impl Iterator<Item = Panel> {
    let edge = Vector3::new(b[0] - a[0], b[1] - a[1], 0.0);
    let length = edge.norm();
    let normal = Vector3::new(edge.y, -edge.x, 0.0) / length;
    let count = if length > 0.0 { pieces(length, size) } else { 0 };
    (0..count).map(move |piece| {
        let t = (piece as f64 + 0.5) / count as f64;
        let centre = Vector3::new(a[0], a[1], z) + t * edge;
        Panel { centre, area: length / count as f64, normal }
    })
}

fn ellipse_panels(centre: &Vector3, radii: &Vector3, size: f64, z: f64) -> Vec<Panel> {
    let count = pieces(TAU * radii.x.max(radii.y), size).max(8);
    let step = TAU / count as f64;
    (0..count)
        .map(|n| {
            let (sin, cos) = ((n as f64 + 0.5) * step).sin_cos();
            let weighted = Vector3::new(radii.y * cos, radii.x * sin, 0.0);
            Panel {
                centre: Vector3::new(centre.x + radii.x * cos, centre.y + radii.y * sin, z),
                area: weighted.norm() * step,
                normal: weighted.normalize(),
            }
        })
        .collect()
}

fn surface_panels(shape: &Shape, size: f64, around: Bounds) -> Result<Vec<Panel>, GeometryError> {
    match shape {
        Shape::Box { min, max } => Ok(box_panels(min, max, size)),
        Shape::Cylinder { base, axis, radius, height } => {
            Ok(cylinder_panels(base, axis, *radius, *height, size))
        }
        Shape::Sphere { centre, radius } => {
            Ok(ellipsoid_panels(centre, &Vector3::repeat(*radius), size))
        }
        Shape::Ellipsoid { centre, radii } if radii.z.is_finite() => {
            Ok(ellipsoid_panels(centre, radii, size))
        }
        Shape::Polygon { points, z } if (z.1 - z.0).is_finite() => {
            Ok(prism_panels(points, *z, size))
        }
        Shape::HalfSpace { point, normal } => {
            let (middle, reach) = patch(point, normal, around);
            let (u, v) = perpendicular(normal);
            let mut panels = Vec::new();
            let corner = middle - reach * (u + v);
            rectangle(corner, 2.0 * reach * u, 2.0 * reach * v, size, &mut panels);
            Ok(panels)
        }
        Shape::Labels(field) => {
            let triangles = marching::isosurface(shape, (size / 3_f64.sqrt()).min(field.voxel()))?;
            Ok(triangle_panels(triangles.into_iter(), size))
        }
        Shape::Surface(surface) => Ok(triangle_panels(surface.corners(), size)),
        Shape::Union(_) | Shape::Difference(..) => {
            composite_panels(shape, |panel| panel.area.sqrt(), &|member| {
                surface_panels(member, size, around)
            })
        }
        _ => Err(GeometryError::Unbounded { shape: shape.name() }),
    }
    .and_then(|panels| {
        let (what, count) = ("boundary panels", panels.len() as f64);
        let limit = MOST_PANELS;
        if count > limit { Err(GeometryError::TooMany { what, count, limit }) } else { Ok(panels) }
    })
}

fn rectangle(corner: Vector3, u: Vector3, v: Vector3, size: f64, panels: &mut Vec<Panel>) {
    let (nu, nv) = (pieces(u.norm(), size), pieces(v.norm(), size));
    let whole = u.cross(&v);
    let area = whole.norm() / (nu * nv) as f64;
    let normal = whole.normalize();
    for j in 0..nv {
        for i in 0..nu {
            let (s, t) = ((i as f64 + 0.5) / nu as f64, (j as f64 + 0.5) / nv as f64);
            panels.push(Panel { centre: corner + s * u + t * v, area, normal });
        }
    }
}

fn box_panels(min: &Vector3, max: &Vector3, size: f64) -> Vec<Panel> {
    let mut panels = Vec::new();
    let edges = max - min;
    for axis in 0..3 {
        let along = |k: usize| {
            let mut edge = Vector3::zeros();
            edge[(axis + k) % 3] = edges[(axis + k) % 3];
            edge
        };
        rectangle(*min, along(2), along(1), size, &mut panels);
        rectangle(min + along(0), along(1), along(2), size, &mut panels);
    }
    panels
}

fn prism_panels(points: &[[f64; 2]], z: (f64, f64), size: f64) -> Vec<Panel> {
    let points = anticlockwise(points);
    let mut panels = Vec::new();
    let up = Vector3::new(0.0, 0.0, z.1 - z.0);
    for (n, a) in points.iter().enumerate() {
        let b = points[(n + 1) % points.len()];
        let edge = Vector3::new(b[0] - a[0], b[1] - a[1], 0.0);
        rectangle(Vector3::new(a[0], a[1], z.0), edge, up, size, &mut panels);
    }
    for [a, b, c] in triangulate(&points) {
        let at = |z: f64| move |p: [f64; 2]| Vector3::new(p[0], p[1], z);
        let caps = [[a, b, c].map(at(z.1)), [a, c, b].map(at(z.0))];
        panels.extend(triangle_panels(caps.into_iter(), size));
    }
    panels
}

pub(super) fn perpendicular(axis: &Vector3) -> (Vector3, Vector3) {
    let e = if axis.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
    let u = (e - e.dot(axis) * axis).normalize();
    (u, axis.cross(&u))
}

fn cylinder_panels(
    base: &Vector3,
    axis: &Vector3,
    radius: f64,
    height: f64,
    size: f64,
) -> Vec<Panel> {
    let (u, v) = perpendicular(axis);
    let around = |n: usize, count: usize| {
        let (sin, cos) = ((n as f64 + 0.5) * TAU / count as f64).sin_cos();
        cos * u + sin * v
    };
    let mut panels = Vec::new();
    let (count, layers) = (pieces(TAU * radius, size).max(8), pieces(height, size));
    for n in 0..layers * count {
        let normal = around(n % count, count);
        let s = height * ((n / count) as f64 + 0.5) / layers as f64;
        let area = TAU * radius * height / (count * layers) as f64;
        panels.push(Panel { centre: base + s * axis + radius * normal, area, normal });
    }
    let rings = pieces(radius, size);
    for ring in 0..rings {
        let width = radius / rings as f64;
        let (inner, outer) = (ring as f64 * width, (ring + 1) as f64 * width);
        let count = pieces(TAU * outer, size).max(6);
        let area = 0.5 * TAU * (outer * outer - inner * inner) / count as f64;
        for n in 0..count {
            let at = base + 0.5 * (inner + outer) * around(n, count);
            panels.push(Panel { centre: at, area, normal: -axis });
            panels.push(Panel { centre: at + height * axis, area, normal: *axis });
        }
    }
    panels
}

/// Bands of latitude on the unit sphere with exact areas, mapped by Nanson's
/// formula N dA = cof(D) n da with D the diagonal of the radii.
fn ellipsoid_panels(centre: &Vector3, radii: &Vector3, size: f64) -> Vec<Panel> {
    let largest = radii.max();
    let bands = pieces(0.5 * TAU * largest, size).max(4);
    let cofactor = Vector3::repeat(radii.product()).component_div(radii);
    let mut panels = Vec::new();
    for band in 0..bands {
        let polar = |n: f64| n * 0.5 * TAU / bands as f64;
        let (top, bottom) = (polar(band as f64), polar(band as f64 + 1.0));
        let (sin, cos) = polar(band as f64 + 0.5).sin_cos();
        let count = pieces(TAU * sin * largest, size).max(6);
        let area = (top.cos() - bottom.cos()) * TAU / count as f64;
        for n in 0..count {
            let (s, c) = ((n as f64 + 0.5) * TAU / count as f64).sin_cos();
            let unit = Vector3::new(sin * c, sin * s, cos);
            let mapped = cofactor.component_mul(&unit);
            panels.push(Panel {
                centre: centre + radii.component_mul(&unit),
                area: area * mapped.norm(),
                normal: mapped.normalize(),
            });
        }
    }
    panels
}

fn triangle_panels(triangles: impl Iterator<Item = Triangle>, size: f64) -> Vec<Panel> {
    let mut panels = Vec::new();
    for triangle in triangles {
        subdivide(triangle, size, &mut |t| {
            let whole = area_vector(&t);
            let area = whole.norm();
            if area > 0.0 {
                panels.push(Panel {
                    centre: (t[0] + t[1] + t[2]) / 3.0,
                    area,
                    normal: whole / area,
                });
            }
        });
    }
    panels
}

type PanelsOf<'a> = &'a dyn Fn(&Shape) -> Result<Vec<Panel>, GeometryError>;

/// Which panels of one member stay, by where they lie on another.
#[derive(Clone, Copy, PartialEq)]
enum Keep {
    /// Outside the other; on a face of it, if the normals agree.
    OutsideOrAlong,
    /// Outside the other; on a face of it, if the normals are opposite.
    OutsideOrAgainst,
    Outside,
    Inside,
}

/// The part of a panel of given `width` \[m\] that stays: all, nothing, or, where
/// the other member cuts it, the distance to the cut along the panel in units
/// of its width.
fn part_kept(panel: &Panel, width: f64, other: &Shape, keep: Keep, tolerance: f64) -> f64 {
    let sign = if keep == Keep::Inside { -1.0 } else { 1.0 };
    let distance = sign * other.signed_distance(&panel.centre);
    if distance.abs() > width {
        return if distance > 0.0 { 1.0 } else { 0.0 };
    }
    let gradient = other.gradient(&panel.centre);
    let along = gradient.dot(&panel.normal);
    let steepness = (gradient - along * panel.normal).norm();
    if steepness > 1e-3 {
        return (0.5 + distance / (width * steepness)).clamp(0.0, 1.0);
    }
    let stays = match keep {
        _ if distance.abs() > tolerance => distance > 0.0,
        Keep::OutsideOrAlong => along > 0.0,
        Keep::OutsideOrAgainst => along < 0.0,
        Keep::Outside | Keep::Inside => false,
    };
    if stays { 1.0 } else { 0.0 }
}

/// Panels of the members that lie on the boundary of the composite, cut in
/// proportion where members meet. Of coinciding faces one stays, if any.
/// `width` gives the edge of a panel \[m\].
fn composite_panels(
    shape: &Shape,
    width: impl Fn(&Panel) -> f64,
    of: PanelsOf,
) -> Result<Vec<Panel>, GeometryError> {
    let tolerance = 1e-9 * shape.size();
    let mut kept = Vec::new();
    let mut cut = |panel: Panel, others: &mut dyn Iterator<Item = (&Shape, Keep)>, flip: f64| {
        let part: f64 = others
            .map(|(other, keep)| part_kept(&panel, width(&panel), other, keep, tolerance))
            .product();
        if part > 1e-6 {
            kept.push(Panel { area: part * panel.area, normal: flip * panel.normal, ..panel });
        }
    };
    match shape {
        Shape::Union(members) => {
            for (n, member) in members.iter().enumerate() {
                for panel in of(member)? {
                    let others = members.iter().enumerate().filter(|(other, _)| *other != n);
                    let rule = |other| if n < other { Keep::OutsideOrAlong } else { Keep::Outside };
                    cut(panel, &mut others.map(|(other, shape)| (shape, rule(other))), 1.0);
                }
            }
        }
        Shape::Difference(body, hole) => {
            for panel in of(body)? {
                cut(panel, &mut std::iter::once((&**hole, Keep::OutsideOrAgainst)), 1.0);
            }
            for panel in of(hole)? {
                cut(panel, &mut std::iter::once((&**body, Keep::Inside)), -1.0);
            }
        }
        _ => {}
    }
    Ok(kept)
}
