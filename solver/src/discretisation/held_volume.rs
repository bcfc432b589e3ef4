//! What is held as a volume: it moves as prescribed and does not deform (method book, section 15).
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::ON_BORDER;
use crate::discretisation::nodes::{NodeCloud, node_cloud};
use crate::discretisation::quadrature::Quadrature;
use crate::discretisation::rows::Rows;
use crate::discretisation::surface_rule::SurfaceRule;
use crate::geometry::{Extent, GeometryError, Selector, Shape};
use crate::problem::{Cloud, Dimension, EssentialCondition, Problem};
use rayon::prelude::*;
use std::cmp::Ordering;

/// Selections that reach beyond their shape by more have no border there \[spacing\].
const THIN: f64 = 0.01;
/// What is held, and what is left, has room for a ball of this radius \[spacing\]; a little
/// less, so that round-off does not decide about slabs of one spacing.
const ROOM: f64 = 0.5 - 1e-6;
/// Places where room is looked for are so far apart \[spacing\].
const LOOKS: f64 = 0.25;
/// No more places are looked at than this.
const MOST_LOOKS: f64 = 1e9;
/// Nodes inside of what is held that do not lie on its border are farther away from it \[spacing\].
const CLEARANCE: f64 = 0.5 + 1e-6;
/// Faces of two solids that are closer and parallel, by the cosine of their normals, are one
/// \[spacing\], \[–\].
const SAME_FACE: f64 = 0.02;
const PARALLEL: f64 = 0.999;
/// Nodes that are deeper in the body are not on its boundary \[spacing\].
const INSIDE: f64 = 1e-3;

/// What is held as a volume, and what is left of the body; in a plane their sections.
#[derive(Debug, Clone)]
pub struct HeldShape {
    /// What is held; it may reach beyond the body.
    pub held: Shape,
    /// What deforms.
    pub rest: Shape,
}

/// What is held as a volume, discretised.
#[derive(Debug, Clone)]
pub struct HeldVolume {
    /// What is held, and what is left of the body.
    pub shape: HeldShape,
    /// Points of what is held, for its mass and its loads.
    pub quadrature: Quadrature,
    /// φ at these points.
    pub rows: Rows,
    /// The whole boundary of the body, if loads act on it.
    pub surface: SurfaceRule,
    /// Nodes within what is held are the last ones, from this one on.
    pub first_node: usize,
}

impl HeldShape {
    /// What conditions hold as a volume of a body, a section in a plane: all components for
    /// ever, of a selection with room for a ball of a spacing's diameter. `None` where nothing
    /// is, where nothing else is left, and in clouds of given nodes, which have none on borders.
    pub fn of(problem: &Problem, body: &Shape) -> Option<HeldShape> {
        let spacing = nominal_spacing(&problem.recipe.cloud)?;
        let components = problem.dimension.components();
        let mut parts: Vec<&Selector> = (problem.conditions.iter())
            .filter(|condition| holds(condition, components))
            .map(|condition| condition.part.in_few_words())
            .collect();
        if parts.is_empty() {
            return None;
        }
        let bounds = problem.body.bounding_box()?;
        let room = Room { body, spacing, dimension: &problem.dimension };
        let solid = |part: &Selector| {
            let solid = part.solid(body, THIN * spacing)?;
            let solid = beyond(&solid, (&bounds.0, &bounds.1), spacing);
            solid.section(&problem.dimension).ok()
        };
        // The order of conditions must not matter.
        let levels = |part: &Selector| {
            [0.0, 0.37, 1.0].map(|way| part.level(&bounds.0.lerp(&bounds.1, way), None, spacing))
        };
        parts.sort_by(|a, b| {
            let pairs = levels(a).into_iter().zip(levels(b));
            pairs.fold(Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(&b)))
        });
        let (mut held, mut rest) = (Vec::new(), body.clone());
        for part in parts {
            let Some(shape) = solid(part) else { continue };
            let has_room = room.is_in(&|X| shape.signed_distance(X));
            if !has_room || room.shares_face(&rest, &shape)? {
                continue;
            }
            rest = match part {
                Selector::Not(part) => Shape::Intersection(vec![rest, solid(part)?]),
                _ => Shape::Difference(Box::new(rest), Box::new(shape.clone())),
            };
            held.push(shape);
        }
        let held = match held.len() {
            0 | 1 => held.pop()?,
            _ => Shape::Union(held),
        };
        room.is_in(&|X| -held.signed_distance(X)).then_some(HeldShape { held, rest })
    }

    /// The part of a body that is held.
    pub fn of_body(&self, body: &Shape) -> Shape {
        Shape::Intersection(vec![body.clone(), self.held.clone()])
    }

    /// Appends the nodes within what is held, those of the whole body, and marks those on its
    /// border. Returns whether each of all nodes lies on the boundary of the body; until then
    /// those within do not.
    pub(super) fn add_nodes(
        &self,
        problem: &Problem,
        body: &Shape,
        cloud: &mut NodeCloud,
    ) -> Result<Vec<bool>, GeometryError> {
        let mut on_boundary = cloud.on_boundary.clone();
        for (node, (X, spacing)) in cloud.positions.iter().zip(&cloud.spacing).enumerate() {
            let on_border = self.held.signed_distance(X).abs() <= ON_BORDER * spacing;
            cloud.on_border.push(on_border);
            on_boundary[node] &= !on_border || body.signed_distance(X) > -INSIDE * spacing;
        }
        let whole = node_cloud(&problem.body, &problem.recipe.cloud, &problem.dimension)?;
        for ((X, spacing), on) in whole.positions.iter().zip(&whole.spacing).zip(&whole.on_boundary)
        {
            if self.held.signed_distance(X) < -CLEARANCE * spacing {
                cloud.positions.push(*X);
                cloud.spacing.push(*spacing);
                cloud.on_boundary.push(false);
                cloud.on_border.push(false);
                on_boundary.push(*on);
            }
        }
        Ok(on_boundary)
    }
}

