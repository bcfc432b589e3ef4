//! Nodes on the borders between materials (method book, section 5).
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::{Crossing, Stiffness, are_opposite};
use crate::discretisation::nodes::cloud::NodeCloud;
use crate::geometry::{PointHash, Shape, project};
use rayon::prelude::*;

/// Nodes on borders are at least this far apart; not round, as what follows, since round-off would
/// choose among nodes on lattices \[spacing\].
const APART: f64 = 0.603_1;
/// Nodes make room for those on borders that are closer, which those in the middle of a layer of one
/// spacing are not; moved nodes keep as much from the boundary of the body \[spacing\].
const ROOM: f64 = 0.491_7;
/// Nodes beside a border are moved away from it: those closer than the second come to lie between
/// the first and the second \[spacing\].
const CLEAR: (f64, f64) = (1.0, 1.6);
/// Lengths that differ by less are the same \[spacing\].
const SAME: f64 = 1e-6;
/// Places between two nodes of the boundary that are closer to it are on it \[spacing\].
const ON_BOUNDARY: f64 = 0.1;
/// Where the normals of the boundary around a node are looked at \[spacing\].
const BESIDE: f64 = 0.05;
/// Normals of one face have a larger product.
const SAME_FACE: f64 = 0.7;

/// A node to be, on a border.
struct BorderNode {
    crossing: Crossing,
    /// Towards the softer side.
    normal: Vector3,
    /// How many faces of the body meet there; 0 inside.
    faces: usize,
}

/// Puts nodes on the borders between materials, on the stiffer side by a round-off, in place of the
/// nodes that are close to them: on both borders of a layer, however thin, and where a border meets
/// the boundary on both. Nodes beside them move away, so that spacings across a border are even.
pub(crate) fn place_nodes_on_borders(cloud: &mut NodeCloud, body: &Shape, stiffness: &Stiffness) {
    let (nodes, spacing) = (&cloud.positions, &cloud.spacing);
    let crossings = stiffness.crossings(nodes, spacing);
    let mut found: Vec<BorderNode> = crossings
        .into_par_iter()
        .filter_map(|crossing| border_node(crossing, cloud, body, stiffness))
        .collect();
    // On edges first, then on faces; short ways first, since they meet borders almost at right
    // angles.
    let steps = |of: &Crossing| (of.length / (SAME * of.spacing)).round() as u64;
    found.sort_by_key(|node| (std::cmp::Reverse(node.faces), steps(&node.crossing)));
    let smallest = ROOM * cloud.smallest_spacing();
    let largest = cloud.spacing.iter().fold(0.0f64, |a, &b| a.max(b));
    // By the number of faces that meet: 0, 1, 2 or more.
    let mut borders = [0; 3].map(|_| PointHash::new(smallest, largest));
    let mut placed = PointHash::new(smallest, largest);
    let beside = Sheets::new(&found, smallest, largest);
    let mut added: Vec<BorderNode> = Vec::new();
    for node in found {
        let Crossing { position, spacing, .. } = node.crossing;
        borders[node.faces.min(2)].insert(position);
        let mut is_free = true;
        placed.visit(&position, APART * spacing, |index, _| {
            is_free &= are_opposite(&added[index].normal, &node.normal);
            is_free
        });
        if is_free {
            placed.insert(position);
            added.push(node);
        }
    }
    let stays = |node: usize| {
        let (X, room) = (&cloud.positions[node], ROOM * cloud.spacing[node]);
        let faces = if cloud.on_boundary[node] {
            faces_at(body, X, cloud.spacing[node], stiffness.is_flat())
        } else {
            0
        };
        // Corners of the body stay, and nodes on its edges and faces unless others on these come.
        faces > 2 || (faces.min(2)..3).all(|others| !borders[others].any_within(X, room))
    };
    let nodes = 0..cloud.positions.len();
    let stays: Vec<bool> = nodes.clone().into_par_iter().map(stays).collect();
    let moved = |node| {
        if cloud.on_boundary[node] {
            cloud.positions[node]
        } else {
            beside.clear_of(&cloud.positions[node], cloud.spacing[node], body)
        }
    };
    cloud.positions = nodes.into_par_iter().map(moved).collect();
    cloud.retain(&stays);
    for BorderNode { crossing, faces, .. } in added {
        cloud.positions.push(crossing.position);
        cloud.spacing.push(crossing.spacing);
        cloud.on_boundary.push(faces > 0);
    }
}

