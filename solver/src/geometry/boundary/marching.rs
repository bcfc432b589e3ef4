//! Outlines and surfaces of any solid from samples of its signed distance.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::error::GeometryError;
use crate::geometry::polygon::closed_chains;
use crate::geometry::shape::Shape;
use crate::geometry::size_limit::DISTANCE_SAMPLES;
use crate::geometry::triangles::{Triangle, area_vector, merged};
use crate::geometry::voxels::{ScalarGrid, indices};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Signed distances on a grid of about `step` \[m\] around a box, and the
/// position of the first sample.
fn samples(
    shape: &Shape,
    lower: Vector3,
    upper: Vector3,
    step: f64,
) -> Result<(ScalarGrid, Vector3), GeometryError> {
    let flat = upper.z <= lower.z;
    // The odd fractions keep samples off round coordinates.
    let margin = Vector3::new(1.37, 1.41, if flat { 0.0 } else { 1.43 }) * step;
    let (lower, upper) = (lower - margin, upper + margin);
    let count = ((upper - lower) / step).map(|c| c.ceil() + 1.0);
    DISTANCE_SAMPLES.check(count.product())?;
    let size = [0, 1, 2].map(|k| count[k] as usize);
    let mut grid = ScalarGrid { size, step: Vector3::repeat(step), values: Vec::new() };
    let mut values = vec![0.0; size.iter().product()];
    values.par_chunks_mut(size[0]).enumerate().for_each(|(row, values)| {
        let at = |i: usize| lower + grid.local(i + row * size[0]);
        fill_row(values, steepness(shape), step, |i| shape.signed_distance(&at(i)));
    });
    grid.values = values;
    Ok((grid, lower))
}

/// The most that a signed distance changes over a length, if that is known \[–\].
fn steepness(shape: &Shape) -> f64 {
    match shape {
        // Distances of neighbouring voxels differ by little more than theirs.
        Shape::Labels(_) => 2.0,
        _ => f64::INFINITY,
    }
}

/// Values along a row of samples `step` \[m\] apart. Those that lie, with all their neighbours in
/// space, on the same side of the level as one before have its value.
fn fill_row(values: &mut [f64], steepness: f64, step: f64, value_at: impl Fn(usize) -> f64) {
    let mut i = 0;
    while i < values.len() {
        let value = value_at(i);
        let alike = (value.abs() / (steepness * step) - 3_f64.sqrt()).max(0.0) as usize;
        let end = (i + alike + 1).min(values.len());
        values[i..end].fill(value);
        i = end;
    }
}

/// Closed polylines around the zero level at height z, inside to the left,
/// from pixels of `step` \[m\] (marching squares).
pub(super) fn contours(
    shape: &Shape,
    z: f64,
    step: f64,
) -> Result<Vec<Vec<[f64; 2]>>, GeometryError> {
    let Some((mut lower, mut upper)) = shape.bounding_box() else {
        return Err(GeometryError::Unbounded { shape: shape.name() });
    };
    (lower.z, upper.z) = (z, z);
    let (grid, corner) = samples(shape, lower, upper, step)?;
    let mut next = BTreeMap::new();
    for j in 0..grid.size[1] - 1 {
        for i in 0..grid.size[0] - 1 {
            cross_square(&grid, i, j, &mut next);
        }
    }
    let point = |(a, b): (usize, usize)| {
        let t = grid.values[a] / (grid.values[a] - grid.values[b]);
        let at = corner + grid.local(a) + t * (grid.local(b) - grid.local(a));
        [at.x, at.y]
    };
    let curves = closed_chains(next).into_iter();
    Ok(curves.map(|edges| edges.into_iter().map(point).collect()).collect())
}

type GridEdge = (usize, usize);

/// Adds the segments in one square, each from the grid edge where a walk
/// around the square leaves the solid to one where it comes back.
fn cross_square(grid: &ScalarGrid, i: usize, j: usize, next: &mut BTreeMap<GridEdge, GridEdge>) {
    let corner = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| grid.index(i, j, 0));
    let inside = corner.map(|c| grid.values[c] < 0.0);
    let edge = |e: usize| {
        let (a, b) = (corner[e], corner[(e + 1) % 4]);
        (a.min(b), a.max(b))
    };
    let leaves = |e: usize| inside[e] && !inside[(e + 1) % 4];
    let returns = |e: usize| !inside[e] && inside[(e + 1) % 4];
    // On a saddle the solid is connected if its middle is inside.
    let joined = corner.iter().map(|&c| grid.values[c]).sum::<f64>() < 0.0;
    for e in (0..4).filter(|&e| leaves(e)) {
        let back = (1..4).map(|n| if joined { e + n } else { e + 4 - n } % 4).find(|&b| returns(b));
        if let Some(back) = back {
            next.insert(edge(e), edge(back));
        }
    }
}