/// A solid with the faces that lie on the box around a body, or beyond, moved outwards: faces
/// that two solids share would leave sheets without volume between them.
fn beyond(shape: &Shape, (lower, upper): (&Vector3, &Vector3), spacing: f64) -> Shape {
    let of = |shape: &Shape| beyond(shape, (lower, upper), spacing);
    let all = |members: &[Shape]| members.iter().map(of).collect();
    match shape {
        Shape::Box { min, max } => {
            let near = SAME_FACE * spacing;
            let out = |at: f64, end: f64, way: f64| {
                if (end - at) * way <= near { end + way * spacing } else { at }
            };
            Shape::Box {
                min: Vector3::from_fn(|k, _| out(min[k], lower[k], -1.0)),
                max: Vector3::from_fn(|k, _| out(max[k], upper[k], 1.0)),
            }
        }
        Shape::Union(members) => Shape::Union(all(members)),
        Shape::Intersection(members) => Shape::Intersection(all(members)),
        Shape::Difference(whole, hole) => {
            Shape::Difference(Box::new(of(whole)), Box::new(of(hole)))
        }
        _ => shape.clone(),
    }
}

/// Whether a condition may hold a volume.
fn holds(condition: &EssentialCondition, components: usize) -> bool {
    condition.extent == Extent::Volume
        && condition.release.is_none()
        && (0..components).all(|component| condition.prescribes(component))
}

/// Whether a condition selects a node. Those on the border of what is held as a volume are
/// selected as far as round-off, whatever the tolerance.
pub fn selects(condition: &EssentialCondition, cloud: &NodeCloud, node: usize) -> bool {
    let (X, spacing) = (&cloud.positions[node], cloud.spacing[node]);
    match condition.extent {
        Extent::Surface => cloud.on_boundary[node] && condition.part.contains(X),
        Extent::Volume if cloud.on_border.get(node) == Some(&true) => {
            condition.part.contains(X)
                || condition.part.level(X, None, THIN * spacing) <= ON_BORDER * spacing
        }
        Extent::Volume => condition.part.contains(X),
    }
}

/// Spacing of a cloud where nothing refines it \[m\]; `None` of given nodes.
fn nominal_spacing(cloud: &Cloud) -> Option<f64> {
    match cloud {
        Cloud::Regular { spacing }
        | Cloud::Jittered { spacing, .. }
        | Cloud::Graded { spacing, .. } => (*spacing > 0.0).then_some(*spacing),
        Cloud::Given { .. } => None,
    }
}

/// Where room is looked for.
struct Room<'a> {
    body: &'a Shape,
    /// \[m\]
    spacing: f64,
    dimension: &'a Dimension,
}

impl Room<'_> {
    /// Whether a solid has a face in common with another; where that is not known, `None`.
    fn shares_face(&self, of: &Shape, solid: &Shape) -> Option<bool> {
        let panels = of.boundary_panels(0.5 * self.spacing, self.dimension).ok()?;
        Some(panels.par_iter().any(|panel| {
            solid.signed_distance(&panel.centre).abs() < SAME_FACE * self.spacing
                && solid.gradient(&panel.centre).dot(&panel.normal).abs() > PARALLEL
        }))
    }

    /// Whether a ball fits into the part of the body where a distance is negative.
    fn is_in(&self, distance: &(dyn Fn(&Vector3) -> f64 + Sync)) -> bool {
        let Ok((lower, upper)) = self.body.finite_bounds(self.dimension) else { return false };
        let step = LOOKS * self.spacing;
        let counts = (upper - lower).map(|length| (length / step).ceil() + 1.0);
        if counts.product() > MOST_LOOKS {
            return false;
        }
        let least = -ROOM * self.spacing;
        let [x, y, z] = [0, 1, 2].map(|axis| counts[axis] as usize);
        let has_room = |row: usize| {
            (0..x).any(|i| {
                let index = Vector3::new(i as f64, (row % y) as f64, (row / y) as f64);
                let X = lower + step * index;
                distance(&X) <= least && self.body.signed_distance(&X) <= least
            })
        };
        (0..y * z).into_par_iter().any(has_room)
    }
}
