//! A cell of the background grid.

use crate::algebra::tensor::{Matrix3, Vector3};

/// A grid that fits but for this fraction of a cell gets no other layer: a body may be that much
/// larger by round-off, far from the origin or turned \[–\].
const FITS: f64 = 1e-6;

/// A square or cube of the grid.
#[derive(Clone, Copy)]
pub(super) struct Cell {
    pub centre: Vector3,
    pub edge: f64,
}

impl Cell {
    /// n parts per direction.
    pub fn divide(self, n: usize, components: usize) -> impl Iterator<Item = Cell> {
        let edge = self.edge / n as f64;
        let at = move |i: usize| (i as f64 + 0.5 - 0.5 * n as f64) * edge;
        let (layers, solid) = if components == 3 { (n, 1.0) } else { (1, 0.0) };
        (0..n * n * layers).map(move |part| {
            let shift = Vector3::new(at(part % n), at(part / n % n), solid * at(part / (n * n)));
            Cell { centre: self.centre + shift, edge }
        })
    }

    /// Halves along each direction.
    pub fn children(self, components: usize) -> impl Iterator<Item = Cell> {
        self.divide(2, components)
    }

    /// Bit n of the number of a corner is axis n.
    pub fn corners(self, components: usize) -> impl Iterator<Item = Vector3> {
        let twice = Cell { centre: self.centre, edge: 2.0 * self.edge };
        twice.children(components).map(|child| child.centre)
    }

    /// Centre and corners, the corners moved inwards slightly so that neighbours
    /// along a shared face do not claim each other's region.
    pub fn samples(self, components: usize) -> impl Iterator<Item = Vector3> {
        let corner = Cell { centre: self.centre, edge: 2.0 * self.edge * (1.0 - 1e-6) };
        corner.children(components).map(|child| child.centre).chain([self.centre])
    }

    /// \[m\]
    pub fn half_diagonal(&self, components: usize) -> f64 {
        0.5 * self.edge * (components as f64).sqrt()
    }

    /// Second moments of the whole about its centre over its volume \[m²\].
    pub fn spread(&self, components: usize) -> Matrix3 {
        in_plane(Matrix3::from_diagonal_element(self.edge * self.edge / 12.0), components)
    }
}

/// The largest cells of a grid, around the middle of a body.
pub(super) struct Cells {
    middle: Vector3,
    edge: f64,
    /// Along each axis; 1 across a plane.
    pub counts: [f64; 3],
}

impl Cells {
    /// In a plane the middle lies in it, at `z` \[m\].
    pub fn over((min, max): (Vector3, Vector3), edge: f64, components: usize, z: f64) -> Cells {
        let mut middle = (min + max) * 0.5;
        if components == 2 {
            middle.z = z;
        }
        let along = |k: usize| ((max[k] - min[k]) / edge - FITS).ceil().max(1.0);
        let counts = [0, 1, 2].map(|k| if k < components { along(k) } else { 1.0 });
        Cells { middle, edge, counts }
    }

    /// As `counts`.
    pub fn size(&self) -> [usize; 3] {
        self.counts.map(|count| count as usize)
    }

    /// The cell with these numbers along the axes.
    pub fn at(&self, index: [usize; 3]) -> Cell {
        let mut centre = self.middle;
        for axis in 0..3 {
            centre[axis] += self.edge * (index[axis] as f64 + 0.5 - 0.5 * self.counts[axis]);
        }
        Cell { centre, edge: self.edge }
    }
}

/// Nothing is spread across a plane.
pub(super) fn in_plane(mut spread: Matrix3, components: usize) -> Matrix3 {
    if components == 2 {
        spread.row_mut(2).fill(0.0);
        spread.column_mut(2).fill(0.0);
    }
    spread
}
