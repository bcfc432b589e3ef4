//! Nodes that have entered an obstacle, and what puts them back.
#![allow(non_snake_case)]

use super::impact::Impacts;
use super::plan::{ContactForce, ContactPlan, gap, onto_surface};
use crate::algebra::tensor::{Vector3, vector_at};
use crate::problem::Friction;

/// The state of contact, which evolves from step to step.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
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
    /// Narrow obstacles that were seen between the nodes of the body: obstacle, its place then \[m\].
    pub entered: Vec<(u32, Vector3)>,
    /// What strikes have taken from nodes; only of motions.
    pub impacts: Impacts,
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
        let search = !self.searched || self.travelled > plan.mean_spacing;
        if search {
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
        if search {
            self.look(plan, positions, step.displacement);
        }
    }

    /// Keeps which narrow obstacles have gone in between nodes that were put back.
    fn look(&mut self, plan: &ContactPlan, positions: &[Vector3], u: &[f64]) {
        for (index, place) in plan.between_nodes(positions, u) {
            if self.entered.iter().all(|(known, _)| *known != index) {
                self.entered.push((index, place));
            }
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

    /// Lists the nodes with a gap below twice the mean spacing, before the last step too.
    fn search(&mut self, plan: &ContactPlan, positions: &[Vector3], u: &[f64], increment: f64) {
        let components = u.len() / positions.len();
        self.candidates.clear();
        for (index, obstacle) in plan.obstacles.iter().enumerate() {
            for &node in &plan.nodes {
                let x = positions[node as usize] + vector_at(u, node as usize, components);
                if gap(obstacle, &x) < 2.0 * plan.mean_spacing + increment {
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
