//! The surface between nodes against obstacles that are narrow for the spacing, or have an edge
//! that the body may meet (method book, section 16).
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::{Discretisation, Rows};
use crate::error::Error;
use crate::geometry::Shape;
use crate::problem::{Dimension, Obstacle, ObstacleSide, Problem};

/// Radius over the mean spacing below which nodes may miss a round obstacle \[–\]: on a larger
/// one a flat face sags between nodes by less than 0.05 spacings.
const ROUND: f64 = 3.0;
/// Thickness over the mean spacing below which nodes may pass through a plate \[–\].
const THICK: f64 = 4.0;
/// Bounds of the distance of places over the mean spacing, and over the width of the narrowest
/// obstacle \[–\].
const DISTANCES: (f64, f64) = (0.125, 0.25);
pub(super) const OF_WIDTH: f64 = 0.4;
/// Most places: a larger body has them farther apart.
const MOST: f64 = 60_000.0;

/// The body whose surface obstacles may enter between nodes.
#[derive(Debug, Clone)]
pub(super) struct Outside {
    pub body: Shape,
    dimension: Dimension,
}

/// Places on the surface between nodes.
pub(super) struct Between {
    /// Reference positions \[place\] \[m\].
    pub positions: Vec<Vector3>,
    /// φ there.
    rows: Rows,
}

impl Outside {
    /// That of a problem.
    pub fn new(problem: &Problem) -> Outside {
        Outside { body: problem.body.clone(), dimension: problem.dimension }
    }

    /// Places on it, no farther apart than obstacles of this width \[m\] ask for.
    pub fn places(
        &self,
        discretisation: &Discretisation,
        spacing: f64,
        width: f64,
    ) -> Result<Between, Error> {
        let count = discretisation.cloud.on_boundary.iter().filter(|on| **on).count();
        let coarsest = spacing * (count as f64 / MOST).sqrt();
        let distance = (OF_WIDTH * width).clamp(DISTANCES.0 * spacing, DISTANCES.1 * spacing);
        let panels = self.body.boundary_panels(distance.max(coarsest), &self.dimension)?;
        let positions: Vec<Vector3> = panels.iter().map(|panel| panel.centre).collect();
        let rows = discretisation.rows_at(&positions)?;
        Ok(Between { positions, rows })
    }
}

impl Between {
    /// Current positions \[m\] at nodal parameters `u` \[component of node\] \[m\].
    pub fn current(&self, u: &[f64], components: usize) -> Vec<Vector3> {
        let places = self.positions.iter().enumerate();
        places.map(|(place, X)| X + self.rows.interpolate(place, u, components)).collect()
    }
}

/// The width \[m\] of an obstacle that nodes `spacing` apart may miss or pass through, or whose
/// edges the body in the box `around` may meet; none for one that is large and smooth. Cavities
/// and label maps count as such.
pub(super) fn narrow(
    obstacle: &Obstacle,
    around: Option<(Vector3, Vector3)>,
    spacing: f64,
) -> Option<f64> {
    if obstacle.side == ObstacleSide::Inside {
        return None;
    }
    is_narrow(&obstacle.shape, obstacle.offset, around, spacing).then(|| {
        let edges = obstacle.shape.bounding_box().map(|(lower, upper)| upper - lower);
        let finite = edges.into_iter().flat_map(<[f64; 3]>::from);
        let least = finite.filter(|edge| edge.is_finite()).fold(f64::INFINITY, f64::min);
        least + 2.0 * obstacle.offset
    })
}

fn is_narrow(shape: &Shape, offset: f64, around: Option<(Vector3, Vector3)>, spacing: f64) -> bool {
    let round = |radius: f64| radius + offset < ROUND * spacing;
    let Some((lower, upper)) = around else { return true };
    let edges = (upper - lower).map(|edge| if edge.is_finite() { edge } else { 0.0 });
    let reach = 0.5 * edges.norm();
    match shape {
        Shape::HalfSpace { .. } | Shape::Labels(_) => false,
        Shape::Sphere { radius, .. } => round(*radius),
        Shape::Ellipsoid { radii, .. } => round(radii.min() * radii.min() / largest(radii)),
        Shape::Box { min, max } => {
            let covers = |k: &usize| min[*k] <= lower[*k] - reach && max[*k] >= upper[*k] + reach;
            let within: Vec<usize> = (0..3).filter(|k| !covers(k)).collect();
            match within[..] {
                [] => false,
                [k] => max[k] - min[k] + 2.0 * offset < THICK * spacing,
                _ => true,
            }
        }
        Shape::Cylinder { base, axis, radius, height } => {
            let middle = (0.5 * (lower + upper) - base).dot(axis);
            let ends = middle < 2.0 * reach || height - middle < 2.0 * reach;
            round(*radius) || ends
        }
        Shape::Union(members) => members.iter().any(|m| is_narrow(m, offset, around, spacing)),
        _ => true,
    }
}

fn largest(radii: &Vector3) -> f64 {
    radii.iter().copied().filter(|radius| radius.is_finite()).fold(0.0, f64::max)
}
