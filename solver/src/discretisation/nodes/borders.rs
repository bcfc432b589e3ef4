//! Nodes on the borders between materials (method book, section 5).
#![allow(non_snake_case)]

use crate::discretisation::mls::{Crossing, Stiffness};
use crate::discretisation::nodes::cloud::NodeCloud;
use crate::geometry::{PointHash, Shape};
use rayon::prelude::*;

/// Nodes on borders are at least this far apart \[spacing\].
const APART: f64 = 0.75;
/// Nodes inside make room for borders, and borders for nodes of the boundary \[spacing\].
const ROOM: f64 = 0.5;
/// Puts nodes about a spacing apart on the borders between materials, on the stiffer side by a
/// round-off, in place of the nodes inside that are close to them; none where a material is too
/// thin to be told apart.
pub(crate) fn place_nodes_on_borders(cloud: &mut NodeCloud, body: &Shape, stiffness: &Stiffness) {
    let smallest = ROOM * cloud.smallest_spacing();
    let largest = cloud.spacing.iter().fold(0.0f64, |a, &b| a.max(b));
    let empty = || PointHash::new(smallest, largest);
    let (mut boundary, mut borders, mut placed) = (empty(), empty(), empty());
    for (X, _) in cloud.positions.iter().zip(&cloud.on_boundary).filter(|(_, on)| **on) {
        boundary.insert(*X);
    }
    let mut crossings = stiffness.crossings(&cloud.positions, &cloud.spacing);
    crossings.retain(|crossing| {
        !crossing.thin
            && body.signed_distance(&crossing.position) < 0.0
            && !boundary.any_within(&crossing.position, ROOM * crossing.spacing)
    });
    // Short ways first: they meet borders almost at right angles.
    crossings.sort_by(|a, b| a.length.total_cmp(&b.length));
    let mut added = Vec::new();
    for crossing in crossings {
        let Crossing { position, spacing, .. } = crossing;
        borders.insert(position);
        if !placed.any_within(&position, APART * spacing) {
            placed.insert(position);
            added.push((position, spacing));
        }
    }
    let stays: Vec<bool> = (0..cloud.positions.len())
        .into_par_iter()
        .map(|node| {
            let near = borders.any_within(&cloud.positions[node], ROOM * cloud.spacing[node]);
            cloud.on_boundary[node] || !near
        })
        .collect();
    cloud.retain(&stays);
    for (position, spacing) in added {
        cloud.positions.push(position);
        cloud.spacing.push(spacing);
        cloud.on_boundary.push(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::tensor::Vector3;
    use crate::discretisation::nodes::node_cloud;
    use crate::geometry::Selector;
    use crate::material::{ElasticConstants, Law, LinearElastic, Material};
    use crate::problem::{Cloud, Dimension, Region};

    fn region(part: Selector, young_modulus: f64) -> Region {
        let constants = ElasticConstants::from_young_poisson(young_modulus, 0.3).unwrap();
        let law = Law::LinearElastic(LinearElastic::new(constants));
        Region::new("part", part, Material { density: 1.0, law })
    }

    #[test]
    fn nodes_lie_on_the_border_of_a_ball_and_none_close_to_it() {
        let (centre, radius, spacing) = (Vector3::repeat(0.5), 0.25, 0.1);
        let ball = Shape::Sphere { centre, radius };
        let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(1.0) };
        let part = Selector::Inside { shape: ball.clone(), tolerance: 0.0 };
        for modulus in [0.1, 10.0] {
            let cloud = Cloud::Jittered { spacing, jitter: 0.3, seed: 4 };
            let mut cloud = node_cloud(&body, &cloud, &Dimension::Three).unwrap();
            let regions = [region(part.clone(), modulus), region(Selector::All, 1.0)];
            let stiffness = Stiffness::new(&regions).unwrap();
            let before = cloud.positions.len() as f64;
            place_nodes_on_borders(&mut cloud, &body, &stiffness);
            let distance = |X: &Vector3| ball.signed_distance(X).abs();
            let on = cloud.positions.iter().filter(|X| distance(X) < 1e-9);
            assert!((60..130).contains(&on.clone().count()), "{}", on.count());
            for X in on {
                assert_eq!(
                    stiffness.at(X) > 1.0,
                    modulus > 1.0,
                    "the border is of the stiffer side"
                );
            }
            let between = |X: &&Vector3| (1e-9..0.3 * spacing).contains(&distance(X));
            assert_eq!(cloud.positions.iter().filter(between).count(), 0);
            assert!((cloud.positions.len() as f64 / before - 1.0).abs() < 0.05);
        }
    }
}
