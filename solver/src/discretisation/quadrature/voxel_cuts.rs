//! Cells cut along the voxels of a label map (method book, section 7).
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::quadrature::cell::{Cell, in_plane};
use crate::geometry::{LabelMap, Selector, indices};
use crate::problem::Region;
use std::sync::Arc;

/// Directions of a map that are turned by no more than this lie along the grid \[rad\].
const ALONG: f64 = 1e-9;
/// Thinner slices are round-off \[cell\].
const ROUND_OFF: f64 = 1e-9;
/// Cells with more voxels are halved instead.
const MOST_BOXES: usize = 4096;

/// The label map that alone tells the regions of a body apart, if its voxels lie along the grid.
#[derive(Clone, Copy)]
pub(super) struct VoxelCuts<'a> {
    map: &'a LabelMap,
    /// The index of the map that runs along each axis.
    along: [usize; 3],
    components: usize,
}

/// The part of a cell in one voxel.
pub(super) struct VoxelBox {
    pub centre: Vector3,
    /// Along the axes \[m\].
    pub edges: Vector3,
    /// Area in a plane \[m³, m²\].
    pub size: f64,
    pub spread: Matrix3,
}

impl<'a> VoxelCuts<'a> {
    /// `None` where anything but voxels bounds a region.
    pub fn of(regions: &'a [Region], components: usize) -> Option<VoxelCuts<'a>> {
        let mut maps = Vec::new();
        if !regions.iter().all(|region| is_of_voxels(&region.part, &mut maps)) {
            return None;
        }
        let [map] = maps[..] else { return None };
        let step = map.voxel();
        let runs = |axis: usize| {
            (0..3).find(|&k| map.directions[(axis, k)].abs() >= (1.0 - ALONG) * step[k])
        };
        Some(VoxelCuts { map, along: [runs(0)?, runs(1)?, runs(2)?], components })
    }

    /// The boxes into which the voxels divide a cell; `None` where they are too many.
    pub fn boxes(&self, cell: &Cell) -> Option<Vec<VoxelBox>> {
        let cuts: Vec<Vec<f64>> = (0..self.components).map(|axis| self.cuts(cell, axis)).collect();
        let counts = [0, 1, 2].map(|axis| cuts.get(axis).map_or(1, |cuts| cuts.len() - 1));
        if counts.iter().product::<usize>() > MOST_BOXES {
            return None;
        }
        let at = |index: [usize; 3]| {
            let (mut centre, mut edges) = (cell.centre, Vector3::zeros());
            let (mut size, mut spread) = (1.0, Matrix3::zeros());
            for (axis, cuts) in cuts.iter().enumerate() {
                let (low, high) = (cuts[index[axis]], cuts[index[axis] + 1]);
                centre[axis] += 0.5 * (low + high);
                edges[axis] = high - low;
                size *= high - low;
                spread[(axis, axis)] = (high - low).powi(2) / 12.0;
            }
            VoxelBox { centre, edges, size, spread: in_plane(spread, self.components) }
        };
        Some(indices(counts).map(at).collect())
    }

    /// The ends of a cell along an axis and what voxels end between, from its centre \[m\].
    fn cuts(&self, cell: &Cell, axis: usize) -> Vec<f64> {
        let half = 0.5 * cell.edge;
        let step = self.map.directions[(axis, self.along[axis])].abs();
        let first_face = self.map.origin[axis] - 0.5 * step - cell.centre[axis];
        let mut cuts = vec![-half];
        let (mut n, thin) = (((-half - first_face) / step).ceil(), ROUND_OFF * cell.edge);
        while first_face + n * step < half - thin {
            let face = first_face + n * step;
            if face > -half + thin {
                cuts.push(face);
            }
            n += 1.0;
        }
        cuts.push(half);
        cuts
    }
}

/// Whether a part is made of labels alone, whose map is added.
fn is_of_voxels<'a>(part: &'a Selector, maps: &mut Vec<&'a LabelMap>) -> bool {
    match part {
        Selector::All => true,
        Selector::Label { map, .. } => {
            let map = Arc::as_ref(map);
            if !maps.iter().any(|known| std::ptr::eq(*known, map)) {
                maps.push(map);
            }
            true
        }
        Selector::Union(parts) | Selector::Intersection(parts) => {
            parts.iter().all(|part| is_of_voxels(part, maps))
        }
        Selector::Not(part) => is_of_voxels(part, maps),
        Selector::Plane { .. } | Selector::Inside { .. } | Selector::Facing { .. } => false,
    }
}
