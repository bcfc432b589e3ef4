//! Surfaces of a body and of its regions, before and after the deformation.
#![allow(non_snake_case)]

use super::error::WarpError;
use super::field::DisplacementField;
use crate::display::solid;
use mtled::geometry::Shape;
use mtled::problem::{Dimension, Problem};
use mtled_io::files::surface::Triangles;
use rayon::prelude::*;

/// Edge of the cubes that a surface is made from: at most this part of the smallest nodal spacing
/// and of the least extent of the solid, and a voxel \[–\].
const OF_SPACING: f64 = 0.5;
const OF_EXTENT: f64 = 0.04;

/// The surface of the body or of one of its regions.
#[derive(Debug, Clone)]
pub struct RegionSurface {
    /// "body", or "region_" and the name of the region.
    pub name: String,
    /// Before the deformation.
    pub before: Triangles,
    /// After it, the same triangles.
    pub after: Triangles,
}

/// Surfaces of the body and, where it has several, of its regions; and the names of regions
/// whose selection is no solid.
pub fn region_surfaces(
    problem: &Problem,
    field: &DisplacementField,
) -> Result<(Vec<RegionSurface>, Vec<String>), WarpError> {
    if problem.dimension != Dimension::Three {
        return Err(WarpError::NoSurfaces);
    }
    let mut shapes = vec![("body".to_string(), problem.body.clone())];
    let (mut earlier, mut left_out) = (Vec::new(), Vec::new());
    let regions = if problem.regions.len() > 1 { &problem.regions[..] } else { &[] };
    for region in regions {
        match solid(&region.part, &problem.body) {
            Some(shape) => {
                let own = if earlier.is_empty() {
                    shape.clone()
                } else {
                    without(&shape, Shape::Union(earlier.clone()))
                };
                shapes.push((format!("region_{}", region.name), own));
                earlier.push(shape);
            }
            None => left_out.push(region.name.clone()),
        }
    }
    let spacing = field.smallest_spacing(problem.recipe.dilation);
    let most = voxel(&problem.body).min(OF_SPACING * spacing);
    let drawn = shapes.into_iter().map(|(name, shape)| {
        let extent = shape.bounding_box().map_or(f64::INFINITY, |(low, high)| (high - low).min());
        let (vertices, triangles) = shape.triangles(most.min(OF_EXTENT * extent))?;
        let moved = vertices.par_iter().map(|X| X + field.at(X)).collect();
        let after = Triangles { vertices: moved, triangles: triangles.clone() };
        Ok(RegionSurface { name, before: Triangles { vertices, triangles }, after })
    });
    Ok((drawn.collect::<Result<_, WarpError>>()?, left_out))
}

fn without(shape: &Shape, hole: Shape) -> Shape {
    Shape::Difference(Box::new(shape.clone()), Box::new(hole))
}

/// Edge of a voxel of the label map that a body is made of \[m\].
fn voxel(body: &Shape) -> f64 {
    match body {
        Shape::Labels(field) => field.voxel(),
        _ => f64::INFINITY,
    }
}
