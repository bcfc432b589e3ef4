//! A scalar field on a regular grid, and distances on it.

use crate::algebra::tensor::Vector3;
use rayon::prelude::*;

/// Distances up to this are measured to the level itself \[sample\].
const NEAR: f64 = 4.0;
/// Steps towards the nearest point of the level.
const CLOSER: usize = 8;
/// A point is on the level to this \[sample\].
const ON_LEVEL: f64 = 0.01;
/// A foot that moves less than this is the nearest one \[sample\].
const AT_REST: f64 = 0.001;
/// Distances are handed on in parts of a step.
const PARTS_OF_STEP: f64 = 8.0;

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

    fn strides(&self) -> [usize; 3] {
        [1, self.size[0], self.size[0] * self.size[1]]
    }

    /// Position \[m\] of a sample from the first one.
    pub fn local(&self, index: usize) -> Vector3 {
        self.position(self.indices_of(index))
    }

    fn position(&self, ijk: [usize; 3]) -> Vector3 {
        Vector3::from_fn(|axis, _| ijk[axis] as f64 * self.step[axis])
    }

    fn indices_of(&self, index: usize) -> [usize; 3] {
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

    /// Signed distance to the zero level of the field, negative where it is
    /// negative: from the crossings of grid lines next to the level, to the
    /// nearest of the feet of those samples away from it.
    pub fn distance_to_zero_level(&self) -> ScalarGrid {
        let sign = |at: usize| if self.values[at] < 0.0 { -1.0 } else { 1.0 };
        let known: Vec<KnownDistance> = (0..self.values.len())
            .into_par_iter()
            .filter_map(|at| {
                let distance = self.crossing_distance(at);
                distance.is_finite().then(|| {
                    let normal = self.slope(at).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
                    let foot = self.local(at) - sign(at) * distance * normal;
                    KnownDistance { at, distance, foot }
                })
            })
            .collect();
        let (mut values, feet) = self.hand_on(&known, f64::INFINITY);
        let near = NEAR * self.step.max();
        values.par_iter_mut().zip(feet).enumerate().for_each(|(at, (d, foot))| {
            if *d < near && known[foot as usize].at != at {
                *d = self.distance_to_level(&self.local(at), known[foot as usize].foot, *d);
            }
            *d *= sign(at);
        });
        ScalarGrid { size: self.size, step: self.step, values }
    }

    /// Distance to the zero level of the field by the iteration of Chopp 2001 (method book,
    /// section 4), from a `foot` near it and a distance that is too large.
    fn distance_to_level(&self, here: &Vector3, mut foot: Vector3, too_large: f64) -> f64 {
        let slope = |x: &Vector3| {
            Vector3::from_fn(|axis, _| {
                let aside = Vector3::ith(axis, 0.25 * self.step[axis]);
                (self.sample(&(x + aside)) - self.sample(&(x - aside))) / (0.5 * self.step[axis])
            })
        };
        let mut nearest = too_large;
        for _ in 0..CLOSER {
            let (value, g) = (self.sample(&foot), slope(&foot));
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
            if value.abs() / square.sqrt() + along.norm() < AT_REST * self.step.min() {
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

    /// Distance to the nearest foot, `reach` \[m\] at most; known distances stay. In the order of their distances, samples hand their feet to their neighbours
    /// (after Danielsson 1980).
    pub fn propagate(&self, known: &[KnownDistance], reach: f64) -> ScalarGrid {
        let (mut values, _) = self.hand_on(known, reach);
        // Values are interpolated, which infinite ones cannot be.
        values.iter_mut().for_each(|d| *d = d.min(reach));
        ScalarGrid { size: self.size, step: self.step, values }
    }

    /// The distance of each sample and the index of its foot; infinite beyond `reach` \[m\].
    fn hand_on(&self, known: &[KnownDistance], reach: f64) -> (Vec<f64>, Vec<u32>) {
        let mut distance = vec![f64::INFINITY; self.size.iter().product()];
        let mut feet = vec![0; distance.len()];
        let mut is_known = vec![false; distance.len()];
        let mut front = Front::new(self.step.min() / PARTS_OF_STEP);
        for (foot, KnownDistance { at, distance: own, .. }) in known.iter().enumerate() {
            (distance[*at], feet[*at], is_known[*at]) = (*own, foot as u32, true);
            front.push(*own, *at, foot as u32);
        }
        let strides = self.strides();
        while let Some((own, at, foot)) = front.pop() {
            let at = at as usize;
            if own > distance[at] {
                continue;
            }
            let ijk = self.indices_of(at);
            for axis in 0..3 {
                let behind = ijk[axis].checked_sub(1).map(|to| (to, at - strides[axis]));
                let ahead =
                    (ijk[axis] + 1 < self.size[axis]).then(|| (ijk[axis] + 1, at + strides[axis]));
                for (to, next) in behind.into_iter().chain(ahead) {
                    // Never nearer than here: done already.
                    if distance[next] <= own || is_known[next] {
                        continue;
                    }
                    let mut place = ijk;
                    place[axis] = to;
                    let there = (self.position(place) - known[foot as usize].foot).norm();
                    if there < distance[next] && there <= reach {
                        (distance[next], feet[next]) = (there, foot);
                        front.push(there, next, foot);
                    }
                }
            }
        }
        (distance, feet)
    }
}

/// Samples that hand on their feet, all but in the order of their distances: from lists of samples
/// whose distances differ by less than a width.
struct Front {
    /// \[m\]
    width: f64,
    /// Distance \[m\], sample and foot.
    lists: Vec<Vec<(f64, u32, u32)>>,
    nearest: usize,
}

impl Front {
    fn new(width: f64) -> Front {
        Front { width, lists: Vec::new(), nearest: 0 }
    }

    fn push(&mut self, distance: f64, at: usize, foot: u32) {
        let list = (distance / self.width) as usize;
        if list >= self.lists.len() {
            self.lists.resize_with(list + 1, Vec::new);
        }
        self.lists[list].push((distance, at as u32, foot));
        self.nearest = self.nearest.min(list);
    }

    fn pop(&mut self) -> Option<(f64, u32, u32)> {
        while let Some(list) = self.lists.get_mut(self.nearest) {
            if let Some(sample) = list.pop() {
                return Some(sample);
            }
            self.lists[self.nearest] = Vec::new();
            self.nearest += 1;
        }
        None
    }
}

/// A sample whose distance is known, and the nearest point, its foot.
pub(crate) struct KnownDistance {
    pub at: usize,
    pub distance: f64,
    pub foot: Vector3,
}

/// All index triples below `size`, the first index fastest.
pub(crate) fn indices(size: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = size;
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
}