/// Borders as places on them, with their normals.
struct Sheets {
    places: PointHash,
    normals: Vec<Vector3>,
    positions: Vec<Vector3>,
}

impl Sheets {
    fn new(nodes: &[BorderNode], smallest: f64, largest: f64) -> Sheets {
        let mut places = PointHash::new(smallest, largest);
        nodes.iter().for_each(|node| places.insert(node.crossing.position));
        let positions = nodes.iter().map(|node| node.crossing.position).collect();
        Sheets { places, positions, normals: nodes.iter().map(|node| node.normal).collect() }
    }

    /// Where a node goes that is as far from the closest border as [`CLEAR`] asks, but not beyond
    /// the middle between the two borders of a layer, nor towards the boundary of the body.
    fn clear_of(&self, X: &Vector3, spacing: f64, body: &Shape) -> Vector3 {
        let same = SAME * spacing;
        let mut closest: Vec<(f64, usize)> = Vec::new();
        self.places.visit(X, CLEAR.1 * spacing, |index, distance| {
            let least = closest.first().map_or(f64::INFINITY, |first| first.0);
            if distance < least - same {
                closest.clear();
            }
            if distance < least + same {
                closest.push((distance, index));
            }
            true
        });
        // Of borders that are equally close all count.
        let moves = closest.iter().map(|(_, index)| self.away(X, *index, spacing));
        let moved = X + moves.sum::<Vector3>() / closest.len().max(1) as f64;
        let depth = |X: &Vector3| -body.signed_distance(X);
        match depth(&moved) {
            shallow if shallow < ROOM * spacing && shallow < depth(X) - same => *X,
            _ => moved,
        }
    }

    /// What takes a node away from the border at a place.
    fn away(&self, X: &Vector3, index: usize, spacing: f64) -> Vector3 {
        let (normal, place) = (self.normals[index], self.positions[index]);
        let away = (X - place).dot(&normal).signum() * normal;
        let distance = (X - place).dot(&away);
        let (room, least, most) = (ROOM * spacing, CLEAR.0 * spacing, CLEAR.1 * spacing);
        let mut middle = f64::INFINITY;
        self.places.visit(X, 2.0 * most, |other, _| {
            let offset = self.positions[other] - X;
            let (beyond, across) = (offset.dot(&away), offset - offset.dot(&away) * away);
            let faces = are_opposite(&normal, &self.normals[other]) && beyond > 0.0;
            if faces && across.norm() < spacing {
                middle = f64::min(middle, 0.5 * (distance + beyond));
            }
            true
        });
        let clear = least + (distance - room) * (most - least) / (most - room);
        (clear.min(middle) - distance).max(0.0) * away
    }
}

/// The node that a crossing asks for; `None` outside of the body, and inside where it is so close to
/// the boundary that crossings between nodes there stand for it.
fn border_node(
    crossing: Crossing,
    cloud: &NodeCloud,
    body: &Shape,
    stiffness: &Stiffness,
) -> Option<BorderNode> {
    let depth = -body.signed_distance(&crossing.position);
    let between = crossing.ends.iter().all(|&node| cloud.on_boundary[node]);
    let spacing = crossing.spacing;
    let (crossing, faces) = if between && depth.abs() <= ON_BOUNDARY * spacing {
        let crossing = stiffness.on_surface(&crossing, &cloud.positions, |X| project(body, X))?;
        let faces = faces_at(body, &crossing.position, spacing, stiffness.is_flat()).max(1);
        (crossing, faces)
    } else {
        (depth > ROOM * spacing).then_some((crossing, 0))?
    };
    let normal = stiffness.normal(&crossing.position, spacing);
    Some(BorderNode { crossing, normal, faces })
}

/// How many faces of the body meet at a place on its boundary, as far as normals around it tell.
fn faces_at(body: &Shape, X: &Vector3, spacing: f64, flat: bool) -> usize {
    let mut normals: Vec<Vector3> = Vec::new();
    for corner in 0..8 {
        let sign = |axis: usize| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
        // Not along a diagonal, on which two faces are equally near.
        let across = if flat { 0.0 } else { 0.69 * sign(2) };
        let way = Vector3::new(sign(0), 0.83 * sign(1), across);
        let normal = body.gradient(&(X + BESIDE * spacing * way));
        if normals.iter().all(|known| known.dot(&normal) < SAME_FACE) {
            normals.push(normal);
        }
    }
    normals.len()
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
            let stiffness = Stiffness::new(&regions, false).unwrap();
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
