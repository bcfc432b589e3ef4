//! Which nodes touch obstacles, from step to step.
#![allow(non_snake_case)]

use super::impact::{Impacts, Moved};
use super::placed::Placed;
use super::plan::{ContactForce, ContactPlan};
use super::touch::{Touch, settle};
use super::values::Pushed;
use crate::algebra::tensor::Vector3;
use crate::problem::Friction;

/// The state of contact, which evolves from step to step.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub struct ContactState {
    /// Pairs that may touch before the next search, by obstacle and node.
    candidates: Vec<Candidate>,
    /// Bound of the movement of any value since the last search, past any obstacle \[m\].
    travelled: f64,
    searched: bool,
    /// A box around the nodes at the last search, where obstacles move \[m\].
    around: (Vector3, Vector3),
    /// Where a sticking node first touched, or last slid to: (obstacle, node, place as the obstacle
    /// sees it \[m\]).
    anchors: Vec<(u32, u32, Vector3)>,
    #[serde(skip)]
    touches: Vec<Touch>,
    /// m Δu of the values that were pushed in the last step \[kg·m\], by obstacle and node.
    pushes: Vec<ContactForce>,
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

/// A node that may touch an obstacle.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
struct Candidate {
    obstacle: u32,
    /// Of the rows of the plan.
    row: u32,
    /// It cannot have entered before values have travelled so far since the search \[m\].
    clear: f64,
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
    /// m Δu of this step over that of the last one for the same force \[–\].
    pub growth: f64,
}

/// Largest change of a value over that of the largest nodal parameter, along each axis \[–\]: shape
/// functions are negative in places.
const OF_VALUES: f64 = 2.0;

impl ContactState {
    /// Moves nodes that entered an obstacle back to its surface, on values of u(t+Δt) with
    /// their velocities, and keeps m Δu as forces (method book, eq. 16.2). No entry of `u` changed by
    /// more than `largest_increment` \[m\] before.
    pub fn enforce(
        &mut self,
        plan: &ContactPlan,
        positions: &[Vector3],
        largest_increment: f64,
        step: ContactStep,
    ) {
        let travelled = plan.bound(largest_increment) + plan.travel(step.times, self.around);
        self.travelled += travelled;
        let search = !self.searched || self.travelled > plan.mean_spacing;
        if search {
            self.search(plan, positions, &step, travelled);
        }
        let mut touches = std::mem::take(&mut self.touches);
        touches.clear();
        let mut here: Option<Here> = None;
        for index in 0..self.candidates.len() {
            let Candidate { obstacle, row, clear } = self.candidates[index];
            if self.travelled < clear {
                continue;
            }
            let here = match &here {
                Some(known) if known.index == obstacle => known,
                _ => here.insert(Here::new(plan, obstacle, step.times)),
            };
            let X = &positions[plan.nodes[row as usize] as usize];
            let (gap, touch) = self.touch(plan, here, (row, X), &step);
            self.candidates[index].clear = self.travelled + gap;
            touches.extend(touch);
        }
        self.start(&mut touches, step.growth);
        let (t, ContactStep { mass, displacement, velocity, time_step, .. }) = (step.times.1, step);
        let mut pushed = Pushed { mass, displacement, velocity, time_step };
        settle(&mut touches, plan, (positions, t), &mut pushed);
        touches.retain(|touch| self.is_kept(touch));
        self.keep(plan, positions, &touches, t, displacement);
        if search {
            self.look(plan, positions, t, displacement);
        }
        self.touches = touches;
    }

    /// Notes that nodal parameters have moved by so much more in the step \[m\].
    pub(crate) fn has_moved(&mut self, plan: &ContactPlan, more: f64) {
        self.travelled += plan.bound(more.max(0.0));
    }

    /// Adds the forces on nodes \[component of node\] of what obstacles exert on values, times a factor.
    pub(crate) fn add_forces(&self, plan: &ContactPlan, factor: f64, forces: &mut [f64]) {
        for ContactForce { node, force, .. } in &self.pushes {
            plan.row_of(*node).iter().for_each(|row| plan.add(*row, &(factor * force), forces));
        }
    }

    /// What impacts keep of the pushes of a step.
    pub(crate) fn settle_impacts(&mut self, plan: &ContactPlan, moved: Moved) {
        self.impacts.settle(plan, &self.touches, moved);
    }

    /// Keeps which narrow obstacles have gone in between nodes that were put back.
    fn look(&mut self, plan: &ContactPlan, positions: &[Vector3], t: f64, u: &[f64]) {
        for (index, place) in plan.between_nodes(positions, t, u) {
            if self.entered.iter().all(|(known, _)| *known != index) {
                self.entered.push((index, place));
            }
        }
    }

