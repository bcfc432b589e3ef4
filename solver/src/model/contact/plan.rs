//! Which nodes may touch the obstacles, and how they are kept out.
#![allow(non_snake_case)]

use super::between::{Outside, narrow};
use super::impact::Impacts;
use crate::algebra::tensor::{Vector3, vector_at};
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::model::essential::Constraints;
use crate::problem::{Friction, Obstacle, ObstacleSide, Problem};

/// The obstacles of a problem and the nodes that may touch them: boundary nodes of
/// which some component is not prescribed for ever. Obstacles push them in such components
/// only, as on a plane of symmetry; where an obstacle faces along the others, a node may
/// therefore enter it ([`ContactPlan::penetrations`]).
#[derive(Debug, Clone, Default)]
pub struct ContactPlan {
    /// As stated in the problem; in a plane their sections.
    pub obstacles: Vec<Obstacle>,
    /// Boundary nodes with a component that is not prescribed for ever.
    pub nodes: Vec<u32>,
    /// Boundary nodes with a component that is.
    pub held: Vec<u32>,
    /// Which components obstacles may push \[node\]\[component\].
    free: Vec<Components>,
    /// Candidates are searched again when the body may have moved so far \[m\].
    pub skin: f64,
    /// Widths of obstacles that nodes alone may miss \[obstacle\] \[m\].
    pub(super) narrow: Vec<Option<f64>>,
    /// The body whose surface they may enter between nodes; none where there are no such obstacles.
    pub(super) outside: Option<Outside>,
}

/// A choice of components.
pub(crate) type Components = [bool; 3];

/// The state of contact, which evolves from step to step.
#[derive(Debug, Clone, Default)]
pub struct ContactState {
    /// (obstacle, node) pairs that may touch before the next search.
    candidates: Vec<(u32, u32)>,
    /// Bound of the movement of any node since the last search \[m\].
    travelled: f64,
    searched: bool,
    /// Where a sticking node first touched: (obstacle, node, current position).
    anchors: Vec<(u32, u32, Vector3)>,
    /// Nodes in contact after the last step.
    pub touching: Vec<u32>,
    /// What obstacles exert, to be multiplied by the force factor of the state: the values
    /// are m Δu of the last step \[kg·m\], or of Newton's method forces \[N\].
    pub forces: Vec<ContactForce>,
    /// What strikes have taken from nodes; only of motions.
    pub impacts: Impacts,
}

/// What an obstacle exerts on a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactForce {
    /// Index of the obstacle.
    pub obstacle: u32,
    /// The node.
    pub node: u32,
    /// \[N\]
    pub force: Vector3,
}

impl ContactPlan {
    /// Selects the nodes; without obstacles the plan is empty.
    pub fn new(
        problem: &Problem,
        discretisation: &Discretisation,
        constraints: &Constraints,
    ) -> Result<ContactPlan, Error> {
        let cloud = &discretisation.cloud;
        if problem.obstacles.is_empty() {
            return Ok(ContactPlan::default());
        }
        let components = problem.dimension.components();
        let all = 0..cloud.positions.len() as u32;
        let free: Vec<Components> = (all.clone())
            .map(|node| {
                [0, 1, 2].map(|k| k < components && !constraints.always_prescribes(node, k))
            })
            .collect();
        let boundary = || all.clone().filter(|node| cloud.on_boundary[*node as usize]);
        let count = |node: u32| free[node as usize].iter().filter(|free| **free).count();
        let nodes = boundary().filter(|node| count(*node) > 0).collect();
        let held = boundary().filter(|node| count(*node) < components).collect();
        let skin = cloud.spacing.iter().sum::<f64>() / cloud.spacing.len() as f64;
        let section = |obstacle: &Obstacle| -> Result<Obstacle, Error> {
            let shape = obstacle.shape.section(&problem.dimension)?;
            Ok(Obstacle { shape, ..obstacle.clone() })
        };
        let obstacles: Vec<Obstacle> =
            problem.obstacles.iter().map(section).collect::<Result<_, _>>()?;
        let around = problem.body.bounding_box();
        let narrow: Vec<Option<f64>> =
            obstacles.iter().map(|obstacle| narrow(obstacle, around, skin)).collect();
        let outside = narrow.iter().any(Option::is_some).then(|| Outside::new(problem));
        Ok(ContactPlan { obstacles, nodes, held, free, skin, narrow, outside })
    }

