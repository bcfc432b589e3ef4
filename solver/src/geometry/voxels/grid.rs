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

/// The cell along an axis in which a position \[sample\] is, and its fraction.
fn cell_along(t: f64) -> (usize, f64) {
    let low = t as usize;
    (low, t - low as f64)
}

impl ScalarGrid {
    /// The trilinear value, and its differences over half a sample about `local` along each axis.
    pub(super) fn value_and_slope(&self, local: &Vector3) -> (f64, Vector3) {
        const ASIDE: f64 = 0.25;
        let at = local.component_div(&self.step);
        let is_deep =
            |axis: usize| at[axis] >= ASIDE && at[axis] + ASIDE < self.size[axis] as f64 - 1.0;
        if !(0..3).all(is_deep) {
            let slope = Vector3::from_fn(|axis, _| {
                let aside = Vector3::ith(axis, ASIDE * self.step[axis]);
                let rise = self.sample(&(local + aside)) - self.sample(&(local - aside));
                rise / (2.0 * ASIDE * self.step[axis])
            });
            return (self.sample(local), slope);
        }
        let strides = self.strides();
        let cells = [0, 1, 2].map(|axis| cell_along(at[axis]));
        let base: usize = (0..3).map(|axis| cells[axis].0 * strides[axis]).sum();
        let mut slope = Vector3::zeros();
        let mut value = 0.0;
        for axis in 0..3 {
            let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
            let (fa, fb) = (cells[a].1, cells[b].1);
            // Bilinear in the layer across the axis that holds a sample.
            let layer = |at: usize| {
                let row =
                    |at: usize| self.values[at] * (1.0 - fa) + self.values[at + strides[a]] * fa;
                row(at) * (1.0 - fb) + row(at + strides[b]) * fb
            };
            let (low, f) = cells[axis];
            let (here, next) = (layer(base), layer(base + strides[axis]));
            let along = |t: f64| {
                let (cell, f) = cell_along(t);
                let (low, high) = match cell {
                    cell if cell < low => (layer(base - strides[axis]), here),
                    cell if cell > low => (next, layer(base + 2 * strides[axis])),
                    _ => (here, next),
                };
                low * (1.0 - f) + high * f
            };
            let rise = along(at[axis] + ASIDE) - along(at[axis] - ASIDE);
            slope[axis] = rise / (2.0 * ASIDE * self.step[axis]);
            value = here * (1.0 - f) + next * f;
        }
        (value, slope)
    }
}

/// All index triples below `size`, the first index fastest.
pub(crate) fn indices(size: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = size;
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
}
