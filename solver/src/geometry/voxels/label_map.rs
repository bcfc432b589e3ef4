//! Segmented images as geometry.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::geometry::error::GeometryError;
use crate::geometry::voxels::grid::indices;
use crate::geometry::voxels::label_blocks::LabelBlocks;
use std::collections::HashMap;
use std::ops::RangeInclusive;
use std::sync::OnceLock;

/// Edges that voxels may have \[m\]: those of microscopes and of landscapes.
const POSSIBLE_EDGES: RangeInclusive<f64> = 1e-9..=1e3;
/// How far from the origin an image may begin \[m\].
const FARTHEST: f64 = 1e7;

/// For round-off where a place is near the border of a voxel \[voxel\].
const ROUND_OFF: f64 = 1e-6;

/// A segmented image: one label per voxel, label 0 is outside.
#[derive(Debug, Clone)]
pub struct LabelMap {
    /// Number of voxels along each index.
    pub size: [usize; 3],
    /// Centre of voxel (0, 0, 0) \[m\].
    pub origin: Vector3,
    /// Column k: step from one voxel centre to the next along index k \[m\].
    pub directions: Matrix3,
    /// Labels, first index fastest.
    pub labels: Vec<u32>,
    to_index: Matrix3,
    blocks: OnceLock<LabelBlocks>,
}

impl LabelMap {
    /// An image whose directions are perpendicular to one another, in any
    /// orientation.
    pub fn new(
        size: [usize; 3],
        origin: Vector3,
        directions: Matrix3,
        labels: Vec<u32>,
    ) -> Result<Self, GeometryError> {
        let expected = size.iter().product();
        if labels.len() != expected || expected == 0 {
            return Err(GeometryError::LabelCount { size, count: labels.len(), expected });
        }
        if !origin.iter().all(|c| c.is_finite()) {
            return Err(GeometryError::NotFinite { name: "the label map origin" });
        }
        for (axis, edge) in directions.column_iter().map(|step| step.norm()).enumerate() {
            if !POSSIBLE_EDGES.contains(&edge) {
                return Err(GeometryError::VoxelEdge { axis, edge });
            }
        }
        let distance = origin.norm();
        if distance > FARTHEST {
            return Err(GeometryError::FarOrigin { distance, farthest: FARTHEST });
        }
        let determinant = directions.determinant();
        let singular = GeometryError::SingularDirections { determinant };
        let volume: f64 = (0..3).map(|k| directions.column(k).norm()).product();
        if !(determinant.abs() > 1e-9 * volume && volume.is_finite()) {
            return Err(singular);
        }
        for (first, second) in [(0, 1), (0, 2), (1, 2)] {
            let (a, b) = (directions.column(first), directions.column(second));
            let cosine = a.dot(&b) / (a.norm() * b.norm());
            if cosine.abs() > 1e-4 {
                return Err(GeometryError::SkewDirections { first, second, cosine });
            }
        }
        let to_index = directions.try_inverse().ok_or(singular)?;
        Ok(LabelMap { size, origin, directions, labels, to_index, blocks: OnceLock::new() })
    }

    /// Edges of a voxel \[m\].
    pub fn voxel(&self) -> Vector3 {
        Vector3::from_fn(|k, _| self.directions.column(k).norm())
    }

    /// Centre of a voxel \[m\].
    pub fn centre(&self, i: usize, j: usize, k: usize) -> Vector3 {
        self.origin + self.directions * Vector3::new(i as f64, j as f64, k as f64)
    }

    /// The part of the image within `margin` voxels of those that have one of `labels`; all of it
    /// where none has.
    pub fn about(&self, labels: &[u32], margin: usize) -> LabelMap {
        let (mut first, mut last) = (self.size, [0; 3]);
        for (row, values) in self.labels.chunks(self.size[0]).enumerate() {
            let chosen = |label: &u32| labels.contains(label);
            let Some(low) = values.iter().position(chosen) else { continue };
            let high = values.iter().rposition(chosen).unwrap_or(low);
            let (j, k) = (row % self.size[1], row / self.size[1]);
            for (axis, (low, high)) in [(low, high), (j, j), (k, k)].into_iter().enumerate() {
                first[axis] = first[axis].min(low.saturating_sub(margin));
                last[axis] = last[axis].max((high + margin).min(self.size[axis] - 1));
            }
        }
        if first == self.size {
            return self.clone();
        }
        let size = [0, 1, 2].map(|axis| last[axis] - first[axis] + 1);
        let [i, j, k] = first;
        let labels = indices([1, size[1], size[2]]).flat_map(|[_, row, layer]| {
            let start = i + self.size[0] * (j + row + self.size[1] * (k + layer));
            self.labels[start..start + size[0]].iter().copied()
        });
        let (labels, blocks) = (labels.collect(), OnceLock::new());
        LabelMap { size, origin: self.centre(i, j, k), labels, blocks, ..*self }
    }