    /// The gap of a node in an obstacle \[m\], and what is to be done if it has entered, or, where the
    /// obstacle is narrow, passed it.
    fn touch(
        &mut self,
        plan: &ContactPlan,
        Here { index, before, now }: &Here,
        (row, X): (u32, &Vector3),
        step: &ContactStep,
    ) -> (f64, Option<Touch>) {
        let (node, friction) = (plan.nodes[row as usize], now.obstacle.friction);
        let at = plan.value(row, step.displacement);
        let (x, free) = (X + at, plan.free(node));
        let gap = now.gap(&x);
        let rubs = friction != Friction::Frictionless;
        let looks_back = plan.width(*index).is_some() || (gap < 0.0 && rubs);
        let moved = if looks_back { plan.value(row, step.velocity) } else { Vector3::zeros() };
        let last = x - step.time_step * moved;
        let entered = plan.crossing(*index, (before, &last), (now, &x));
        if gap >= 0.0 && entered.is_none() {
            self.forget_anchor(*index, node);
            return (gap, None);
        }
        let (from, depth) = entered.map_or((x, gap), |x| (x, now.gap(&x)));
        let (normal, nearest) = (now.normal(&from, free), now.onto_surface(&from, depth, free));
        if nearest == x {
            return (gap, None);
        }
        // In the step in which it touches it would, without slip, not move along the surface.
        let anchor = self.anchors.iter().find(|anchor| (anchor.0, anchor.1) == (*index, node));
        let anchor = anchor.map_or_else(|| before.own(&last), |anchor| anchor.2);
        let touch = Touch {
            obstacle: *index,
            node,
            row,
            free,
            normal,
            gap: (x - nearest).dot(&normal),
            at,
            back: now.now(&anchor) - x,
            anchor,
            friction,
            mobility: plan.mobility(row, step.mass),
            push: Vector3::zeros(),
        };
        (gap.min(0.0), Some(touch))
    }

    fn forget_anchor(&mut self, obstacle: u32, node: u32) {
        self.anchors.retain(|anchor| (anchor.0, anchor.1) != (obstacle, node));
    }

    /// Begins with the pushes of the last step.
    fn start(&self, touches: &mut [Touch], growth: f64) {
        let mut known = self.pushes.iter().peekable();
        for touch in touches {
            let pair = (touch.obstacle, touch.node);
            while known.next_if(|push| (push.obstacle, push.node) < pair).is_some() {}
            if let Some(push) = known.next_if(|push| (push.obstacle, push.node) == pair) {
                touch.begin(&(growth * push.force));
            }
        }
    }

    /// Whether an obstacle pushes a node in the end; if not, it sticks no longer.
    fn is_kept(&mut self, touch: &Touch) -> bool {
        if !touch.is_closed() {
            self.forget_anchor(touch.obstacle, touch.node);
        }
        touch.is_closed()
    }

    /// Keeps what the pushes of a step were, and where nodes stick.
    fn keep(
        &mut self,
        plan: &ContactPlan,
        positions: &[Vector3],
        touches: &[Touch],
        t: f64,
        u: &[f64],
    ) {
        self.touching.clear();
        self.forces.clear();
        self.pushes.clear();
        for touch in touches {
            let &Touch { obstacle, node, row, push, .. } = touch;
            self.touching.push(node);
            self.pushes.push(ContactForce { obstacle, node, force: push });
            let force = push.component_mul(&plan.share(row));
            self.forces.push(ContactForce { obstacle, node, force });
            if touch.friction == Friction::Frictionless {
                continue;
            }
            let x = plan.place_of(row, positions, u);
            let anchor =
                if touch.holds() { touch.anchor } else { plan.placed(obstacle, t).own(&x) };
            match self.anchors.iter_mut().find(|known| (known.0, known.1) == (obstacle, node)) {
                Some(known) => known.2 = anchor,
                None => self.anchors.push((obstacle, node, anchor)),
            }
        }
    }

    /// Lists the nodes with a gap below twice the mean spacing, before the last step too.
    fn search(
        &mut self,
        plan: &ContactPlan,
        positions: &[Vector3],
        step: &ContactStep,
        travelled: f64,
    ) {
        self.candidates.clear();
        for (obstacle, placed) in plan.all_placed(step.times.1) {
            for row in 0..plan.nodes.len() as u32 {
                let place = plan.place_of(row, positions, step.displacement);
                if placed.gap(&place) < 2.0 * plan.mean_spacing + travelled {
                    self.candidates.push(Candidate { obstacle, row, clear: 0.0 });
                }
            }
        }
        if plan.has_moving() {
            let (lower, upper) = plan.around(positions, step.displacement);
            let margin = Vector3::repeat(2.0 * plan.mean_spacing);
            self.around = (lower - margin, upper + margin);
        }
        self.travelled = 0.0;
        self.searched = true;
    }
}

impl ContactPlan {
    /// Bound of the change of a value where no nodal parameter changes by more \[m\].
    fn bound(&self, largest_increment: f64) -> f64 {
        OF_VALUES * largest_increment * (self.components as f64).sqrt()
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
