//! Tetrahedra or triangles that share vertices.
#![allow(non_snake_case)]

use mtled::algebra::tensor::Vector3;
use rayon::prelude::*;

/// Tetrahedra in space or triangles in a plane, all of positive measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Corners of a cell: 4 of a tetrahedron, 3 of a triangle.
    pub corners: usize,
    /// Reference positions \[m\].
    pub vertices: Vec<Vector3>,
    /// Vertices of the cells, one cell after the other.
    pub cells: Vec<u32>,
    /// Region of each cell.
    pub regions: Vec<u16>,
}

impl Mesh {
    /// Without vertices and cells.
    pub(crate) fn empty(corners: usize) -> Mesh {
        Mesh { corners, vertices: Vec::new(), cells: Vec::new(), regions: Vec::new() }
    }

    /// The cells, each by its vertices.
    pub(crate) fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.cells.chunks_exact(self.corners)
    }

    /// Number of cells.
    pub(crate) fn len(&self) -> usize {
        self.cells.len() / self.corners
    }

    /// Whether there are no cells.
    pub(crate) fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// A cell by its vertices.
    pub(crate) fn cell(&self, index: usize) -> &[u32] {
        &self.cells[self.corners * index..self.corners * (index + 1)]
    }

    /// Volume \[m³\], in a plane area \[m²\]; negative where the cell is turned inside out.
    pub fn measure(&self, cell: &[u32]) -> f64 {
        let X = |corner: usize| &self.vertices[cell[corner] as usize];
        let (a, b) = (X(1) - X(0), X(2) - X(0));
        match self.corners {
            3 => 0.5 * (a.x * b.y - a.y * b.x),
            _ => a.cross(&b).dot(&(X(3) - X(0))) / 6.0,
        }
    }

    /// Volume \[m³\] or area \[m²\] of all cells.
    pub(crate) fn volume(&self) -> f64 {
        self.iter().map(|cell| self.measure(cell)).sum()
    }

    /// Mean of the corners of a cell \[m\].
    pub(crate) fn centre(&self, cell: &[u32]) -> Vector3 {
        let sum: Vector3 = cell.iter().map(|&n| self.vertices[n as usize]).sum();
        sum / cell.len() as f64
    }

    /// Sides that belong to one cell only, anticlockwise seen from outside: triangles, in a plane
    /// edges with the body on their left; each with the number of its cell.
    pub(crate) fn boundary(&self) -> Vec<(Vec<u32>, usize)> {
        let mut sides: Vec<([u32; 3], u32, u32)> = Vec::with_capacity(self.cells.len());
        for (index, cell) in self.iter().enumerate() {
            for (number, side) in SIDES[self.corners - 3].iter().take(self.corners).enumerate() {
                let mut key = [u32::MAX; 3];
                let corners = side.iter().take(self.corners - 1);
                key.iter_mut().zip(corners).for_each(|(key, &corner)| *key = cell[corner]);
                key.sort_unstable();
                sides.push((key, index as u32, number as u32));
            }
        }
        sides.par_sort_unstable();
        let single = sides.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1);
        let side = |&(_, cell, number): &([u32; 3], u32, u32)| {
            let side = &SIDES[self.corners - 3][number as usize][..self.corners - 1];
            let cell = cell as usize;
            (side.iter().map(|&corner| self.cell(cell)[corner]).collect(), cell)
        };
        single.flatten().map(side).collect()
    }

    /// The cells around each vertex.
    pub(crate) fn cells_around(&self) -> CellsAround {
        let mut starts = vec![0; self.vertices.len() + 1];
        for &vertex in &self.cells {
            starts[vertex as usize + 1] += 1;
        }
        for n in 1..starts.len() {
            starts[n] += starts[n - 1];
        }
        let (mut next, mut cells) = (starts.clone(), vec![0; self.cells.len()]);
        for (place, &vertex) in self.cells.iter().enumerate() {
            cells[next[vertex as usize]] = (place / self.corners) as u32;
            next[vertex as usize] += 1;
        }
        CellsAround { starts, cells }
    }

    /// Takes away the vertices that no cell has, and says which are left.
    pub(crate) fn drop_unused_vertices(&mut self) -> Vec<u32> {
        let mut used = vec![false; self.vertices.len()];
        self.cells.iter().for_each(|&vertex| used[vertex as usize] = true);
        let mut number = vec![0; used.len()];
        let mut kept = Vec::new();
        for (vertex, _) in used.iter().enumerate().filter(|(_, used)| **used) {
            number[vertex] = kept.len() as u32;
            kept.push(vertex as u32);
        }
        self.cells.iter_mut().for_each(|vertex| *vertex = number[*vertex as usize]);
        self.vertices = kept.iter().map(|&vertex| self.vertices[vertex as usize]).collect();
        kept
    }
}

/// The sides of triangles and of tetrahedra that are not turned inside out, facing outwards; edges
/// have two corners and triangles have three of them.
const SIDES: [[[usize; 3]; 4]; 2] =
    [[[0, 1, 3], [1, 2, 3], [2, 0, 3], [3, 3, 3]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]];

/// The cells around vertices.
pub(crate) struct CellsAround {
    starts: Vec<usize>,
    cells: Vec<u32>,
}

impl CellsAround {
    /// Those of a vertex.
    pub(crate) fn of(&self, vertex: usize) -> &[u32] {
        &self.cells[self.starts[vertex]..self.starts[vertex + 1]]
    }
}
