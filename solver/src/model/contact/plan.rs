//! Which nodes may touch the obstacles, and how they are kept out.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Vector3, vector_at};
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::model::essential::Constraints;
use crate::problem::{Friction, Obstacle, ObstacleSide, Problem};

/// The obstacles of a problem and the nodes that may touch them: boundary nodes of
/// which no component is prescribed for ever. A node with a single component that
/// is never released may therefore enter an obstacle ([`ContactPlan::penetrations`]).
#[derive(Debug, Clone, Default)]
pub struct ContactPlan {
    /// As stated in the problem; in a plane their sections.
    pub obstacles: Vec<Obstacle>,
    /// Boundary nodes without a permanently prescribed component.
    pub nodes: Vec<u32>,
    /// The other boundary nodes.
    pub excluded: Vec<u32>,
    /// Candidates are searched again when the body may have moved so far \[m\].
    pub skin: f64,
}

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
        let boundary = (0..cloud.positions.len() as u32).filter(|n| cloud.on_boundary[*n as usize]);
        let (excluded, nodes) = boundary.partition(|node| constraints.always_constrained(*node));
        let skin = cloud.spacing.iter().sum::<f64>() / cloud.spacing.len() as f64;
        let section = |obstacle: &Obstacle| -> Result<Obstacle, Error> {
            let shape = obstacle.shape.section(&problem.dimension)?;
            Ok(Obstacle { shape, ..obstacle.clone() })
        };
        Ok(ContactPlan {
            obstacles: problem.obstacles.iter().map(section).collect::<Result<_, _>>()?,
            nodes,
            excluded,
            skin,
        })
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
                            closed.push((X, normal(obstacle, &x, components)));
                        }
                        Friction::NoSlip => {
                            closed.extend((0..components).map(|k| (X, Vector3::ith(k, 1.0))));
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

/// The unit normal that points out of the obstacle towards the body.
pub(crate) fn normal(obstacle: &Obstacle, x: &Vector3, components: usize) -> Vector3 {
    let mut normal = obstacle.shape.gradient(x);
    if obstacle.side == ObstacleSide::Inside {
        normal = -normal;
    }
    if components == 2 {
        normal.z = 0.0;
    }
    normal.try_normalize(1e-12).unwrap_or_else(Vector3::zeros)
}

/// Gap left after a node is moved to the surface, over the depth of its entry \[–\].
const LEFT_OPEN: f64 = 1e-6;
/// Secants towards the surface; a gap that is a distance needs none.
const MOST_SECANTS: usize = 6;

/// Moves `x` \[m\], where the gap is `opening` \[m\], along the normal to the surface. A gap
/// that is not a distance, as between the samples of a label map, would leave it beside
/// the surface by a length in proportion to its last move, and each change of the step or
/// of the damping would strike all nodes in contact.
pub(crate) fn onto_surface(
    obstacle: &Obstacle,
    x: &Vector3,
    opening: f64,
    components: usize,
) -> Vector3 {
    let n = normal(obstacle, x, components);
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

impl ContactState {
    /// Moves nodes that entered an obstacle back to its surface (method book, eq.
    /// 16.2), on u(t+Δt) as in Horton 2007, section 2.7, keeps their ways as forces, and calls
    /// `on_change(index, Δu)` for each changed entry of `u` \[component of node\]
    /// \[m\], of which none changed by more than `largest_increment` \[m\] before.
    pub fn enforce(
        &mut self,
        plan: &ContactPlan,
        positions: &[Vector3],
        largest_increment: f64,
        u: &mut [f64],
        mut on_change: impl FnMut(usize, f64),
    ) {
        let components = u.len() / positions.len();
        self.travelled += largest_increment * (components as f64).sqrt();
        if !self.searched || self.travelled > plan.skin {
            self.search(plan, positions, u);
        }
        self.touching.clear();
        self.forces.clear();
        for i in 0..self.candidates.len() {
            let (index, node) = self.candidates[i];
            let obstacle = &plan.obstacles[index as usize];
            let x = positions[node as usize] + vector_at(u, node as usize, components);
            let Some(target) = self.target(obstacle, index, node, &x, components) else {
                continue;
            };
            self.touching.push(node);
            self.forces.push(ContactForce { obstacle: index, node, force: target - x });
            for k in 0..components {
                let entry = components * node as usize + k;
                u[entry] += target[k] - x[k];
                on_change(entry, target[k] - x[k]);
            }
        }
    }

    /// Where a node at `x` that has entered the obstacle is moved to: the nearest
    /// point of the surface, or the place where it sticks.
    fn target(
        &mut self,
        obstacle: &Obstacle,
        index: u32,
        node: u32,
        x: &Vector3,
        components: usize,
    ) -> Option<Vector3> {
        let opening = gap(obstacle, x);
        let stuck = self.anchors.iter().position(|anchor| (anchor.0, anchor.1) == (index, node));
        if opening >= 0.0 {
            stuck.map(|index| self.anchors.swap_remove(index));
            return None;
        }
        let nearest = onto_surface(obstacle, x, opening, components);
        match (obstacle.friction, stuck) {
            (Friction::Frictionless, _) => Some(nearest),
            (Friction::NoSlip, Some(index)) => Some(self.anchors[index].2),
            (Friction::NoSlip, None) => {
                self.anchors.push((index, node, nearest));
                Some(nearest)
            }
        }
    }

    /// Lists the nodes with a gap below twice the skin.
    fn search(&mut self, plan: &ContactPlan, positions: &[Vector3], u: &[f64]) {
        let components = u.len() / positions.len();
        self.candidates.clear();
        for (index, obstacle) in plan.obstacles.iter().enumerate() {
            for &node in &plan.nodes {
                let x = positions[node as usize] + vector_at(u, node as usize, components);
                if gap(obstacle, &x) < 2.0 * plan.skin {
                    self.candidates.push((index as u32, node));
                }
            }
        }
        self.travelled = 0.0;
        self.searched = true;
    }
}
