//! The boundary as small panels, for surface integrals.

use crate::algebra::tensor::Vector3;
use crate::geometry::boundary::composite::composite_patches;
use crate::geometry::boundary::curve_panels::{ellipse_patches, line_patches, segment_patches};
use crate::geometry::boundary::marching;
use crate::geometry::boundary::merged_triangles::merged_patches;
use crate::geometry::boundary::panel::{Panel, pieces_of_box};
use crate::geometry::boundary::patch::Patch;
use crate::geometry::boundary::solid_panels::{
    box_patches, cylinder_patches, ellipsoid_patches, prism_patches, rectangle, triangle_patches,
};
use crate::geometry::boundary::vicinity::Vicinity;
use crate::geometry::boundary::voxel_panels::{merges_voxels, voxel_patches};
use crate::geometry::dimension::Dimension;
use crate::geometry::error::{GeometryError, positive};
use crate::geometry::polygon::anticlockwise;
use crate::geometry::primitives::perpendicular;
use crate::geometry::shape::Shape;
use crate::geometry::size_limit::PANELS;
use rayon::prelude::*;

/// Few bodies have less surface than this fraction of that of their bounding box \[–\].
const FILLED: f64 = 1.0 / 3.0;

impl Shape {
    /// Panels with edges of at most `size` \[m\] that cover the boundary, in
    /// a plane that of the cross-section without its ends. Areas are exact for flat faces,
    /// cylinders and spheres, and panels end where members of a composite meet.
    pub fn boundary_panels(
        &self,
        size: f64,
        dimension: &Dimension,
    ) -> Result<Vec<Panel>, GeometryError> {
        let mut panels: Vec<Panel> = self.boundary_pieces(size, dimension)?;
        if let Dimension::PlaneStrain { thickness, .. } = dimension {
            panels.iter_mut().for_each(|panel| panel.area *= thickness);
        }
        Ok(panels)
    }

    /// The same with their geometry, in the same order, in a plane of thickness 1.
    pub(crate) fn boundary_patches(
        &self,
        size: f64,
        dimension: &Dimension,
    ) -> Result<Vec<Patch>, GeometryError> {
        self.boundary_pieces(size, dimension)
    }

    fn boundary_pieces<T: From<Patch> + Send>(
        &self,
        size: f64,
        dimension: &Dimension,
    ) -> Result<Vec<T>, GeometryError> {
        positive("the panel size", size)?;
        match dimension {
            Dimension::Three => {
                surface_pieces(self, size, &Vicinity::new(self.finite_bounds(dimension)?))
            }
            Dimension::PlaneStrain { z, .. } => {
                let section = self.section_at(*z)?;
                let around = Vicinity::new(section.finite_bounds(dimension)?);
                let patches = curve_patches(&section, size, *z, &around)?;
                Ok(patches.into_iter().map(T::from).collect())
            }
        }
    }
}

/// Refuses a shape, or a member of one that may be much larger than the body, before any of
/// its panels is made.
fn refuse_too_many(
    shape: &Shape,
    size: f64,
    dimension: &Dimension,
    around: &Vicinity,
) -> Result<(), GeometryError> {
    let Ok((lower, upper)) = shape.finite_bounds(dimension) else { return Ok(()) };
    let extent = match shape {
        Shape::Box { min, max } => around.common_edges(min, max),
        // Bands are as fine everywhere as the longest radius wants them.
        Shape::Ellipsoid { .. } => Vector3::repeat((upper - lower).max()),
        _ => upper - lower,
    };
    PANELS.check(FILLED * pieces_of_box(&extent, size, dimension))
}

