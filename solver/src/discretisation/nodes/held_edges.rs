//! Nodes along the edges of held parts of the boundary (method book, eq. 5.4).
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::neighbours::Neighbours;
use crate::discretisation::nodes::cloud::NodeCloud;
use crate::discretisation::nodes::curves::{chains, evenly};
use crate::geometry::{Extent, Panel, PointHash, Shape, project};
use crate::problem::EssentialCondition;
use rayon::prelude::*;

/// Distance of the nodes from the edge, on the held side \[spacing\].
const INSIDE: f64 = 0.16;
/// Other nodes closer to one of them make room \[spacing\].
const ROOM: f64 = 0.65;
/// Nodes of different edges are at least this far apart \[spacing\].
const APART: f64 = 0.5;
/// Closer to a node on an edge of the body, that node serves \[spacing\].
const SERVES: f64 = 0.45;
/// Panels whose normals have a smaller product lie on different faces of the body, whose
/// edges have nodes anyway.
const SAME_FACE: f64 = 0.7;
/// Panels are about a place that are not farther away; not round, since round-off would choose
/// among panels at whole and half sizes \[size of a panel\].
const AROUND: f64 = 1.017_3;
/// Those next to a panel, and points next to each other on an edge, are not farther apart; as
/// little round \[size of a panel\].
const NEXT: f64 = 1.5 * AROUND;
/// Of points of an edge that are closer one is enough; not round either \[size of a panel\].
const KNOWN: f64 = 0.207_1;
/// Halvings of a bracket: to round-off.
const HALVINGS: usize = 40;

/// The boundary of a body in panels, among which held parts end.
pub(crate) struct HeldParts<'a> {
    body: &'a Shape,
    conditions: &'a [EssentialCondition],
    panels: &'a [Panel],
    /// Largest edge of a panel \[m\].
    size: f64,
    /// The centres of the panels.
    centres: Neighbours,
}

/// Two places on the boundary between which a held part ends \[m\].
struct Bracket {
    held: Vector3,
    free: Vector3,
    /// How often it has been halved.
    halvings: usize,
}

impl Bracket {
    fn length(&self) -> f64 {
        (self.free - self.held).norm()
    }
}

/// A node on an edge, and its spacing \[m\].
struct EdgeNode {
    position: Vector3,
    spacing: f64,
}

impl<'a> HeldParts<'a> {
    /// Of panels no larger than `size` \[m\].
    pub fn new(
        body: &'a Shape,
        conditions: &'a [EssentialCondition],
        panels: &'a [Panel],
        size: f64,
    ) -> Self {
        let positions: Vec<Vector3> = panels.iter().map(|panel| panel.centre).collect();
        let centres = Neighbours::new(&positions, 2.0 * size);
        HeldParts { body, conditions, panels, size, centres }
    }

    /// Puts nodes about a spacing apart along every curve where a held part ends within a
    /// face, in place of the nodes close to them. What is held then ends at the curve
    /// instead of anywhere between two nodes.
    pub fn place_nodes(&self, cloud: &mut NodeCloud) {
        let nodes = Neighbours::new(&cloud.positions, 2.0 * cloud.smallest_spacing());
        let spacing_at = |X: &Vector3| nearest_spacing(&nodes, &cloud.spacing, X, self.size);
        let mut hash = PointHash::new(self.size, 1e3 * self.size);
        let mut added: Vec<EdgeNode> = Vec::new();
        for condition in self.conditions.iter().filter(|c| c.extent == Extent::Surface) {
            for curve in self.curves(condition) {
                for X in evenly(&curve, &spacing_at) {
                    let spacing = spacing_at(&X);
                    let position = self.inside(condition, &X, spacing);
                    let served = any_within(&nodes, &position, SERVES * spacing, |node| {
                        cloud.on_boundary[node] && self.is_sharp(&cloud.positions[node])
                    });
                    if !served && !hash.any_within(&position, APART * spacing) {
                        hash.insert(position);
                        added.push(EdgeNode { position, spacing });
                    }
                }
            }
        }
        self.make_room(cloud, &nodes, &added);
    }

    /// Removes the nodes close to the `added` ones and appends these.
    fn make_room(&self, cloud: &mut NodeCloud, nodes: &Neighbours, added: &[EdgeNode]) {
        let mut stays = vec![true; cloud.positions.len()];
        for EdgeNode { position, spacing } in added {
            nodes.for_each_within(position, ROOM * spacing, |node, _| stays[node] = false);
        }
        for (node, stays) in stays.iter_mut().enumerate().filter(|(_, stays)| !**stays) {
            *stays = cloud.on_boundary[node] && self.is_sharp(&cloud.positions[node]);
        }
        cloud.retain(&stays);
        for EdgeNode { position, spacing } in added {
            cloud.positions.push(*position);
            cloud.spacing.push(*spacing);
            cloud.on_boundary.push(true);
        }
    }

