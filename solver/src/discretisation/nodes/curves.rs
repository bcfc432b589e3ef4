//! Curves from points, and points that divide curves.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::neighbours::Neighbours;
use crate::geometry::nearest_count;
use std::collections::VecDeque;

/// Points ordered along curves: from an end to the nearest that is left and not farther
/// than `reach` \[m\]. A closed curve ends with its first point.
pub(super) fn chains(points: Vec<Vector3>, reach: f64) -> Vec<Vec<Vector3>> {
    if points.is_empty() {
        return Vec::new();
    }
    let cells = Neighbours::new(&points, reach);
    let mut left = vec![true; points.len()];
    let mut chains = Vec::new();
    for first in 0..points.len() {
        if !std::mem::replace(&mut left[first], false) {
            continue;
        }
        let mut chain = VecDeque::from([points[first]]);
        for forwards in [true, false] {
            let mut end = points[first];
            // Of those that are equally near the first, whatever round-off says.
            while let Some(&next) = cells.nearest(&end, reach, |point| left[point]).first() {
                left[next] = false;
                end = points[next];
                if forwards { chain.push_back(end) } else { chain.push_front(end) }
            }
        }
        let mut chain = Vec::from(chain);
        if chain.len() > 3 && (chain[0] - chain[chain.len() - 1]).norm() < reach {
            chain.push(chain[0]);
        }
        chains.push(chain);
    }
    chains
}

/// Points that divide a curve evenly in units of the local spacing, its ends included.
pub(super) fn evenly(curve: &[Vector3], spacing_at: &impl Fn(&Vector3) -> f64) -> Vec<Vector3> {
    let mut sums = vec![0.0];
    let mut sum = 0.0;
    for pair in curve.windows(2) {
        sum += (pair[1] - pair[0]).norm() / spacing_at(&pair[0]);
        sums.push(sum);
    }
    if sum == 0.0 {
        return vec![curve[0]];
    }
    let closed = curve[0] == curve[curve.len() - 1];
    let count = nearest_count(sum);
    let last = if closed { count - 1 } else { count };
    (0..=last)
        .map(|n| {
            let goal = sum * n as f64 / count as f64;
            let b = sums.partition_point(|s| *s <= goal).min(sums.len() - 1);
            let a = b - 1;
            let t = (goal - sums[a]) / (sums[b] - sums[a]);
            curve[a] + t * (curve[b] - curve[a])
        })
        .collect()
}
