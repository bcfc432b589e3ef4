//! Ways of nodes through narrow obstacles.

use super::between::OF_WIDTH;
use super::placed::Placed;
use super::plan::ContactPlan;
use crate::algebra::tensor::Vector3;

/// Bounds of the shortest part of a way that is looked at on it \[–\].
const FINEST: (f64, f64) = (1.0 / 2048.0, 1.0 / 128.0);
/// Gap over a way below which the way has entered \[–\].
const ENTERED: f64 = 1e-6;

impl ContactPlan {
    /// Whether the way between two positions \[m\] leads through a narrow obstacle, or past its
    /// middle, and where it enters \[m\]; each position with the obstacle of its time.
    pub(crate) fn crossing(
        &self,
        index: u32,
        from: (&Placed, &Vector3),
        to: (&Placed, &Vector3),
    ) -> Option<Vector3> {
        let width = self.narrow[index as usize]?;
        let (obstacle, now) = (self.at_rest(index), to.0);
        let (from, to) = (from.0.own(from.1), to.0.own(to.1));
        let (way, at_end) = (to - from, obstacle.gap(&to));
        let length = way.norm();
        // A gap changes by no more than the way.
        if at_end >= length || obstacle.gap(&from) >= length {
            return None;
        }
        if at_end < 0.0 && obstacle.normal(&to, [true; 3]).dot(&way) <= 0.0 {
            return None;
        }
        let finest = (OF_WIDTH * width / length).clamp(FINEST.0, FINEST.1);
        let mut part = 0.0;
        while part < 1.0 {
            let x = from + part * way;
            let opening = obstacle.gap(&x);
            if opening < -ENTERED * length {
                return Some(now.now(&x));
            }
            part += (opening / length).max(finest);
        }
        None
    }

    /// Least width of a narrow obstacle \[m\].
    pub(crate) fn width(&self, obstacle: u32) -> Option<f64> {
        self.narrow[obstacle as usize]
    }
}
