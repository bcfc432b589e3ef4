//! The cells of a regular lattice that may have a part of a solid inside.
#![allow(non_snake_case)]

use super::mesh::Mesh;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::Shape;
use rayon::prelude::*;
use std::collections::HashMap;

/// Boxes along an edge of a block that is judged as a whole.
const BLOCK: usize = 4;
/// Distances of label maps may be wrong by this factor \[–\].
const CARE: f64 = 1.5;

/// How far inside of a side of the lattice the level is taken there, over its step \[–\].
const INSET: f64 = 0.02;

/// Paths from corner 0 to corner 7 of a box; bit n of a corner is axis n. Neighbours cut the sides
/// that they share alike.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];
/// The same in a plane.
const TRIANGLES: [[usize; 3]; 2] = [[0, 1, 3], [0, 3, 2]];

/// A lattice over the bounding box of a solid, whose sides are planes of the lattice: a box has
/// exact faces.
#[derive(Debug, Clone)]
pub(crate) struct Lattice {
    lower: Vector3,
    step: Vector3,
    /// Boxes along each axis; 0 across a plane.
    count: [usize; 3],
}

impl Lattice {
    /// A lattice with steps of about `edge` \[m\] between two corners; flat where they have the
    /// same z.
    pub(crate) fn new(lower: Vector3, upper: Vector3, edge: f64) -> Lattice {
        let extent = upper - lower;
        let plane = extent.z <= 0.0;
        let count: [usize; 3] = std::array::from_fn(|axis| match axis {
            2 if plane => 0,
            _ => ((extent[axis] / edge).round() as usize).max(2),
        });
        let step = Vector3::from_fn(|axis, _| extent[axis] / count[axis].max(1) as f64);
        Lattice { lower, step, count }
    }

    /// Number of its boxes, near the solid or not.
    pub(crate) fn boxes(lower: &Vector3, upper: &Vector3, edge: f64) -> f64 {
        let axes = (upper - lower).map(|extent| (extent / edge).round().max(2.0));
        if upper.z <= lower.z { axes.x * axes.y } else { axes.product() }
    }

    fn is_plane(&self) -> bool {
        self.count[2] == 0
    }

    /// Corners of a cell.
    fn corners(&self) -> usize {
        if self.is_plane() { 3 } else { 4 }
    }

    fn at(&self, index: [usize; 3]) -> Vector3 {
        self.lower + self.step.component_mul(&Vector3::from(index.map(|n| n as f64)))
    }

    /// Volume \[m³\] or area \[m²\] of a cell.
    pub(crate) fn cell_measure(&self) -> f64 {
        if self.is_plane() { self.step.x * self.step.y / 2.0 } else { self.step.product() / 6.0 }
    }

    /// A bit for each side of the lattice that a vertex of it is on.
    pub(crate) fn sides(&self, X: &Vector3) -> u8 {
        let (low, high) = (self.lower, self.at(self.count));
        let axes = if self.is_plane() { 0..2 } else { 0..3 };
        axes.map(|k| u8::from(X[k] == low[k]) << k | u8::from(X[k] == high[k]) << (k + 3)).sum()
    }

    /// Signed distance \[m\] with faces of the solid that lie on sides of the lattice a little
    /// inside of it: where such a face ends, the level changes its sign along the side.
    pub(crate) fn level(&self, shape: &Shape, X: &Vector3) -> f64 {
        let inset = INSET * self.step;
        let (low, high) = (self.lower + inset, self.at(self.count) - inset);
        shape.signed_distance(&X.sup(&low).inf(&high))
    }

    /// The cells of the blocks that may have a part of the solid inside, with the level of each
    /// vertex \[m\]; cells without a vertex inside are left out.
    pub(crate) fn cells(&self, shape: &Shape) -> (Mesh, Vec<f64>) {
        let blocks = self.count.map(|n| n.div_ceil(BLOCK).max(1));
        let near: Vec<[usize; 3]> = (0..blocks.iter().product::<usize>())
            .into_par_iter()
            .map(|n| [n % blocks[0], n / blocks[0] % blocks[1], n / (blocks[0] * blocks[1])])
            .filter(|block| self.may_have_a_part(shape, block))
            .collect();
        let mut numbers = HashMap::new();
        let mut places = Vec::new();
        let boxes: Vec<[u32; 8]> = near
            .iter()
            .flat_map(|block| self.boxes_of(block))
            .map(|at| self.numbered(at, &mut numbers, &mut places))
            .collect();
        let vertices: Vec<Vector3> = places.into_iter().map(|index| self.at(index)).collect();
        // What round-off leaves on a face is on the face.
        let zero = 1e-9 * self.step.iter().copied().filter(|h| *h > 0.0).fold(f64::MAX, f64::min);
        let distance = |X: &Vector3| match self.level(shape, X) {
            d if d.abs() <= zero => 0.0,
            d => d,
        };
        let values: Vec<f64> = vertices.par_iter().map(distance).collect();
        let mut mesh = Mesh { vertices, ..Mesh::empty(self.corners()) };
        for numbers in boxes {
            self.cut_box(&numbers, &values, &mut mesh.cells);
        }
        mesh.regions = vec![0; mesh.len()];
        let values = mesh.drop_unused_vertices().iter().map(|&n| values[n as usize]).collect();
        (mesh, values)
    }

    fn may_have_a_part(&self, shape: &Shape, block: &[usize; 3]) -> bool {
        let low = self.at(block.map(|n| n * BLOCK));
        let edge = self.step * BLOCK as f64;
        shape.signed_distance(&(low + 0.5 * edge)) <= CARE * 0.5 * edge.norm()
    }

    /// Lowest corners of the boxes of a block.
    fn boxes_of(&self, block: &[usize; 3]) -> Vec<[usize; 3]> {
        let range = |axis: usize| {
            let from = block[axis] * BLOCK;
            from..(from + BLOCK).min(self.count[axis].max(usize::from(axis == 2)))
        };
        let mut boxes = Vec::with_capacity(BLOCK.pow(3));
        for k in range(2) {
            for j in range(1) {
                boxes.extend(range(0).map(|i| [i, j, k]));
            }
        }
        boxes
    }

    /// Numbers of the corners of a box, those across a plane as those in it.
    fn numbered(
        &self,
        at: [usize; 3],
        numbers: &mut HashMap<[usize; 3], u32>,
        places: &mut Vec<[usize; 3]>,
    ) -> [u32; 8] {
        let up = usize::from(!self.is_plane());
        std::array::from_fn(|c| {
            let place = [at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2) * up];
            *numbers.entry(place).or_insert_with(|| {
                places.push(place);
                places.len() as u32 - 1
            })
        })
    }

    /// Appends the cells of a box that have a vertex inside, or all vertices on the boundary.
    fn cut_box(&self, numbers: &[u32; 8], values: &[f64], cells: &mut Vec<u32>) {
        let mut push = |path: &[usize]| {
            let corners = path.iter().map(|&c| numbers[c]);
            let value = |n: u32| values[n as usize];
            if corners.clone().any(|n| value(n) < 0.0) || corners.clone().all(|n| value(n) == 0.0) {
                cells.extend(corners);
            }
        };
        if self.is_plane() {
            TRIANGLES.iter().for_each(|path| push(path))
        } else {
            TETRAHEDRA.iter().for_each(|path| push(path))
        }
    }
}
