//! Distances that samples of a grid hand on to their neighbours.

use crate::algebra::tensor::Vector3;
use crate::geometry::voxels::grid::ScalarGrid;

/// Distances are handed on in parts of a step; steps are no whole number of them, since round-off
/// would choose in which part whole steps lie.
const PARTS_OF_STEP: f64 = 8.3;
/// A foot that is nearer by less is as near as the one before \[step\].
const TIE: f64 = 1e-9;

/// A sample whose distance is known, and the nearest point, its foot.
pub(crate) struct KnownDistance {
    pub at: usize,
    pub distance: f64,
    pub foot: Vector3,
}

impl ScalarGrid {
    /// Distance to the nearest foot, `reach` \[m\] at most; known distances stay. In the order of their distances, samples hand their feet to their neighbours
    /// (after Danielsson 1980).
    pub fn propagate(&self, known: &[KnownDistance], reach: f64) -> ScalarGrid {
        let (mut values, _) = self.hand_on(known, reach);
        // Values are interpolated, which infinite ones cannot be.
        values.iter_mut().for_each(|d| *d = d.min(reach));
        ScalarGrid { size: self.size, step: self.step, values }
    }

    /// The distance of each sample and the index of its foot; infinite beyond `reach` \[m\].
    pub(super) fn hand_on(&self, known: &[KnownDistance], reach: f64) -> (Vec<f64>, Vec<u32>) {
        let mut distance = vec![f64::INFINITY; self.size.iter().product()];
        let mut feet = vec![0; distance.len()];
        let mut is_known = vec![false; distance.len()];
        let mut front = Front::new(self.step.min() / PARTS_OF_STEP);
        for (foot, KnownDistance { at, distance: own, .. }) in known.iter().enumerate() {
            (distance[*at], feet[*at], is_known[*at]) = (*own, foot as u32, true);
            front.push(*own, *at, foot as u32);
        }
        let (strides, tie) = (self.strides(), TIE * self.step.min());
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
                    if there < distance[next] - tie && there <= reach {
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
