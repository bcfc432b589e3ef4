//! Nested lattices of quadratic B-splines over the box around the nodes.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Vector3, bounding_box};

/// Functions along one axis of a lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Axis {
    /// No extent: one constant.
    Flat,
    /// 1 and s − ½ over the whole extent, s from 0 to 1.
    Affine,
    /// Quadratic B-splines on this many cells; function i is supported on the
    /// cells i − 2 to i.
    Splines(usize),
}

/// Products of functions along the axes of the box around the nodes. An axis
/// that cannot be halved further gets affine functions, so that the lattice
/// represents the long waves of slender bodies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lattice {
    origin: Vector3,
    extent: Vector3,
    axes: [Axis; 3],
    counts: [usize; 3],
}

impl Axis {
    /// Cells of about `edge` whose number can be halved down to 1 or 3.
    fn new(extent: f64, edge: f64) -> Axis {
        let n = (extent / edge).ceil().max(1.0) as usize;
        let power = n.next_power_of_two();
        let fits = power >= 4 && n <= 3 * power / 4;
        Axis::Splines(if fits { 3 * power / 4 } else { power })
    }

    fn count(self) -> usize {
        match self {
            Axis::Flat => 1,
            Axis::Affine => 2,
            Axis::Splines(cells) => cells + 2,
        }
    }

    fn coarser(self) -> Axis {
        match self {
            Axis::Splines(cells) if cells.is_multiple_of(2) => Axis::Splines(cells / 2),
            Axis::Splines(_) => Axis::Affine,
            axis => axis,
        }
    }

    /// First of up to three functions at s in \[0, 1\], and their values.
    fn at(self, s: f64) -> (usize, [f64; 3]) {
        match self {
            Axis::Flat => (0, [1.0, 0.0, 0.0]),
            Axis::Affine => (0, [1.0, s - 0.5, 0.0]),
            Axis::Splines(cells) => {
                let (index, t) = cell(s, cells);
                (index, [0.5 * (1.0 - t) * (1.0 - t), 0.5 + t * (1.0 - t), 0.5 * t * t])
            }
        }
    }

    /// Derivatives of the same functions by s.
    fn slopes(self, s: f64) -> [f64; 3] {
        match self {
            Axis::Flat => [0.0; 3],
            Axis::Affine => [0.0, 1.0, 0.0],
            Axis::Splines(cells) => {
                let t = cell(s, cells).1;
                [t - 1.0, 1.0 - 2.0 * t, t].map(|slope| slope * cells as f64)
            }
        }
    }

    /// Function `index` of the coarser axis as a sum of functions of this one:
    /// (1, 3, 3, 1)/4 for halved splines, values at the middles of the
    /// splines for affine functions.
    fn parts(self, index: usize) -> Vec<(usize, f64)> {
        match (self, self.coarser()) {
            (Axis::Splines(cells), Axis::Splines(_)) => {
                let fine = |m: usize| (2 * index + m).checked_sub(2).filter(|&i| i < cells + 2);
                (0..4).filter_map(|m| fine(m).map(|i| (i, [0.25, 0.75, 0.75, 0.25][m]))).collect()
            }
            (Axis::Splines(cells), _) => (0..cells + 2)
                .map(|i| match index {
                    0 => (i, 1.0),
                    _ => (i, (i as f64 - 0.5) / cells as f64 - 0.5),
                })
                .collect(),
            _ => vec![(index, 1.0)],
        }
    }
}

/// The cell of s in \[0, 1\], and the place in it.
fn cell(s: f64, cells: usize) -> (usize, f64) {
    let x = s * cells as f64;
    let index = (x.max(0.0) as usize).min(cells - 1);
    (index, (x - index as f64).clamp(0.0, 1.0))
}

impl Lattice {
    /// With cells of about `edge` whose number can be halved.
    pub fn new(nodes: &[Vector3], edge: f64, components: usize) -> Lattice {
        Lattice::of_axes(nodes, components, |extent| Axis::new(extent, edge))
    }

    /// With as few cells as are at most as wide as `edge`.
    pub fn of_cells(nodes: &[Vector3], edge: f64, components: usize) -> Lattice {
        let axis = |extent: f64| Axis::Splines((extent / edge).ceil().max(1.0) as usize);
        Lattice::of_axes(nodes, components, axis)
    }

    fn of_axes(nodes: &[Vector3], components: usize, axis: impl Fn(f64) -> Axis) -> Lattice {
        let (min, max) = bounding_box(nodes);
        let extent = max - min;
        let axes = [0, 1, 2].map(|k| if k < components { axis(extent[k]) } else { Axis::Flat });
        Lattice { origin: min, extent, axes, counts: axes.map(Axis::count) }
    }

    pub fn len(&self) -> usize {
        self.counts.iter().product()
    }

    pub fn coarser(&self) -> Lattice {
        let axes = self.axes.map(Axis::coarser);
        Lattice { axes, counts: axes.map(Axis::count), ..*self }
    }