    /// The map in which voxels beside a body made of some `labels` have that of its nearest voxel: its smooth
    /// surface passes up to half a voxel beyond its own, and what lies there is as what it covers. It has
    /// another voxel on all sides where the body reaches the edge of the image.
    pub fn filled(&self, labels: &[u32]) -> LabelMap {
        let of_body = |label: u32| labels.contains(&label);
        let at_edge = indices(self.size).any(|at| {
            let is_last = |k: usize| at[k] == 0 || at[k] + 1 == self.size[k];
            (0..3).any(is_last) && of_body(self.label(at))
        });
        let mut filled = if at_edge { self.framed() } else { self.clone() };
        // Distance and label of the nearest voxel; of several as near the smallest label.
        let mut beside: HashMap<usize, (f64, u32)> = HashMap::new();
        let size = filled.size;
        let is_open =
            |at: [usize; 3]| (0..3).all(|k| at[k] < size[k]) && !of_body(filled.label(at));
        let by =
            |at: [usize; 3], way: [usize; 3]| [0, 1, 2].map(|k| (at[k] + way[k]).wrapping_sub(1));
        let faces = [[0, 1, 1], [2, 1, 1], [1, 0, 1], [1, 2, 1], [1, 1, 0], [1, 1, 2]];
        for at in indices(size) {
            let label = filled.label(at);
            if !of_body(label) || !faces.iter().any(|way| is_open(by(at, *way))) {
                continue;
            }
            for way in indices([3; 3]) {
                let next = by(at, way);
                if !is_open(next) {
                    continue;
                }
                let steps = Vector3::from(way.map(|n| n as f64 - 1.0));
                let distance = (self.directions * steps).norm();
                let nearest = beside.entry(filled.number(next)).or_insert((distance, label));
                let as_near = distance < (1.0 + ROUND_OFF) * nearest.0;
                if distance < (1.0 - ROUND_OFF) * nearest.0 || as_near && label < nearest.1 {
                    *nearest = (distance, label);
                }
            }
        }
        for (voxel, (_, label)) in beside {
            filled.labels[voxel] = label;
        }
        filled.blocks = OnceLock::new();
        filled
    }

    /// With a voxel of label 0 more on all sides.
    fn framed(&self) -> LabelMap {
        let size = self.size.map(|n| n + 2);
        let origin = self.origin - self.directions * Vector3::repeat(1.0);
        let (labels, blocks) = (vec![0; size.iter().product()], OnceLock::new());
        let mut framed = LabelMap { size, origin, labels, blocks, ..*self };
        for at in indices(self.size) {
            let voxel = framed.number(at.map(|n| n + 1));
            framed.labels[voxel] = self.label(at);
        }
        framed
    }

    /// Position in units of voxels; (0, 0, 0) is the centre of the first one.
    pub(super) fn index_of(&self, X: &Vector3) -> Vector3 {
        self.to_index * (X - self.origin)
    }

    fn blocks(&self) -> &LabelBlocks {
        self.blocks.get_or_init(|| LabelBlocks::new(self.size, &self.labels))
    }

    /// The label of the voxel that contains `X`, 0 outside the image.
    pub fn label_at(&self, X: &Vector3) -> u32 {
        let index = self.index_of(X);
        let mut voxel = [0; 3];
        for axis in 0..3 {
            let shifted = index[axis] + 0.5;
            if !(shifted >= 0.0 && shifted < self.size[axis] as f64) {
                return 0;
            }
            voxel[axis] = shifted as usize;
        }
        self.label(voxel)
    }

    fn label(&self, at: [usize; 3]) -> u32 {
        self.labels[self.number(at)]
    }

    fn number(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.size[0] * (j + self.size[1] * k)
    }

    /// No label within `reach` \[m\] of a place is smaller or larger than these; 0 is outside.
    pub(crate) fn range_around(&self, X: &Vector3, reach: f64) -> (u32, u32) {
        let (middle, mut is_within) = (self.index_of(X), true);
        let (mut first, mut last) = ([0; 3], [0; 3]);
        for axis in 0..3 {
            let reach = reach * self.to_index.row(axis).norm() + ROUND_OFF;
            let [low, high] = [-reach, reach].map(|way| middle[axis] + way + 0.5);
            let end = self.size[axis] as f64;
            is_within &= low >= 0.0 && high < end;
            if !(high >= 0.0 && low < end) {
                return (0, 0);
            }
            first[axis] = low.max(0.0) as usize;
            last[axis] = (high as usize).min(self.size[axis] - 1);
        }
        let (low, high) = self.blocks().within(first, last);
        if is_within { (low, high) } else { (0, high) }
    }

    /// The label at `X` if it is allowed, otherwise that of the nearest
    /// allowed voxel centre up to four voxels away; 0 if there is none.
    pub fn nearest_label_at(&self, X: &Vector3, allowed: &[u32]) -> u32 {
        let here = self.label_at(X);
        if allowed.contains(&here) {
            return here;
        }
        let middle = self.index_of(X).map(|c| c.round() as i64);
        let mut best = (f64::INFINITY, 0);
        for offset in 0..9_i64.pow(3) {
            let ijk = [offset % 9 - 4, offset / 9 % 9 - 4, offset / 81 - 4];
            let at: [i64; 3] = std::array::from_fn(|axis| middle[axis] + ijk[axis]);
            if (0..3).any(|axis| at[axis] < 0 || at[axis] >= self.size[axis] as i64) {
                continue;
            }
            let [i, j, k] = at.map(|c| c as usize);
            let distance = (self.centre(i, j, k) - X).norm();
            if distance < best.0 && allowed.contains(&self.label([i, j, k])) {
                best = (distance, self.label([i, j, k]));
            }
        }
        best.1
    }
}
