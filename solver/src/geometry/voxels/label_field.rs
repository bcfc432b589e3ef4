//! The solid made of some labels of an image, with a smooth surface.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::geometry::error::GeometryError;
use crate::geometry::voxels::grid::{ScalarGrid, indices};
use crate::geometry::voxels::label_map::LabelMap;
use crate::geometry::voxels::surface_piece::SurfacePiece;
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

/// Voxels of empty space around the image, which may be filled to its edge.
const MARGIN: usize = 3;
/// How far from 1/2 the smoothed image stays at the centres of voxels, on their own side.
const CLEARANCE: f64 = 0.01;

/// Signed distance to the smoothed outline of some labels, sampled once.
///
/// The 0/1 image is smoothed by Gaussians, between which no voxel may change
/// sides (method book, section 4); the distance to its 1/2 level is computed at the
/// voxel centres, shifted by a constant so that the enclosed volume is that of the
/// voxels, and interpolated trilinearly.
#[derive(Debug, Clone)]
pub struct LabelField {
    map: Arc<LabelMap>,
    labels: Vec<u32>,
    smoothing: f64,
    /// Signed distance on the voxel centres \[m\]; one layer along an axis
    /// for a plane cross-section.
    distance: ScalarGrid,
    /// First sample \[m\].
    corner: Vector3,
    /// Rows: unit vectors along the indices.
    frame: Matrix3,
    bounds: (Vector3, Vector3),
    /// The surface within each voxel, once it has been cut.
    surface: OnceLock<Arc<Vec<SurfacePiece>>>,
}

fn check(map: &LabelMap, labels: &[u32], smoothing: f64) -> Result<(), GeometryError> {
    if labels.is_empty() {
        return Err(GeometryError::NoLabels);
    }
    let most = LabelField::MOST_SMOOTHING;
    if !(smoothing > 0.0 && smoothing <= most) {
        return Err(GeometryError::Smoothing { smoothing, most });
    }
    match labels.iter().find(|label| !map.labels.contains(label)) {
        Some(&label) => Err(GeometryError::NoSuchLabel { label }),
        None => Ok(()),
    }
}

impl LabelField {
    /// Standard deviation of the smoothing \[voxel\] that suits most images.
    pub const SMOOTHING: f64 = 0.7;
    /// The largest standard deviation of the smoothing \[voxel\].
    pub const MOST_SMOOTHING: f64 = 4.0;

    /// The solid of all voxels that have one of `labels`; `smoothing` is the
    /// standard deviation of the Gaussian \[voxel\].
    pub fn new(map: Arc<LabelMap>, labels: &[u32], smoothing: f64) -> Result<Self, GeometryError> {
        check(&map, labels, smoothing)?;
        let size = map.size.map(|n| n + 2 * MARGIN);
        Ok(Self::sampled(map, (labels, smoothing), size, [MARGIN as i64; 3]))
    }

    /// The cross-section of [`LabelField::new`] at height z \[m\], without ends:
    /// that of the layer of voxels nearest to z. One index must run along z.
    pub fn section(
        map: Arc<LabelMap>,
        labels: &[u32],
        smoothing: f64,
        z: f64,
    ) -> Result<Self, GeometryError> {
        check(&map, labels, smoothing)?;
        let shape = "label map";
        let step = map.voxel();
        let along_z = |k: &usize| map.directions[(2, *k)].abs() > (1.0 - 1e-6) * step[*k];
        let axis = (0..3).find(along_z).ok_or(GeometryError::SectionUnsupported { shape, z })?;
        let at = Vector3::new(map.origin.x, map.origin.y, z);
        let layer = map.index_of(&at)[axis];
        let last = map.size[axis] as f64 - 1.0;
        let empty = GeometryError::SectionEmpty { shape, z };
        if !(layer > -0.5 - 1e-9 && layer < last + 0.5 + 1e-9) {
            return Err(empty);
        }
        let mut size = map.size.map(|n| n + 2 * MARGIN);
        let mut shift = [MARGIN as i64; 3];
        size[axis] = 1;
        shift[axis] = -(layer.round().clamp(0.0, last) as i64);
        let section = Self::sampled(map, (labels, smoothing), size, shift);
        if section.distance.values.iter().all(|&d| d >= 0.0) { Err(empty) } else { Ok(section) }
    }

    /// The cross-section at height z \[m\]; that of a section is itself.
    pub fn slice(&self, z: f64) -> Result<LabelField, GeometryError> {
        if self.distance.size.contains(&1) {
            return Ok(self.clone());
        }
        LabelField::section(self.map.clone(), &self.labels, self.smoothing, z)
    }

