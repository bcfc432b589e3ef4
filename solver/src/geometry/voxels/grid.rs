//! A scalar field on a regular grid.

use crate::algebra::tensor::Vector3;

/// Samples on a regular grid, first index fastest. Along an axis with one
/// sample the field is constant.
#[derive(Debug, Clone)]
pub(crate) struct ScalarGrid {
    pub size: [usize; 3],
    /// Distance of neighbouring samples per axis \[m\].
    pub step: Vector3,
    pub values: Vec<f64>,
}

impl ScalarGrid {
    pub fn index(&self, i: usize, j: usize, k: usize) -> usize {
        i + self.size[0] * (j + self.size[1] * k)
    }

    pub(super) fn strides(&self) -> [usize; 3] {
        [1, self.size[0], self.size[0] * self.size[1]]
    }

    /// Position \[m\] of a sample from the first one.
    pub fn local(&self, index: usize) -> Vector3 {
        self.position(self.indices_of(index))
    }

    pub(super) fn position(&self, ijk: [usize; 3]) -> Vector3 {
        Vector3::from_fn(|axis, _| ijk[axis] as f64 * self.step[axis])
    }

    pub(super) fn indices_of(&self, index: usize) -> [usize; 3] {
        let (nx, ny) = (self.size[0], self.size[1]);
        [index % nx, index / nx % ny, index / (nx * ny)]
    }

    /// Trilinear value at `local` \[m\] from the first sample; outside the
    /// grid the value on its border plus the distance to it.
    pub fn sample(&self, local: &Vector3) -> f64 {
        let mut outside = 0.0;
        let mut cell = [0; 3];
        let mut next = [0; 3];
        let mut fraction = [0.0; 3];
        let strides = self.strides();
        for axis in 0..3 {
            let last = self.size[axis] - 1;
            if last == 0 {
                continue;
            }
            let t = local[axis] / self.step[axis];
            let inside = t.clamp(0.0, last as f64);
            outside += ((t - inside) * self.step[axis]).powi(2);
            let low = (inside as usize).min(last - 1);
            (cell[axis], next[axis]) = (low * strides[axis], strides[axis]);
            fraction[axis] = inside - low as f64;
        }
        let base = cell[0] + cell[1] + cell[2];
        let along_x = |at: usize| {
            self.values[at] * (1.0 - fraction[0]) + self.values[at + next[0]] * fraction[0]
        };
        let in_plane =
            |at: usize| along_x(at) * (1.0 - fraction[1]) + along_x(at + next[1]) * fraction[1];
        let value = in_plane(base) * (1.0 - fraction[2]) + in_plane(base + next[2]) * fraction[2];
        value + outside.sqrt()
    }
}

/// All index triples below `size`, the first index fastest.
pub(crate) fn indices(size: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = size;
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
}