    /// Whether only affine functions are left, the kernel of the operator.
    pub fn is_affine(&self) -> bool {
        !self.axes.iter().any(|axis| matches!(axis, Axis::Splines(_)))
    }

    /// The functions that may not be 0 at X.
    pub fn at(&self, X: &Vector3) -> Reach {
        let [(i, x), (j, y), (k, z)] =
            [0, 1, 2].map(|axis| self.axes[axis].at(self.place(axis, X)));
        let counts = self.counts.map(|n| n.min(3));
        Reach { first: [i, j, k], counts, size: self.counts, values: [x, y, z] }
    }

    /// Gradients \[1/m\] of the functions that may not be 0 at X, in the order of
    /// [`Reach::for_each`].
    pub fn gradients(&self, X: &Vector3) -> impl Iterator<Item = Vector3> {
        let place = [0, 1, 2].map(|axis| self.place(axis, X));
        let values = [0, 1, 2].map(|axis| self.axes[axis].at(place[axis]).1);
        let slopes = [0, 1, 2].map(|axis| {
            let over = if self.extent[axis] > 0.0 { 1.0 / self.extent[axis] } else { 0.0 };
            self.axes[axis].slopes(place[axis]).map(|slope| slope * over)
        });
        let [nx, ny, nz] = self.counts.map(|n| n.min(3));
        (0..nx * ny * nz).map(move |function| {
            let at = [function % nx, function / nx % ny, function / (nx * ny)];
            let factor = |axis: usize, along: usize| {
                if axis == along { slopes[axis][at[axis]] } else { values[axis][at[axis]] }
            };
            let along = |k: usize| factor(0, k) * factor(1, k) * factor(2, k);
            Vector3::new(along(0), along(1), along(2))
        })
    }

    /// The part of a cell that holds X, `parts` along each axis of a cell.
    pub fn subcell(&self, X: &Vector3, parts: f64) -> [u32; 3] {
        [0, 1, 2].map(|axis| match self.axes[axis] {
            Axis::Flat => 0,
            Axis::Affine => (self.place(axis, X) * parts) as u32,
            Axis::Splines(cells) => (self.place(axis, X) * cells as f64 * parts) as u32,
        })
    }

    /// s of X along an axis.
    fn place(&self, axis: usize, X: &Vector3) -> f64 {
        (X[axis] - self.origin[axis]) / self.extent[axis]
    }

    /// Along which axes a function is s − ½, as bits: functions of one kind
    /// bend alike.
    pub fn kind(&self, index: [usize; 3]) -> usize {
        (0..3).filter(|&k| self.axes[k] == Axis::Affine && index[k] == 1).map(|k| 1 << k).sum()
    }

    /// Indices of a function along the axes.
    pub fn index(&self, function: usize) -> [usize; 3] {
        let [nx, ny, _] = self.counts;
        [function % nx, function / nx % ny, function / (nx * ny)]
    }

    /// Calls `visit(coarse, fine, factor)` for all pairs with the next coarser
    /// lattice.
    pub fn for_each_transfer(&self, mut visit: impl FnMut(usize, usize, f64)) {
        let coarse = self.coarser();
        let parts = |axis: usize| -> Vec<Vec<(usize, f64)>> {
            (0..coarse.counts[axis]).map(|index| self.axes[axis].parts(index)).collect()
        };
        let [columns, rows, layers] = [parts(0), parts(1), parts(2)];
        let mut target = 0;
        for layer in &layers {
            for row in &rows {
                for column in &columns {
                    for &(k, wz) in layer {
                        for &(j, wy) in row {
                            let start = (k * self.counts[1] + j) * self.counts[0];
                            for &(i, wx) in column {
                                visit(target, start + i, wx * wy * wz);
                            }
                        }
                    }
                    target += 1;
                }
            }
        }
    }
}

/// Up to three functions along each axis, and their values.
pub(crate) struct Reach {
    pub first: [usize; 3],
    pub counts: [usize; 3],
    /// Functions along the axes of the box that `first` counts in.
    size: [usize; 3],
    values: [[f64; 3]; 3],
}

impl Reach {
    /// The same functions in the box that starts at `origin` and holds `size`.
    pub fn within(&self, origin: [usize; 3], size: [usize; 3]) -> Reach {
        let first = [0, 1, 2].map(|axis| self.first[axis] - origin[axis]);
        Reach { first, size, ..*self }
    }

    /// Calls `visit(place in the box, value)`.
    #[inline]
    pub fn for_each(&self, mut visit: impl FnMut(usize, f64)) {
        let ([x, y, z], [i, j, k]) = (&self.values, self.first);
        for (c, wz) in z[..self.counts[2]].iter().enumerate() {
            for (b, wy) in y[..self.counts[1]].iter().enumerate() {
                let row = ((k + c) * self.size[1] + j + b) * self.size[0] + i;
                for (a, wx) in x[..self.counts[0]].iter().enumerate() {
                    visit(row + a, wx * (wy * wz));
                }
            }
        }
    }
}