    /// Sample (i, j, k) is voxel (i, j, k) − `shift`.
    fn sampled(
        map: Arc<LabelMap>,
        (labels, smoothing): (&[u32], f64),
        size: [usize; 3],
        shift: [i64; 3],
    ) -> Self {
        let step = map.voxel();
        let chosen = |at: [i64; 3]| {
            let within = (0..3).all(|k| at[k] >= 0 && at[k] < map.size[k] as i64);
            let [i, j, k] = at.map(|c| c.max(0) as usize);
            within && labels.contains(&map.labels[i + map.size[0] * (j + map.size[1] * k)])
        };
        let inside = |ijk: [usize; 3]| chosen([0, 1, 2].map(|k| ijk[k] as i64 - shift[k]));
        let values = indices(size).map(|ijk| if inside(ijk) { 1.0 } else { 0.0 }).collect();
        let mut image = ScalarGrid { size, step, values };
        let voxels: f64 = image.values.iter().sum();
        smooth(&mut image, smoothing);
        image.values.iter_mut().for_each(|v| *v = 0.5 - *v);
        let mut distance = image.distance_to_zero_level();
        keep_volume(&mut distance, voxels);
        let first = Vector3::from_fn(|k, _| shift[k] as f64);
        let corner = map.origin - map.directions * first;
        let frame = Matrix3::from_fn(|k, c| map.directions[(c, k)] / step[k]);
        let bounds = bounds(&distance, &corner, &frame);
        let labels = labels.to_vec();
        let surface = OnceLock::new();
        LabelField { map, labels, smoothing, distance, corner, frame, bounds, surface }
    }

    /// Signed distance \[m\], negative inside.
    pub fn signed_distance(&self, X: &Vector3) -> f64 {
        self.distance.sample(&(self.frame * (X - self.corner)))
    }

    /// The image that the solid comes from.
    pub fn map(&self) -> &Arc<LabelMap> {
        &self.map
    }

    /// The labels that the solid consists of.
    pub fn labels(&self) -> &[u32] {
        &self.labels
    }

    /// Standard deviation of the smoothing \[voxel\].
    pub fn smoothing(&self) -> f64 {
        self.smoothing
    }

    /// Number of sampled distances.
    pub(crate) fn samples(&self) -> usize {
        self.distance.values.len()
    }

    /// Smallest edge of a voxel \[m\].
    pub fn voxel(&self) -> f64 {
        self.distance.step.min()
    }

    /// What the surface within each voxel is kept in: it is the same for all spacings.
    pub(crate) fn surface(&self) -> &OnceLock<Arc<Vec<SurfacePiece>>> {
        &self.surface
    }

    /// Memory of that surface \[bytes\]; of one that is not there yet as if it had the area of the
    /// image.
    pub(crate) fn surface_bytes(&self) -> f64 {
        let faces = || 6.0 * (self.samples() as f64).powf(2.0 / 3.0);
        let pieces = self.surface.get().map_or_else(faces, |pieces| pieces.len() as f64);
        pieces * size_of::<SurfacePiece>() as f64
    }

    /// Around all samples within a voxel of the solid; infinite along the
    /// axis of a plane cross-section.
    pub(crate) fn bounding_box(&self) -> (Vector3, Vector3) {
        self.bounds
    }
}