/// Panels whose area is a length, of a section.
fn curve_patches(
    shape: &Shape,
    size: f64,
    z: f64,
    around: &Vicinity,
) -> Result<Vec<Patch>, GeometryError> {
    let flat = Dimension::PlaneStrain { thickness: 1.0, z };
    refuse_too_many(shape, size, &flat, around)?;
    match shape {
        Shape::Polygon { points, .. } => Ok(line_patches(&anticlockwise(points), size, z)),
        Shape::Ellipsoid { centre, radii } => Ok(ellipse_patches(centre, radii, size, z)),
        Shape::HalfSpace { point, normal } => {
            let (middle, reach) = around.square(point, normal);
            let along = reach * Vector3::new(-normal.y, normal.x, 0.0);
            let (a, b) = (middle - along, middle + along);
            Ok(segment_patches([a.x, a.y], [b.x, b.y], size, z).collect())
        }
        Shape::Labels(field) => {
            let curves = marching::contours(shape, z, (0.7 * size).min(field.voxel()))?;
            Ok(curves.iter().flat_map(|curve| line_patches(curve, size, z)).collect())
        }
        Shape::Function(_) => {
            let curves = marching::contours(shape, z, 0.7 * size)?;
            Ok(curves.iter().flat_map(|curve| line_patches(curve, size, z)).collect())
        }
        Shape::Union(_) | Shape::Intersection(_) | Shape::Difference(..) => {
            composite_patches(shape, &|member| curve_patches(member, size, z, around))
        }
        _ => Err(GeometryError::Unbounded { shape: shape.name() }),
    }
}

fn surface_pieces<T: From<Patch> + Send>(
    shape: &Shape,
    size: f64,
    around: &Vicinity,
) -> Result<Vec<T>, GeometryError> {
    refuse_too_many(shape, size, &Dimension::Three, around)?;
    let pieces: Vec<T> = match shape {
        Shape::Labels(field) if merges_voxels(field, size) => {
            voxel_patches(shape, field, size)?.into_iter().map(T::from).collect()
        }
        Shape::Labels(_) | Shape::Function(_) => {
            isosurface_pieces(shape, size / 3_f64.sqrt(), size)?
        }
        Shape::Surface(surface) if surface.merges_triangles(size) => {
            merged_patches(surface.corners(), size)
        }
        Shape::Surface(surface) => triangle_patches(surface.corners(), size),
        _ => solid_patches(shape, size, around)?.into_iter().map(T::from).collect(),
    };
    PANELS.check(pieces.len() as f64).map(|()| pieces)
}

/// Of a shape that is stated by a few numbers, and of composites.
fn solid_patches(shape: &Shape, size: f64, around: &Vicinity) -> Result<Vec<Patch>, GeometryError> {
    match shape {
        Shape::Box { min, max } => Ok(box_patches(min, max, size, around)),
        Shape::Cylinder { base, axis, radius, height } => {
            Ok(cylinder_patches(base, axis, *radius, *height, (size, around)))
        }
        Shape::Sphere { centre, radius } => {
            Ok(ellipsoid_patches(centre, &Vector3::repeat(*radius), size, around))
        }
        Shape::Ellipsoid { centre, radii } if radii.z.is_finite() => {
            Ok(ellipsoid_patches(centre, radii, size, around))
        }
        Shape::Polygon { points, z } if (z.1 - z.0).is_finite() => {
            Ok(prism_patches(points, *z, size, around))
        }
        Shape::HalfSpace { point, normal } => {
            let (middle, reach) = around.square(point, normal);
            let (u, v) = perpendicular(normal);
            let mut patches = Vec::new();
            let corner = middle - reach * (u + v);
            rectangle(corner, [2.0 * reach * u, 2.0 * reach * v], (size, around), &mut patches);
            Ok(patches)
        }
        Shape::Union(_) | Shape::Intersection(_) | Shape::Difference(..) => {
            composite_patches(shape, &|member| surface_pieces(member, size, around))
        }
        _ => Err(GeometryError::Unbounded { shape: shape.name() }),
    }
}

/// Panels of edge `size` \[m\] on triangles from cubes of `step` \[m\].
fn isosurface_pieces<T: From<Patch> + Send>(
    shape: &Shape,
    step: f64,
    size: f64,
) -> Result<Vec<T>, GeometryError> {
    let layers = marching::isosurface(shape, step)?.into_par_iter();
    Ok(layers.flat_map_iter(|layer| triangle_patches(layer.into_iter(), size)).collect())
}
