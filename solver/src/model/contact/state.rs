//! Nodes that have entered an obstacle, and what puts them back.
#![allow(non_snake_case)]

use super::impact::Impacts;
use super::placed::Placed;
use super::plan::{Components, ContactForce, ContactPlan};
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
    /// A box around the nodes at the last search \[m\].
    around: (Vector3, Vector3),
    /// Where a sticking node first touched, or last slid to: (obstacle, node, place as the obstacle
    /// sees it \[m\]).
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
    /// Times of amplitudes before the step and after it \[s\].
    pub times: (f64, f64),
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
        self.travelled += increment + plan.travel(step.times, self.around);
        let search = !self.searched || self.travelled > plan.mean_spacing;
        if search {
            self.search(plan, positions, &step, increment);
        }
        self.touching.clear();
        self.forces.clear();
        let mut here: Option<Here> = None;
        for i in 0..self.candidates.len() {
            let (obstacle, node) = self.candidates[i];
            let here = match &here {
                Some(known) if known.index == obstacle => known,
                _ => here.insert(Here::new(plan, obstacle, step.times)),
            };
            let x =
                positions[node as usize] + vector_at(step.displacement, node as usize, components);
            let moved = step.time_step * vector_at(step.velocity, node as usize, components);
            let target = self.target(plan, (here, node), &x, &moved);
            let Some(target) = target else { continue };
            self.touching.push(node);
            let force = step.push(node, target - x);
            self.forces.push(ContactForce { obstacle, node, force });
        }
        if search {
            self.look(plan, positions, step.times.1, step.displacement);
        }
    }

    /// Keeps which narrow obstacles have gone in between nodes that were put back.
    fn look(&mut self, plan: &ContactPlan, positions: &[Vector3], t: f64, u: &[f64]) {
        for (index, place) in plan.between_nodes(positions, t, u) {
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
        (here, node): (&Here, u32),
        x: &Vector3,
        moved: &Vector3,
    ) -> Option<Vector3> {
        let Here { index, before, now } = here;
        let free = plan.free(node);
        let opening = now.gap(x);
        let stuck = self.anchors.iter().position(|anchor| (anchor.0, anchor.1) == (*index, node));
        let entered = plan.crossing(*index, (before, &(x - moved)), (now, x));
        if opening >= 0.0 && entered.is_none() {
            stuck.map(|index| self.anchors.swap_remove(index));
            return None;
        }
        let (from, depth) = entered.map_or((*x, opening), |x| (x, now.gap(&x)));
        let nearest = now.onto_surface(&from, depth, free);
        if nearest == *x {
            return None;
        }
        let anchor = stuck.map(|index| self.anchors[index].2);
        let (target, anchor) = match (now.obstacle.friction, anchor) {
            (Friction::Frictionless, _) => return Some(nearest),
            (Friction::NoSlip, None) => (nearest, now.own(&nearest)),
            (Friction::NoSlip, Some(anchor)) => {
                let place = now.now(&anchor);
                (Vector3::from_fn(|k, _| if free[k] { place[k] } else { x[k] }), anchor)
            }
            (Friction::Coulomb(coefficient), anchor) => {
                // In the step in which it touches it would, without slip, not move along the surface.
                let last = anchor.unwrap_or_else(|| before.own(&(x - moved)));
                let (target, holds) = rub(now, coefficient, (x, &nearest), &now.now(&last), free);
                (target, if holds { last } else { now.own(&target) })
            }
        };
        match stuck {
            Some(index) => self.anchors[index].2 = anchor,
            None => self.anchors.push((*index, node, anchor)),
        }
        Some(target)
    }

    /// Lists the nodes with a gap below twice the mean spacing, before the last step too.
    fn search(
        &mut self,
        plan: &ContactPlan,
        positions: &[Vector3],
        step: &ContactStep,
        increment: f64,
    ) {
        let components = step.displacement.len() / positions.len();
        let place = |node: usize| positions[node] + vector_at(step.displacement, node, components);
        self.candidates.clear();
        for (index, placed) in plan.all_placed(step.times.1) {
            for &node in &plan.nodes {
                if placed.gap(&place(node as usize)) < 2.0 * plan.mean_spacing + increment {
                    self.candidates.push((index, node));
                }
            }
        }
        let first = (place(0), place(0));
        let within = |(l, u): (Vector3, Vector3), x: Vector3| (l.inf(&x), u.sup(&x));
        let (lower, upper) = (1..positions.len()).map(place).fold(first, within);
        let margin = Vector3::repeat(2.0 * plan.mean_spacing);
        self.around = (lower - margin, upper + margin);
        self.travelled = 0.0;
        self.searched = true;
    }
}

/// An obstacle before a step and after it.
struct Here<'a> {
    index: u32,
    before: Placed<'a>,
    now: Placed<'a>,
}

impl Here<'_> {
    fn new(plan: &ContactPlan, index: u32, (before, now): (f64, f64)) -> Here<'_> {
        Here { index, before: plan.placed(index, before), now: plan.placed(index, now) }
    }
}

/// Where friction leaves a node at `x` that the obstacle pushes to the `nearest` place of its
/// surface and that would be at `last` without slip \[m\], and whether it holds the node there
/// (method book, eq. 16.6).
fn rub(
    now: &Placed,
    coefficient: f64,
    (x, nearest): (&Vector3, &Vector3),
    last: &Vector3,
    free: Components,
) -> (Vector3, bool) {
    let n = now.normal(nearest, free);
    let push = (nearest - x).norm();
    let back = Vector3::from_fn(|k, _| if free[k] { last[k] - x[k] } else { 0.0 });
    let along = back - n * back.dot(&n);
    let part = (coefficient * push / along.norm()).min(1.0);
    let beside = nearest + part * along;
    (now.onto_surface(&beside, now.gap(&beside), free), part == 1.0)
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