fn bounds(grid: &ScalarGrid, corner: &Vector3, frame: &Matrix3) -> (Vector3, Vector3) {
    let reach = grid.step.max();
    let mut lower = Vector3::repeat(f64::INFINITY);
    let mut upper = -lower;
    for (index, _) in grid.values.iter().enumerate().filter(|(_, d)| **d < reach) {
        let X = corner + frame.transpose() * grid.local(index);
        (lower, upper) = (lower.inf(&X), upper.sup(&X));
    }
    if grid.size.contains(&1) {
        (lower.z, upper.z) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    (lower, upper)
}

/// Smooths a 0/1 image by passes of 0.7 voxels at most, after each of which values cross 1/2
/// nowhere (after Whitaker 2000): steps between layers of voxels go, thin parts stay.
fn smooth(image: &mut ScalarGrid, smoothing: f64) {
    let solid: Vec<bool> = image.values.iter().map(|&v| v > 0.5).collect();
    let passes = ((smoothing / LabelField::SMOOTHING).powi(2) - 1e-9).ceil().max(1.0);
    let mut before = vec![0.0; image.values.len()];
    for _ in 0..passes as usize {
        let size = image.size;
        for axis in (0..3).filter(|&axis| size[axis] > 1) {
            before.copy_from_slice(&image.values);
            smooth_along(image, &before, axis, smoothing / passes.sqrt());
        }
        for (value, &solid) in image.values.iter_mut().zip(&solid) {
            *value = if solid { value.max(0.5 + CLEARANCE) } else { value.min(0.5 - CLEARANCE) };
        }
    }
}

/// Gaussian of the values `old` along one axis, zero outside the grid.
fn smooth_along(image: &mut ScalarGrid, old: &[f64], axis: usize, deviation: f64) {
    let kernel: Vec<f64> = (0..4).map(|n| (-0.5 * (n as f64 / deviation).powi(2)).exp()).collect();
    let sum = kernel[0] + 2.0 * kernel[1..].iter().sum::<f64>();
    let stride: usize = image.size[..axis].iter().product();
    let n = image.size[axis];
    // Along the first axis a whole row at once, along others a layer across them.
    let (length, count) = if axis == 0 { (n, 1) } else { (stride, n) };
    image.values.par_chunks_mut(length).enumerate().for_each(|(chunk, values)| {
        let (start, position) = (chunk * length, chunk % count);
        let at = |from: usize| &old[from..from + length];
        values.iter_mut().for_each(|value| *value *= kernel[0]);
        for (reach, factor) in kernel.iter().enumerate().skip(1).filter(|(reach, _)| *reach < n) {
            if axis == 0 {
                add(&mut values[reach..], *factor, &old[start..start + n - reach]);
                add(&mut values[..n - reach], *factor, &old[start + reach..start + n]);
                continue;
            }
            if position >= reach {
                add(values, *factor, at(start - reach * stride));
            }
            if position + reach < n {
                add(values, *factor, at(start + reach * stride));
            }
        }
        values.iter_mut().for_each(|value| *value /= sum);
    });
}

fn add(values: &mut [f64], factor: f64, others: &[f64]) {
    values.iter_mut().zip(others).for_each(|(value, other)| *value += factor * other);
}

/// Shifts the distance until as many voxels are enclosed as before smoothing,
/// which shrinks convex outlines.
fn keep_volume(distance: &mut ScalarGrid, voxels: f64) {
    let axes: Vec<usize> = (0..3).filter(|&k| distance.size[k] > 1).collect();
    let width = axes.iter().map(|&k| distance.step[k]).fold(0.0, f64::max) * 1.5;
    for _ in 0..4 {
        let near = distance.values.iter().filter(|d| d.abs() < 0.5 * width).count() as f64 / width;
        if near == 0.0 {
            return;
        }
        let shift = (voxels - enclosed(distance)) / near;
        let shift = shift.clamp(-0.2 * width, 0.2 * width);
        distance.values.iter_mut().for_each(|d| *d -= shift);
    }
}

/// The values at the corners of a cell, the first index fastest.
fn corners(grid: &ScalarGrid, [i, j, k]: [usize; 3]) -> [f64; 8] {
    let end = |at: usize, axis: usize| (at + 1).min(grid.size[axis] - 1);
    let (i, j, k) = ([i, end(i, 0)], [j, end(j, 1)], [k, end(k, 2)]);
    std::array::from_fn(|n| grid.values[grid.index(i[n & 1], j[n >> 1 & 1], k[n >> 2])])
}

/// Where the points of a cell lie along its edges.
const ALONG_EDGE: [f64; 4] = [0.125, 0.375, 0.625, 0.875];

/// The part of a cell below zero, from 64 points, each of which stands for a thickness `fine` \[m\].
fn share_below(corners: &[f64; 8], fine: f64) -> f64 {
    let between = |low: f64, high: f64, part: f64| low + part * (high - low);
    let mut sum = 0.0;
    for z in ALONG_EDGE {
        let plane: [f64; 4] = std::array::from_fn(|n| between(corners[n], corners[n + 4], z));
        for y in ALONG_EDGE {
            let [low, high] = [0, 1].map(|n| between(plane[n], plane[n + 2], y));
            let share = |x: f64| (0.5 - between(low, high, x) / fine).clamp(0.0, 1.0);
            sum += ALONG_EDGE.map(share).iter().sum::<f64>();
        }
    }
    sum / 64.0
}

/// Volume below zero in units of voxels; points count in the cells that the zero level may cut.
fn enclosed(distance: &ScalarGrid) -> f64 {
    // A little more than half, for round-off.
    const SURELY: f64 = 0.51;
    let diagonal = distance.step.norm();
    let fine = distance.step.max() * (ALONG_EDGE[1] - ALONG_EDGE[0]);
    let [nx, ny, layers] = distance.size.map(|n| if n > 1 { n - 1 } else { 1 });
    let share = |ijk: [usize; 3]| {
        let value = distance.values[distance.index(ijk[0], ijk[1], ijk[2])];
        if value.abs() > diagonal + fine {
            return if value < 0.0 { 1.0 } else { 0.0 };
        }
        // Nor do cells count in part whose corners all lie away from the level.
        let corners = corners(distance, ijk);
        match corners.iter().all(|d| d.abs() > SURELY * fine && d.signum() == value.signum()) {
            true if value < 0.0 => 1.0,
            true => 0.0,
            false => share_below(&corners, fine),
        }
    };
    let layer = |k: usize| indices([nx, ny, 1]).map(|[i, j, _]| share([i, j, k])).sum::<f64>();
    // Added in the order of the layers.
    let layers: Vec<f64> = (0..layers).into_par_iter().map(layer).collect();
    layers.iter().sum()
}
