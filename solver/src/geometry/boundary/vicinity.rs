//! Where the members of a body need panels: a member may be much larger than the body.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use std::ops::Range;

/// A box that is larger by so much has the faces that round-off leaves beside it \[diagonal\].
const SLACK: f64 = 1e-6;

/// The box around a body.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vicinity {
    lower: Vector3,
    upper: Vector3,
    /// \[m\]
    slack: f64,
}

impl Vicinity {
    /// From two corners of the box \[m\].
    pub fn new((lower, upper): (Vector3, Vector3)) -> Vicinity {
        Vicinity { lower, upper, slack: SLACK * (upper - lower).norm() }
    }

    /// Edges of the part of another box, from its corners, that is in this one \[m\].
    pub fn common_edges(&self, min: &Vector3, max: &Vector3) -> Vector3 {
        (max.inf(&self.upper) - min.sup(&self.lower)).map(|edge| edge.max(0.0))
    }

    /// Whether a place lies in the box, or no farther from it than a distance \[m\] along
    /// an axis.
    pub fn is_near(&self, X: &Vector3, distance: f64) -> bool {
        let beyond = (self.lower - X).sup(&(X - self.upper));
        beyond.max() <= distance + self.slack
    }

    /// Whether the box around some places meets this one.
    pub fn meets(&self, places: &[Vector3]) -> bool {
        (0..3).all(|axis| {
            let along = || places.iter().map(|X| X[axis]);
            along().fold(f64::INFINITY, f64::min) <= self.upper[axis] + self.slack
                && along().fold(f64::NEG_INFINITY, f64::max) >= self.lower[axis] - self.slack
        })
    }

    /// The square of a plane that covers what of it is in the box: its middle and half its
    /// edge \[m\].
    pub fn square(&self, point: &Vector3, normal: &Vector3) -> (Vector3, f64) {
        let middle = 0.5 * (self.lower + self.upper);
        let across = (middle - point).dot(normal) * normal;
        (middle - across, 0.5 * (self.upper - self.lower).norm())
    }

    /// Which of the `count` steps of a row meet the box, and maybe a few more: the row is
    /// from its start to the side `across` \[m\] of the line along the steps.
    pub fn steps(
        &self,
        start: &Vector3,
        step: &Vector3,
        count: usize,
        across: &Vector3,
    ) -> Range<usize> {
        let (mut first, mut last) = (0.0, count as f64);
        for axis in 0..3 {
            let width = across[axis].abs() + self.slack;
            let (low, high) = (self.lower[axis] - width, self.upper[axis] + width);
            let at = |place: f64| (place - start[axis]) / step[axis];
            if step[axis] != 0.0 {
                let (a, b) = (at(low), at(high));
                (first, last) = (a.min(b).max(first), a.max(b).min(last));
            } else if start[axis] < low || start[axis] > high {
                return 0..0;
            }
        }
        if first > last {
            return 0..0;
        }
        first.floor() as usize..(last.ceil() as usize).min(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> Vicinity {
        Vicinity::new((Vector3::zeros(), Vector3::repeat(1.0)))
    }

    #[test]
    fn a_row_that_passes_by_has_no_steps_and_one_through_the_box_those_in_it_and_one_beside() {
        let (start, step) = (Vector3::new(-10.0, 0.5, 0.5), Vector3::new(0.25, 0.0, 0.0));
        assert_eq!(unit().steps(&start, &step, 1000, &Vector3::zeros()), 39..45);
        assert_eq!(unit().steps(&start, &step, 42, &Vector3::zeros()), 39..42);
        assert_eq!(
            unit().steps(&(start + 2.0 * Vector3::y()), &step, 1000, &Vector3::repeat(0.1)),
            0..0
        );
        assert_eq!(unit().steps(&start, &-step, 1000, &Vector3::repeat(0.1)), 0..0);
    }

    #[test]
    fn a_slanted_row_has_no_fewer_steps_than_touch_the_box() {
        let (start, step) = (Vector3::new(-2.0, -1.0, 0.5), Vector3::new(0.1, 0.07, 0.001));
        let found = unit().steps(&start, &step, 60, &Vector3::repeat(0.05));
        for n in (0..60).filter(|n| !found.contains(n)) {
            let middle = start + (n as f64 + 0.5) * step;
            assert!(!unit().is_near(&middle, 0.05), "step {n}");
        }
    }
}
