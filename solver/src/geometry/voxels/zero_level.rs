//! Signed distances to the zero level of a field on a grid.

use crate::algebra::tensor::Vector3;
use crate::geometry::voxels::grid::{ScalarGrid, indices};
use crate::geometry::voxels::hand_on::KnownDistance;
use rayon::prelude::*;

/// Distances up to this are measured to the level itself \[sample\].
const NEAR: f64 = 4.0;
/// Farther away than this only every other sample hands on its foot \[sample\].
const BAND: f64 = 6.0;
/// Steps towards the nearest point of the level.
const CLOSER: usize = 8;
/// A point is on the level to this \[sample\].
const ON_LEVEL: f64 = 0.01;
/// A foot is the nearest one if it moves less than this to the level and along it \[sample\]:
/// the distance changes by half the square of the latter over itself.
const AT_REST: [f64; 2] = [0.001, 0.03];

impl ScalarGrid {
    /// Signed distance to the zero level of the field, negative where it is
    /// negative: from the crossings of grid lines next to the level, to the
    /// nearest of the feet of those samples away from it.
    pub fn distance_to_zero_level(&self) -> ScalarGrid {
        let rows = (0..self.size[1] * self.size[2]).into_par_iter();
        let known: Vec<KnownDistance> = rows.flat_map_iter(|row| self.known_in_row(row)).collect();
        let (mut values, feet) = self.hand_on(&known, BAND * self.step.max());
        let far = self.far_from_level(&values, &feet, &known);
        let near = NEAR * self.step.max();
        values.par_iter_mut().zip(feet).enumerate().for_each(|(at, (d, foot))| {
            if *d < near && known[foot as usize].at != at {
                *d = self.distance_to_level(&self.local(at), known[foot as usize].foot, *d);
            } else if d.is_infinite() {
                *d = far.at(self.indices_of(at));
            }
            *d *= self.sign(at);
        });
        ScalarGrid { size: self.size, step: self.step, values }
    }

    fn sign(&self, at: usize) -> f64 {
        if self.values[at] < 0.0 { -1.0 } else { 1.0 }
    }

    /// The samples of a row along the first index that lie next to the level.
    fn known_in_row(&self, row: usize) -> Vec<KnownDistance> {
        let [nx, ny, nz] = self.size;
        let ([_, by_row, by_layer], j, k) = (self.strides(), row % ny, row / ny);
        let mut known = Vec::new();
        for i in 0..nx {
            let at = row * nx + i;
            let inside = self.values[at] < 0.0;
            let differs =
                |is_there: bool, other: usize| is_there && (self.values[other] < 0.0) != inside;
            if differs(i > 0, at.wrapping_sub(1))
                || differs(i + 1 < nx, at + 1)
                || differs(j > 0, at.wrapping_sub(by_row))
                || differs(j + 1 < ny, at + by_row)
                || differs(k > 0, at.wrapping_sub(by_layer))
                || differs(k + 1 < nz, at + by_layer)
            {
                let distance = self.crossing_distance(at);
                let normal = self.slope(at).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
                let foot = self.local(at) - self.sign(at) * distance * normal;
                known.push(KnownDistance { at, distance, foot });
            }
        }
        known
    }

    /// Distances on every other sample from those within the band.
    fn far_from_level(&self, values: &[f64], feet: &[u32], known: &[KnownDistance]) -> Far {
        let size = self.size.map(|n| if n > 1 { n / 2 + 1 } else { 1 });
        let coarse = ScalarGrid { size, step: 2.0 * self.step, values: Vec::new() };
        let mut starts = Vec::new();
        for (at, ijk) in indices(size).enumerate() {
            let fine = ijk.map(|n| 2 * n);
            if (0..3).all(|axis| fine[axis] < self.size[axis]) {
                let [i, j, k] = fine;
                let here = self.index(i, j, k);
                if values[here].is_finite() {
                    let foot = known[feet[here] as usize].foot;
                    starts.push(KnownDistance { at, distance: values[here], foot });
                }
            }
        }
        let (distance, from) = coarse.hand_on(&starts, f64::INFINITY);
        let feet = from.iter().map(|&from| starts.get(from as usize).map(|s| s.foot));
        let feet = feet.map(|foot| foot.unwrap_or_else(Vector3::zeros)).collect();
        Far { grid: ScalarGrid { values: distance, ..coarse }, feet, step: self.step }
    }

    /// Distance to the zero level of the field by the iteration of Chopp 2001 (method book,
    /// section 4), from a `foot` near it and a distance that is too large.
    fn distance_to_level(&self, here: &Vector3, mut foot: Vector3, too_large: f64) -> f64 {
        let mut nearest = too_large;
        for _ in 0..CLOSER {
            let (value, g) = self.value_and_slope(&foot);
            let square = g.norm_squared();
            if square == 0.0 {
                break;
            }
            // Onto the level, then along it.
            foot -= g * (value / square);
            let way = here - foot;
            let level = self.sample(&foot).abs() / square.sqrt();
            if level < ON_LEVEL * self.step.min() {
                nearest = nearest.min(way.norm());
            }
            let along = way - g * (way.dot(&g) / square);
            let to_level = value.abs() / square.sqrt();
            let [to_level, along_it] = [to_level, along.norm()].map(|way| way / self.step.min());
            if to_level < AT_REST[0] && along_it < AT_REST[1] {
                break;
            }
            foot += along * (0.5 * self.step.min() / along.norm()).min(0.7);
        }
        nearest
    }

    /// Gradient by central differences, one-sided at the border.
    fn slope(&self, at: usize) -> Vector3 {
        let strides = self.strides();
        Vector3::from_fn(|axis, _| {
            let (stride, last) = (strides[axis], self.size[axis] - 1);
            let position = at / stride % self.size[axis];
            let low = if position > 0 { at - stride } else { at };
            let high = if position < last { at + stride } else { at };
            let steps = ((high - low) / stride).max(1) as f64;
            (self.values[high] - self.values[low]) / (steps * self.step[axis])
        })
    }

    /// Distance to the zero level of a sample next to it from the crossings
    /// d on the grid lines, 1/φ² = Σ 1/d² (method book, eq. 4.3); infinite for
    /// other samples.
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
}

/// Distances far from the level, on every other sample along each axis.
struct Far {
    grid: ScalarGrid,
    feet: Vec<Vector3>,
    /// Of the samples between \[m\].
    step: Vector3,
}

impl Far {
    /// The distance at a sample, from the samples around it: linear between them, which is too
    /// small on a ridge, but no less than those to the planes through their feet, which are too
    /// small about a single nearest point, and no more than those to their feet, which are too
    /// large about a flat level.
    fn at(&self, ijk: [usize; 3]) -> f64 {
        let place =
            |ijk: [usize; 3]| Vector3::from_fn(|axis, _| ijk[axis] as f64 * self.step[axis]);
        let here = place(ijk);
        let (mut mean, mut plane, mut nearest) = (0.0, f64::INFINITY, f64::INFINITY);
        let ends = ijk.map(|n| [n / 2, n.div_ceil(2)]);
        for corner in 0..8 {
            let [i, j, k] = [0, 1, 2].map(|axis| ends[axis][corner >> axis & 1]);
            let at = self.grid.index(i, j, k);
            let (distance, foot) = (self.grid.values[at], self.feet[at]);
            let away = here - foot;
            mean += distance / 8.0;
            plane = plane.min(away.dot(&(place([2 * i, 2 * j, 2 * k]) - foot)) / distance);
            nearest = nearest.min(away.norm());
        }
        nearest.min(plane.max(mean))
    }
}