    /// Which components of a node obstacles may push.
    pub(crate) fn free(&self, node: u32) -> Components {
        self.free[node as usize]
    }
}

/// Gap over the mean nodal spacing below which a contact is closed \[–\].
const CLOSED: f64 = 1e-6;

impl ContactPlan {
    /// Reference positions \[m\] of nodes in contact at displacements `u` \[component of
    /// node\] \[m\], with the directions in which obstacles hold them.
    pub fn closed(&self, positions: &[Vector3], u: &[f64]) -> Vec<(Vector3, Vector3)> {
        let components = u.len() / positions.len();
        let mut closed = Vec::new();
        for obstacle in &self.obstacles {
            for &node in &self.nodes {
                let X = positions[node as usize];
                let x = X + vector_at(u, node as usize, components);
                if gap(obstacle, &x) < CLOSED * self.skin {
                    match obstacle.friction {
                        Friction::Frictionless => {
                            closed.push((X, normal(obstacle, &x, self.free(node))));
                        }
                        Friction::NoSlip => {
                            let free = self.free(node);
                            let along = (0..3).filter(|k| free[*k]);
                            closed.extend(along.map(|k| (X, Vector3::ith(k, 1.0))));
                        }
                    }
                }
            }
        }
        closed
    }
}

/// Signed gap \[m\] at current position `x` \[m\], open if positive (method book,
/// eq. 16.1).
pub fn gap(obstacle: &Obstacle, x: &Vector3) -> f64 {
    let distance = obstacle.shape.signed_distance(x) - obstacle.offset;
    match obstacle.side {
        ObstacleSide::Outside => distance,
        ObstacleSide::Inside => -distance,
    }
}

/// Least part of a normal in the free components, over its length, with which an obstacle
/// pushes \[–\].
const PUSHES: f64 = 0.1;

/// The unit normal that points out of the obstacle towards the body, in the free components
/// (method book, eq. 16.3); zero where the obstacle faces along the others.
pub(crate) fn normal(obstacle: &Obstacle, x: &Vector3, free: Components) -> Vector3 {
    let outward = match obstacle.side {
        ObstacleSide::Outside => obstacle.shape.gradient(x),
        ObstacleSide::Inside => -obstacle.shape.gradient(x),
    };
    let part = Vector3::from_fn(|k, _| if free[k] { outward[k] } else { 0.0 });
    let least = (PUSHES * outward.norm()).max(1e-12);
    part.try_normalize(least).unwrap_or_else(Vector3::zeros)
}

/// Gap left after a node is moved to the surface, over the depth of its entry \[–\].
const LEFT_OPEN: f64 = 1e-6;
/// Secants towards the surface; a gap that is a distance needs none.
const MOST_SECANTS: usize = 6;

/// Moves `x` \[m\], where the gap is `opening` \[m\], along the normal to the surface; where that
/// is zero, `x` stays. A gap that is not a distance, as between the samples of a label map, would leave it beside
/// the surface by a length in proportion to its last move, and each change of the step or
/// of the damping would strike all nodes in contact.
pub(crate) fn onto_surface(
    obstacle: &Obstacle,
    x: &Vector3,
    opening: f64,
    free: Components,
) -> Vector3 {
    let n = normal(obstacle, x, free);
    let (mut last, mut moved) = ((0.0, opening), -opening);
    for _ in 0..MOST_SECANTS {
        let left = gap(obstacle, &(x + n * moved));
        let slope = (left - last.1) / (moved - last.0);
        if left.abs() <= LEFT_OPEN * opening.abs() || slope.is_nan() || slope < 0.1 {
            break;
        }
        last = (moved, left);
        moved -= left / slope;
    }
    x + n * moved
}

/// The step that contact corrects.
pub struct ContactStep<'a> {
    /// \[node\] \[kg\]
    pub mass: &'a [f64],
    /// \[component of node\] \[m\]
    pub displacement: &'a mut [f64],
    /// \[component of node\] \[m/s\]
    pub velocity: &'a mut [f64],
    /// \[s\]
    pub time_step: f64,
}

