//! Obstacles that contradict the body or its conditions.
#![allow(non_snake_case)]

use super::placed::{Placed, instants};
use super::plan::ContactPlan;
use crate::algebra::tensor::{Vector3, bounding_box, vector_at};
use crate::discretisation::Warning;
use crate::discretisation::nodes::NodeCloud;
use crate::error::Error;
use crate::model::essential::Constraints;
use crate::problem::{Obstacle, ObstacleSide};
use rayon::prelude::*;

/// Nodes may be this deep in an obstacle, over their spacing \[–\]: the distance of an
/// image or a coarse surface is not exact.
const DEEPEST: f64 = 0.1;
/// Less than this is round-off \[–\].
const ROUND_OFF: f64 = 1e-3;
/// Samples of an obstacle along each axis.
const SAMPLES: usize = 24;

/// Nodes inside an obstacle.
struct Inside {
    nodes: usize,
    /// The deepest of them.
    node: usize,
    /// \[m\]
    depth: f64,
}

impl Inside {
    /// Nodes with a gap below −`part` of their spacing.
    fn of(gaps: impl Iterator<Item = (usize, f64)>, part: f64, spacing: &[f64]) -> Option<Inside> {
        let deep = gaps.filter(|(node, gap)| *gap < -part * spacing[*node]);
        deep.fold(None, |inside: Option<Inside>, (node, gap)| {
            let (nodes, deepest) = inside.map_or((0, None), |i| (i.nodes, Some(i)));
            let deepest = deepest.filter(|inside| inside.depth >= -gap);
            let Inside { node, depth, .. } = deepest.unwrap_or(Inside { nodes, node, depth: -gap });
            Some(Inside { nodes: nodes + 1, node, depth })
        })
    }
}

/// Refuses an obstacle of which nothing is left, one that nodes are inside of at the start,
/// and one that conditions move nodes into before time `end` \[s\]. Nodes that are slightly
/// inside give a warning.
pub(crate) fn check_obstacles(
    plan: &ContactPlan,
    cloud: &NodeCloud,
    constraints: &Constraints,
    components: usize,
    end: f64,
) -> Result<Vec<Warning>, Error> {
    let mut warnings = Vec::new();
    for (index, placed) in plan.all_placed(0.0) {
        let obstacle = placed.obstacle;
        if is_empty(obstacle) {
            return Err(Error::EmptyObstacle { name: obstacle.name.clone() });
        }
        let gaps: Vec<f64> = cloud.positions.par_iter().map(|X| placed.gap(X)).collect();
        let at_start = || gaps.iter().copied().enumerate();
        if let Some(inside) = Inside::of(at_start(), DEEPEST, &cloud.spacing) {
            let Inside { nodes, node, depth } = inside;
            let (name, position) = (obstacle.name.clone(), cloud.positions[node]);
            return Err(Error::NodesInObstacle { name, nodes, node, position, depth });
        }
        if let Some(inside) = Inside::of(at_start(), ROUND_OFF, &cloud.spacing) {
            let (name, position) = (obstacle.name.clone(), cloud.positions[inside.node]);
            let Inside { nodes, node, depth } = inside;
            warnings.push(Warning::StartInsideObstacle { name, nodes, node, position, depth });
        }
        refuse_driven((plan, index), &gaps, cloud, constraints, components, end)?;
    }
    Ok(warnings)
}

/// Refuses conditions that move nodes into an obstacle, from `gaps` \[node\] \[m\] at the start.
fn refuse_driven(
    (plan, index): (&ContactPlan, u32),
    gaps: &[f64],
    cloud: &NodeCloud,
    constraints: &Constraints,
    components: usize,
    end: f64,
) -> Result<(), Error> {
    let around = bounding_box(&cloud.positions);
    for time in instants(end) {
        let (placed, travelled) = (plan.placed(index, time), plan.travel((0.0, time), around));
        let prescribed = constraints.prescribed_nodes(time, components, &cloud.positions);
        // A gap shrinks no faster than its node and the obstacle move.
        let near = prescribed
            .par_iter()
            .filter(|(node, u, _)| u.norm() + travelled > gaps[*node as usize]);
        let driven: Vec<(usize, f64)> = near
            .map(|(node, u, _)| {
                (*node as usize, placed.gap(&(cloud.positions[*node as usize] + u)))
            })
            .collect();
        let inside = Inside::of(driven.into_iter(), DEEPEST, &cloud.spacing);
        if let Some(Inside { nodes, node, depth }) = inside {
            let index = prescribed.binary_search_by_key(&(node as u32), |(node, ..)| *node);
            let condition = index.map_or(0, |index| prescribed[index].2);
            return Err(Error::DrivenIntoObstacle {
                condition: constraints.conditions[condition as usize].name.clone(),
                obstacle: placed.obstacle.name.clone(),
                nodes,
                node,
                position: cloud.positions[node],
                depth,
                time,
            });
        }
    }
    Ok(())
}

/// Whether surely nothing is inside a solid: no distance falls by more than the way to the
/// nearest sample.
fn is_empty(obstacle: &Obstacle) -> bool {
    let shape = &obstacle.shape;
    let (Some((lower, upper)), ObstacleSide::Outside) = (shape.bounding_box(), obstacle.side)
    else {
        return false;
    };
    // A plane cross-section is the same at every z.
    let step = (upper - lower).map(|e| if e.is_finite() { e / SAMPLES as f64 } else { 0.0 });
    let origin = lower.map(|c| if c.is_finite() { c } else { 0.0 });
    let counts = step.map(|step| if step > 0.0 { SAMPLES } else { 1 });
    let sample = |n: usize| {
        let ijk = [n % counts.x, n / counts.x % counts.y, n / (counts.x * counts.y)];
        origin + Vector3::from_fn(|k, _| (ijk[k] as f64 + 0.5) * step[k])
    };
    let reach = obstacle.offset + 0.5 * step.norm();
    let samples = counts.iter().product::<usize>();
    (0..samples).into_par_iter().all(|n| shape.signed_distance(&sample(n)) > reach)
}

impl ContactPlan {
    /// Warnings of nodes that are inside an obstacle at time `t` \[s\] and nodal parameters `u` \[component of
    /// node\] \[m\] because conditions hold them in the way in which the obstacle would push.
    pub fn penetrations(&self, positions: &[Vector3], t: f64, u: &[f64]) -> Vec<Warning> {
        let components = u.len() / positions.len();
        let spacing = vec![self.mean_spacing; positions.len()];
        let warning = |(_, placed): (u32, Placed)| {
            let gaps = self.held.iter().map(|&node| {
                let node = node as usize;
                (node, placed.gap(&(positions[node] + vector_at(u, node, components))))
            });
            let Inside { nodes, node, depth } = Inside::of(gaps, DEEPEST, &spacing)?;
            let (name, position) = (placed.obstacle.name.clone(), positions[node]);
            Some(Warning::EndInsideObstacle { name, nodes, node, position, depth })
        };
        self.all_placed(t).filter_map(warning).collect()
    }
}