/// Triangles around the zero level from cubes of `step` \[m\] cut into six
/// tetrahedra each (marching tetrahedra), anticlockwise seen from outside, by layers of cubes.
pub(super) fn isosurface(shape: &Shape, step: f64) -> Result<Vec<Vec<Triangle>>, GeometryError> {
    isosurface_by_cubes(shape, step, |_, triangles, out| out.append(triangles))
}

/// What `see` makes of the triangles of [`isosurface`] in each cube that has some, by layers.
/// It gets the indices of the cube, whose first one begins about a step outside the bounding box.
pub(super) fn isosurface_by_cubes<T: Send>(
    shape: &Shape,
    step: f64,
    see: impl Fn([usize; 3], &mut Vec<Triangle>, &mut Vec<T>) + Sync,
) -> Result<Vec<Vec<T>>, GeometryError> {
    let Some((lower, upper)) = shape.bounding_box() else {
        return Err(GeometryError::Unbounded { shape: shape.name() });
    };
    let (grid, corner) = samples(shape, lower, upper, step)?;
    let layer = |k: usize| {
        let (mut triangles, mut seen) = (Vec::new(), Vec::new());
        for [i, j, _] in indices([grid.size[0] - 1, grid.size[1] - 1, 1]) {
            cross_cube(&grid, &corner, [i, j, k], &mut triangles);
            if !triangles.is_empty() {
                see([i, j, k], &mut triangles, &mut seen);
                triangles.clear();
            }
        }
        seen
    };
    Ok((0..grid.size[2] - 1).into_par_iter().map(layer).collect())
}

/// Paths from corner 0 to corner 7 of a cube; bit n of a corner is axis n.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

fn cross_cube(grid: &ScalarGrid, corner: &Vector3, ijk: [usize; 3], out: &mut Vec<Triangle>) {
    let [i, j, k] = ijk;
    let index: [usize; 8] =
        std::array::from_fn(|c| grid.index(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)));
    let inside = index.iter().filter(|&&n| grid.values[n] < 0.0).count();
    if inside == 0 || inside == 8 {
        return;
    }
    for tetrahedron in TETRAHEDRA {
        cross_tetrahedron(grid, corner, tetrahedron.map(|c| index[c]), out);
    }
}

fn cross_tetrahedron(
    grid: &ScalarGrid,
    corner: &Vector3,
    index: [usize; 4],
    out: &mut Vec<Triangle>,
) {
    let (inside, outside): (Vec<usize>, Vec<usize>) =
        index.iter().partition(|&&n| grid.values[n] < 0.0);
    let cut = |a: usize, b: usize| {
        // The same end first from both sides, so that the bits agree.
        let (a, b) = (a.min(b), a.max(b));
        let t = grid.values[a] / (grid.values[a] - grid.values[b]);
        corner + grid.local(a) + t * (grid.local(b) - grid.local(a))
    };
    let mut push = |mut t: Triangle| {
        let outwards = grid.local(outside[0]) - grid.local(inside[0]);
        if area_vector(&t).dot(&outwards) < 0.0 {
            t.swap(1, 2);
        }
        if area_vector(&t).norm() > 0.0 {
            out.push(t);
        }
    };
    match (inside.as_slice(), outside.as_slice()) {
        (&[a], &[p, q, r]) => push([cut(a, p), cut(a, q), cut(a, r)]),
        (&[a, b, c], &[p]) => push([cut(a, p), cut(b, p), cut(c, p)]),
        (&[a, b], &[p, q]) => {
            push([cut(a, p), cut(a, q), cut(b, q)]);
            push([cut(a, p), cut(b, q), cut(b, p)]);
        }
        _ => {}
    }
}

impl Shape {
    /// Vertices of triangles around the solid \[m\] and the corners of each, anticlockwise seen
    /// from outside, from cubes of `size` \[m\]; for drawings.
    pub fn triangles(&self, size: f64) -> Result<(Vec<Vector3>, Vec<[u32; 3]>), GeometryError> {
        let (vertices, corners) = merged(isosurface(self, size)?.iter().flatten().flatten());
        Ok((vertices, corners.as_chunks().0.to_vec()))
    }

    /// Closed polylines \[m\] around the cross-section at height z \[m\], the
    /// solid to their left, from pixels of `size` \[m\]; for drawings. Empty
    /// where there is no section.
    pub fn outline(&self, z: f64, size: f64) -> Vec<Vec<[f64; 2]>> {
        let section = match self.section_at(z) {
            Ok(section) => section,
            Err(GeometryError::SectionUnsupported { .. }) => self.clone(),
            Err(_) => return Vec::new(),
        };
        contours(&section, z, size).unwrap_or_default()
    }
}
