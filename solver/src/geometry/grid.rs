//! A scalar field on a regular grid, and distances on it.

use crate::tensor::Vector3;
use std::cmp::Ordering;

/// Samples on a regular grid, first index fastest. An axis with one sample is
/// an axis along which the field is constant.
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

    fn strides(&self) -> [usize; 3] {
        [1, self.size[0], self.size[0] * self.size[1]]
    }

    /// Position \[m\] of a sample from the first one.
    pub fn local(&self, index: usize) -> Vector3 {
        let (nx, ny) = (self.size[0], self.size[1]);
        let ijk = [index % nx, index / nx % ny, index / (nx * ny)];
        Vector3::from_fn(|axis, _| ijk[axis] as f64 * self.step[axis])
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

    /// Signed distance to the zero level of the field, negative where it is
    /// negative: exact crossings next to the level, the eikonal equation
    /// |∇φ| = 1 away from it.
    pub fn distance_to_zero_level(&self) -> ScalarGrid {
        let fixed: Vec<f64> = (0..self.values.len()).map(|at| self.crossing_distance(at)).collect();
        let mut distance = self.sweep(fixed);
        for (d, level) in distance.values.iter_mut().zip(&self.values) {
            if *level < 0.0 {
                *d = -*d;
            }
        }
        distance
    }

    /// Distance to the zero level of a sample next to it from the crossings
    /// d on the grid lines, 1/φ² = Σ 1/d²; infinite for other samples.
    fn crossing_distance(&self, at: usize) -> f64 {
        let value = self.values[at];
        let mut inverse = 0.0;
        for (axis, stride) in self.strides().into_iter().enumerate() {
            let position = at / stride % self.size[axis];
            let mut nearest = f64::INFINITY;
            let mut cross = |other: f64| {
                if (other < 0.0) != (value < 0.0) {
                    nearest = nearest.min(self.step[axis] * value / (value - other));
                }
            };
            if position > 0 {
                cross(self.values[at - stride]);
            }
            if position + 1 < self.size[axis] {
                cross(self.values[at + stride]);
            }
            inverse += 1.0 / (nearest * nearest);
        }
        if inverse > 0.0 { 1.0 / inverse.sqrt() } else { f64::INFINITY }
    }

    /// Solves |∇φ| = 1 from the finite `start` values, which stay: fast
    /// sweeping with the first-order upwind scheme (Zhao 2005).
    pub fn sweep(&self, start: Vec<f64>) -> ScalarGrid {
        let fixed: Vec<bool> = start.iter().map(|d| d.is_finite()).collect();
        let mut distance = ScalarGrid { size: self.size, step: self.step, values: start };
        let tolerance = 1e-6 * self.step.min();
        for _round in 0..4 {
            let mut change = 0.0_f64;
            for order in 0..8 {
                change = change.max(distance.one_sweep(order, &fixed));
            }
            if change < tolerance {
                break;
            }
        }
        distance
    }

    fn one_sweep(&mut self, order: usize, fixed: &[bool]) -> f64 {
        let [nx, ny, nz] = self.size;
        let turned = |i: usize, n: usize, axis: usize| {
            if order >> axis & 1 == 0 { i } else { n - 1 - i }
        };
        let mut change = 0.0_f64;
        for k in 0..nz {
            for j in 0..ny {
                let row = self.index(0, turned(j, ny, 1), turned(k, nz, 2));
                for i in 0..nx {
                    let at = row + turned(i, nx, 0);
                    if !fixed[at] {
                        let updated = self.upwind(at);
                        if updated < self.values[at] {
                            change = change.max(self.values[at] - updated);
                            self.values[at] = updated;
                        }
                    }
                }
            }
        }
        change
    }

    /// Smallest φ with Σ ((φ − a)/h)² = 1 over the axes with a < φ.
    fn upwind(&self, at: usize) -> f64 {
        let mut axes = [(f64::INFINITY, 1.0); 3];
        for (axis, stride) in self.strides().into_iter().enumerate() {
            let position = at / stride % self.size[axis];
            let mut a = f64::INFINITY;
            if position > 0 {
                a = a.min(self.values[at - stride]);
            }
            if position + 1 < self.size[axis] {
                a = a.min(self.values[at + stride]);
            }
            axes[axis] = (a, self.step[axis]);
        }
        axes.sort_by(|p, q| p.0.partial_cmp(&q.0).unwrap_or(Ordering::Equal));
        let mut phi = axes[0].0 + axes[0].1;
        let (mut s0, mut s1, mut s2) = (0.0, 0.0, -1.0);
        for (n, (a, h)) in axes.into_iter().enumerate() {
            if a.is_infinite() || (n > 0 && phi <= a) {
                break;
            }
            let w = 1.0 / (h * h);
            (s0, s1, s2) = (s0 + w, s1 + w * a, s2 + w * a * a);
            phi = (s1 + (s1 * s1 - s0 * s2).max(0.0).sqrt()) / s0;
        }
        phi
    }
}