    /// Whether faces of different normals meet at a place.
    fn is_sharp(&self, X: &Vector3) -> bool {
        let mut normals: Vec<Vector3> = Vec::new();
        self.centres.for_each_within(X, AROUND * self.size, |panel, _| {
            normals.push(self.panels[panel].normal);
        });
        let differs = |normal: &Vector3| normals.iter().any(|n| n.dot(normal) < SAME_FACE);
        normals.iter().any(differs)
    }

    /// Whether no condition holds a panel as much as `condition` does.
    fn is_free(&self, condition: &EssentialCondition, panel: &Panel) -> bool {
        let as_much = |other: &EssentialCondition| {
            (0..3).all(|k| other.prescribes(k) || !condition.prescribes(k))
        };
        !self.conditions.iter().any(|other| as_much(other) && other.part.contains_panel(panel))
    }

    /// The curves along which the part that a condition holds ends within a face.
    fn curves(&self, condition: &EssentialCondition) -> Vec<Vec<Vector3>> {
        let held: Vec<bool> =
            self.panels.iter().map(|panel| condition.part.contains_panel(panel)).collect();
        let is_held = |(panel, held): (&'a Panel, &bool)| held.then_some(panel);
        let across: Vec<Bracket> = (self.panels.par_iter().zip(&held).filter_map(is_held))
            .flat_map_iter(|panel| self.brackets(condition, panel, &held))
            .map(|bracket| self.narrowed(condition, bracket))
            .collect();
        let mut hash = PointHash::new(0.1 * self.size, self.size);
        let mut points = Vec::new();
        for bracket in across {
            let known = |X: &Vector3, within: f64| hash.any_within(X, KNOWN * self.size - within);
            if let Some(X) = self.end_within(condition, bracket, known) {
                hash.insert(X);
                points.push(X);
            }
        }
        chains(points, NEXT * self.size)
    }

    /// From a held panel to those about it on its face that are free.
    fn brackets(
        &self,
        condition: &EssentialCondition,
        panel: &Panel,
        held: &[bool],
    ) -> Vec<Bracket> {
        let mut free = Vec::new();
        self.centres.for_each_within(&panel.centre, NEXT * self.size, |other, _| {
            let far = &self.panels[other];
            let on_face = far.normal.dot(&panel.normal) >= SAME_FACE;
            if !held[other] && on_face && self.is_free(condition, far) {
                free.push(other);
            }
        });
        // The cells in which panels are found hang on round-off.
        free.sort_unstable();
        let bracket = |other: usize| Bracket {
            held: panel.centre,
            free: self.panels[other].centre,
            halvings: 0,
        };
        free.into_iter().map(bracket).collect()
    }

    /// A bracket so small that what is found in others may tell that it is not needed.
    fn narrowed(&self, condition: &EssentialCondition, mut bracket: Bracket) -> Bracket {
        while bracket.length() >= 0.15 * self.size && bracket.halvings < HALVINGS {
            bracket = self.halved(condition, bracket);
        }
        bracket
    }

    fn halved(&self, condition: &EssentialCondition, bracket: Bracket) -> Bracket {
        let Bracket { held, free, halvings } = bracket;
        let middle = project(self.body, &(0.5 * (held + free)));
        let halvings = halvings + 1;
        if condition.part.contains(&middle) {
            Bracket { held: middle, free, halvings }
        } else {
            Bracket { held, free: middle, halvings }
        }
    }

    /// Where the held part ends in a bracket; `None` as soon as it is `known` that every place
    /// within some way \[m\] of a held one is.
    fn end_within(
        &self,
        condition: &EssentialCondition,
        mut bracket: Bracket,
        known: impl Fn(&Vector3, f64) -> bool,
    ) -> Option<Vector3> {
        while bracket.halvings < HALVINGS {
            let within = bracket.length();
            if within < 0.15 * self.size && known(&bracket.held, within) {
                return None;
            }
            bracket = self.halved(condition, bracket);
        }
        (!known(&bracket.held, 0.0)).then_some(bracket.held)
    }

    /// The place of a node at the point `X` of an edge.
    fn inside(&self, condition: &EssentialCondition, X: &Vector3, spacing: f64) -> Vector3 {
        let X = project(self.body, X);
        let mut inwards = Vector3::zeros();
        self.centres.for_each_within(&X, spacing.max(self.size), |panel, offset| {
            if condition.part.contains_panel(&self.panels[panel]) {
                inwards += self.panels[panel].area * offset;
            }
        });
        let normal = self.body.gradient(&X);
        let inwards = inwards - inwards.dot(&normal) * normal;
        let moved = inwards.try_normalize(0.0).map(|way| X + INSIDE * spacing * way);
        // A part may be narrower than that.
        moved
            .map(|moved| project(self.body, &moved))
            .filter(|moved| condition.part.contains(moved))
            .unwrap_or(X)
    }
}

/// Whether a node within `radius` \[m\] of a place is such that `is` holds.
fn any_within(nodes: &Neighbours, X: &Vector3, radius: f64, is: impl Fn(usize) -> bool) -> bool {
    let mut found = false;
    nodes.for_each_within(X, radius, |node, _| found = found || is(node));
    found
}

/// The spacing \[m\] at the node nearest to a place, searched from a radius \[m\] on; the mean
/// of those that are equally near.
fn nearest_spacing(nodes: &Neighbours, spacing: &[f64], X: &Vector3, radius: f64) -> f64 {
    let mut radius = radius;
    loop {
        let found = nodes.nearest(X, radius, |_| true);
        if !found.is_empty() || !radius.is_finite() {
            return found.iter().map(|&node| spacing[node]).sum::<f64>() / found.len() as f64;
        }
        radius *= 2.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discretisation::nodes::node_cloud;
    use crate::geometry::Selector;
    use crate::problem::{Amplitude, Cloud, Dimension, Prescribed};

    const SPACING: f64 = 0.06;
    const RADIUS: f64 = 0.15;
    const CENTRE: Vector3 = Vector3::new(0.5, 0.25, 0.25);

    fn brick() -> Shape {
        Shape::Box { min: Vector3::zeros(), max: Vector3::new(1.0, 0.5, 0.25) }
    }

    fn ball(centre: Vector3, radius: f64) -> Selector {
        Selector::Inside { shape: Shape::Sphere { centre, radius }, tolerance: 0.0 }
    }

    fn held(part: Selector) -> EssentialCondition {
        EssentialCondition::on_surface("held", part, Vector3::zeros(), Amplitude::Constant)
    }

    /// The jittered nodes of the brick before and after those of its held parts.
    fn clouds(conditions: &[EssentialCondition]) -> (NodeCloud, NodeCloud) {
        let cloud = Cloud::Jittered { spacing: SPACING, jitter: 0.2, seed: 3 };
        let before = node_cloud(&brick(), &cloud, &Dimension::Three).unwrap();
        let size = 0.5 * SPACING;
        let panels = brick().boundary_panels(size, &Dimension::Three).unwrap();
        let mut after = before.clone();
        HeldParts::new(&brick(), conditions, &panels, size).place_nodes(&mut after);
        (before, after)
    }

    #[test]
    fn a_held_disc_gets_a_ring_of_nodes_inside_its_edge_and_room_around_it() {
        let condition = held(ball(CENTRE, RADIUS));
        let (_, cloud) = clouds(std::slice::from_ref(&condition));
        let inside = RADIUS - INSIDE * SPACING;
        let on_ring = |X: &Vector3| {
            let off = X - CENTRE;
            off.z == 0.0 && (off.norm() - inside).abs() < 0.03 * SPACING
        };
        let (ring, others): (Vec<Vector3>, Vec<Vector3>) =
            cloud.positions.iter().copied().partition(on_ring);
        let expected = std::f64::consts::TAU * RADIUS / SPACING;
        assert!((ring.len() as f64 - expected).abs() <= 1.0, "{} nodes", ring.len());
        for X in &ring {
            assert!(condition.part.contains(X));
            let closest = |nodes: &[Vector3]| {
                let apart = nodes.iter().map(|Y| (X - Y).norm()).filter(|apart| *apart > 0.0);
                apart.fold(f64::INFINITY, f64::min) / SPACING
            };
            assert!((0.85..1.1).contains(&closest(&ring)), "{} apart", closest(&ring));
            assert!((ROOM..1.3).contains(&closest(&others)), "{} away", closest(&others));
        }
        assert!(cloud.on_boundary[cloud.positions.len() - ring.len()..].iter().all(|on| *on));
    }

    #[test]
    fn whole_faces_change_no_node() {
        let face = Selector::Plane { point: CENTRE, normal: Vector3::z(), tolerance: 1e-9 };
        let (before, after) = clouds(&[held(face)]);
        assert_eq!(before, after);
    }

    #[test]
    fn a_part_that_goes_on_under_another_condition_has_no_edge_there() {
        let left = Selector::Inside {
            shape: Shape::Box { min: Vector3::repeat(-1.0), max: Vector3::new(0.5, 2.0, 2.0) },
            tolerance: 0.0,
        };
        let right = Selector::Not(Box::new(left.clone()));
        let (before, after) = clouds(&[held(left.clone()), held(right.clone())]);
        assert_eq!(before, after);
        // Rollers do not hold as much.
        let mut rollers = held(right);
        rollers.prescribed = Prescribed::Displacement([None, None, Some(0.0)]);
        let (before, after) = clouds(&[held(left), rollers]);
        assert_ne!(before, after);
    }

    #[test]
    fn corners_and_edges_of_the_body_keep_their_nodes() {
        let (before, after) = clouds(&[held(ball(Vector3::new(0.0, 0.0, 0.25), RADIUS))]);
        let faces = |X: &Vector3| {
            let ends = X.iter().zip(&[1.0, 0.5, 0.25]).filter(|(x, end)| **x == 0.0 || x == end);
            ends.count()
        };
        for X in before.positions.iter().filter(|X| faces(X) > 1) {
            assert!(after.positions.contains(X), "{X}");
        }
        assert_ne!(before, after);
    }
}
