//! Influence radii around a place.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::approximation::Approximation;

impl Approximation {
    /// Mean influence radius of the nodes that cover X \[m\]; that of all nodes
    /// where none does.
    pub fn mean_radius(&self, X: &Vector3) -> f64 {
        if self.smallest_radius == self.largest_radius {
            return self.largest_radius;
        }
        let (mut sum, mut count) = (0.0, 0.0);
        self.neighbours.for_each_within(X, self.reach(X, 1.0), |node, offset| {
            let radius = self.influence_radius[node];
            if offset.norm_squared() < radius * radius {
                sum += radius;
                count += 1.0;
            }
        });
        if count > 0.0 {
            sum / count
        } else {
            self.influence_radius.iter().sum::<f64>() / self.influence_radius.len() as f64
        }
    }

    /// The smallest influence radius of the nodes within `reach` of X \[m\]; the mean of
    /// those that cover it where there is none.
    pub fn smallest_radius_within(&self, X: &Vector3, reach: f64) -> f64 {
        let mut smallest = f64::INFINITY;
        self.for_each_node_within(X, reach, |node, _| {
            smallest = smallest.min(self.influence_radius[node as usize]);
        });
        if smallest.is_finite() { smallest } else { self.mean_radius(X) }
    }

    /// Calls `visit(node, distance)` for every node within `radius` of X \[m\].
    pub(crate) fn for_each_node_within(
        &self,
        X: &Vector3,
        radius: f64,
        mut visit: impl FnMut(u32, f64),
    ) {
        self.neighbours.for_each_within(X, radius, |node, offset| {
            let distance = offset.norm();
            if distance < radius {
                visit(node as u32, distance);
            }
        });
    }

    /// The largest influence radius \[m\].
    pub fn largest_radius(&self) -> f64 {
        self.largest_radius
    }
}