impl ContactState {
    /// Moves nodes that entered an obstacle back to its surface (method book, eq.
    /// 16.2), on u(t+Δt) as in Horton 2007, section 2.7, with their velocities, and keeps
    /// m Δu as forces. No entry of `u` changed by more than `largest_increment` \[m\] before.
    pub fn enforce(
        &mut self,
        plan: &ContactPlan,
        positions: &[Vector3],
        largest_increment: f64,
        mut step: ContactStep,
    ) {
        let components = step.displacement.len() / positions.len();
        let increment = largest_increment * (components as f64).sqrt();
        self.travelled += increment;
        if !self.searched || self.travelled > plan.skin {
            self.search(plan, positions, step.displacement, increment);
        }
        self.touching.clear();
        self.forces.clear();
        for i in 0..self.candidates.len() {
            let (obstacle, node) = self.candidates[i];
            let x =
                positions[node as usize] + vector_at(step.displacement, node as usize, components);
            let moved = step.time_step * vector_at(step.velocity, node as usize, components);
            let target = self.target(plan, (obstacle, node), &x, &moved);
            let Some(target) = target else { continue };
            self.touching.push(node);
            let force = step.push(node, target - x);
            self.forces.push(ContactForce { obstacle, node, force });
        }
    }

    /// Where a node at `x` that has entered the obstacle, in a step in which it has `moved` \[m\],
    /// is put: the nearest point of the surface, that where it went in if it passed the middle
    /// of a narrow one, or the place where it sticks. None if the obstacle cannot push it.
    fn target(
        &mut self,
        plan: &ContactPlan,
        pair: (u32, u32),
        x: &Vector3,
        moved: &Vector3,
    ) -> Option<Vector3> {
        let (obstacle, free) = (&plan.obstacles[pair.0 as usize], plan.free(pair.1));
        let opening = gap(obstacle, x);
        let stuck = self.anchors.iter().position(|anchor| (anchor.0, anchor.1) == pair);
        let entered = plan.crossing(pair.0, &(x - moved), x);
        if opening >= 0.0 && entered.is_none() {
            stuck.map(|index| self.anchors.swap_remove(index));
            return None;
        }
        let (from, depth) = entered.map_or((*x, opening), |x| (x, gap(obstacle, &x)));
        let nearest = onto_surface(obstacle, &from, depth, free);
        if nearest == *x {
            return None;
        }
        match (obstacle.friction, stuck) {
            (Friction::Frictionless, _) => Some(nearest),
            (Friction::NoSlip, Some(index)) => {
                let anchor = &self.anchors[index].2;
                Some(Vector3::from_fn(|k, _| if free[k] { anchor[k] } else { x[k] }))
            }
            (Friction::NoSlip, None) => {
                self.anchors.push((pair.0, pair.1, nearest));
                Some(nearest)
            }
        }
    }

    /// Lists the nodes with a gap below twice the skin, before the last step too.
    fn search(&mut self, plan: &ContactPlan, positions: &[Vector3], u: &[f64], increment: f64) {
        let components = u.len() / positions.len();
        self.candidates.clear();
        for (index, obstacle) in plan.obstacles.iter().enumerate() {
            for &node in &plan.nodes {
                let x = positions[node as usize] + vector_at(u, node as usize, components);
                if gap(obstacle, &x) < 2.0 * plan.skin + increment {
                    self.candidates.push((index as u32, node));
                }
            }
        }
        self.travelled = 0.0;
        self.searched = true;
    }
}

impl ContactStep<'_> {
    /// Moves a node by `way` \[m\], and changes its velocity with it; returns m Δu.
    fn push(&mut self, node: u32, way: Vector3) -> Vector3 {
        let components = self.displacement.len() / self.mass.len();
        let rate = 1.0 / self.time_step;
        for k in 0..components {
            let entry = components * node as usize + k;
            self.displacement[entry] += way[k];
            self.velocity[entry] += way[k] * rate;
        }
        way * self.mass[node as usize]
    }
}
