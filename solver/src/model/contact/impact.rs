//! Kinetic energy of nodes that strike an obstacle: kept while they touch it, given back when
//! they leave (method book, eqs. 16.4 and 16.5).

use super::placed::Placed;
use super::plan::{ContactForce, ContactPlan};
use crate::algebra::tensor::{Vector3, vector_at};
use crate::problem::Friction;

/// The energy that contact takes from the nodes of a motion, and what becomes of it.
///
/// A lumped node that meets a rigid obstacle stops at once, and half of its mass times the
/// square of its normal velocity is gone, however small the step; it falls with the spacing
/// alone. Here that energy stays with the node as if in a stiff spring.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub struct Impacts {
    /// Velocities before the step \[component of node\] \[m/s\].
    before: Vec<f64>,
    /// By obstacle and node.
    kept: Vec<Kept>,
    scratch: Vec<Kept>,
    /// Whether an obstacle pushes, of each node.
    pushed: Vec<bool>,
    /// What contact has given to the nodes \[J\].
    pub work: f64,
    /// Of it, what damping has taken from kept energy \[J\].
    pub damped: f64,
    /// Taken for good \[J\]: of motion along obstacles without slip, and what the path along
    /// a curved surface costs in steps of finite length.
    pub lost: f64,
    /// Largest kinetic energy of the body while it touched \[J\].
    pub largest_kinetic: f64,
}

/// What an obstacle keeps of a node.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
struct Kept {
    obstacle: u32,
    node: u32,
    /// \[J\]
    energy: f64,
}

/// The nodes of a step, which contact has already pushed.
pub(crate) struct Moved<'a> {
    pub positions: &'a [Vector3],
    /// \[node\] \[kg\]
    pub mass: &'a [f64],
    /// \[component of node\] \[m\]
    pub displacement: &'a mut [f64],
    /// \[component of node\] \[m/s\]
    pub velocity: &'a mut [f64],
    /// Times before the step and after it \[s\].
    pub times: (f64, f64),
    /// \[s\]
    pub time_step: f64,
    /// Factor that damping leaves of a velocity in the step \[–\].
    pub keep: f64,
}

impl Impacts {
    /// For a motion of `components` per node that begins with these velocities \[m/s\].
    pub(crate) fn new(velocity: &[f64], components: usize) -> Impacts {
        Impacts {
            before: velocity.to_vec(),
            pushed: vec![false; velocity.len() / components],
            ..Impacts::default()
        }
    }

    /// Whether energies are kept, as in motions alone.
    pub fn is_active(&self) -> bool {
        !self.before.is_empty()
    }

    /// Kept by all obstacles \[J\].
    pub fn stored(&self) -> f64 {
        self.kept.iter().map(|kept| kept.energy).sum()
    }

    /// Notes the velocities before a step \[m/s\].
    pub(crate) fn begin(&mut self, velocity: &[f64]) {
        if self.is_active() {
            self.before.copy_from_slice(velocity);
        }
    }

    /// Keeps what the `pushes` m Δu \[kg·m\] of a step, by obstacle and node, have taken from the
    /// nodes, and gives back what is kept of nodes that nothing pushes any more.
    pub(crate) fn settle(&mut self, plan: &ContactPlan, pushes: &[ContactForce], moved: Moved) {
        if !self.is_active() || pushes.is_empty() && self.kept.is_empty() {
            return;
        }
        self.largest_kinetic = self.largest_kinetic.max(moved.kinetic());
        let before = std::mem::take(&mut self.kept);
        let mut after = std::mem::take(&mut self.scratch);
        after.clear();
        pushes.iter().for_each(|push| self.pushed[push.node as usize] = true);
        let mut moved = moved;
        let mut known = before.iter().peekable();
        let key = |kept: &Kept| (kept.obstacle, kept.node);
        for push in pushes {
            let pair = (push.obstacle, push.node);
            while let Some(kept) = known.next_if(|kept| key(kept) < pair) {
                after.extend(self.leave(plan, kept, &mut moved));
            }
            let kept = known.next_if(|kept| key(kept) == pair).map_or(0.0, |kept| kept.energy);
            let energy = self.damp(kept, moved.keep) + self.strike(plan, push, &moved);
            after.push(Kept { obstacle: push.obstacle, node: push.node, energy });
        }
        for kept in known {
            after.extend(self.leave(plan, kept, &mut moved));
        }
        pushes.iter().for_each(|push| self.pushed[push.node as usize] = false);
        (self.kept, self.scratch) = (after, before);
    }

    /// What damping leaves of an energy \[J\].
    fn damp(&mut self, energy: f64, keep: f64) -> f64 {
        let left = keep * keep * energy;
        self.damped += energy - left;
        left
    }

    /// The energy to keep of a push \[J\]: less its work as the obstacle sees it,
    /// J·(½(v(t − Δt/2) + v(t + Δt/2)) − w) with the velocity w of the obstacle there.
    fn strike(&mut self, plan: &ContactPlan, push: &ContactForce, moved: &Moved) -> f64 {
        let d = moved.components();
        let obstacle = plan.placed(push.obstacle, moved.times.1);
        let node = push.node as usize;
        let impulse = push.force / moved.time_step;
        let mean = 0.5 * (vector_at(&self.before, node, d) + vector_at(moved.velocity, node, d));
        let mean = mean - moved.velocity_of(plan, (push.obstacle, &obstacle), node);
        let work = impulse.dot(&mean);
        self.work += work;
        let along = match obstacle.obstacle.friction {
            Friction::Frictionless => work,
            Friction::NoSlip | Friction::Coulomb(_) => {
                let n = obstacle.normal(&moved.place(node), plan.free(push.node));
                impulse.dot(&n) * mean.dot(&n)
            }
        };
        self.lost += along - work;
        -along
    }

    /// Gives back what is kept of a node, along the normal, or keeps it while another obstacle
    /// pushes the node.
    fn leave(&mut self, plan: &ContactPlan, kept: &Kept, moved: &mut Moved) -> Option<Kept> {
        let (node, d) = (kept.node as usize, moved.components());
        let energy = self.damp(kept.energy, moved.keep);
        if self.pushed[node] {
            return Some(Kept { energy, ..*kept });
        }
        let obstacle = plan.placed(kept.obstacle, moved.times.1);
        let n = obstacle.normal(&moved.place(node), plan.free(kept.node));
        if energy <= 0.0 || n == Vector3::zeros() {
            self.lost += energy;
            return None;
        }
        let mean = 0.5 * (vector_at(&self.before, node, d) + vector_at(moved.velocity, node, d));
        let mean = mean - moved.velocity_of(plan, (kept.obstacle, &obstacle), node);
        // J s + J²/2m is the energy, with the speed away from the obstacle.
        let (mass, speed) = (moved.mass[node], mean.dot(&n));
        let impulse = (mass * mass * speed * speed + 2.0 * mass * energy).sqrt() - mass * speed;
        self.work += energy;
        for k in 0..d {
            let gained = impulse / mass * n[k];
            moved.velocity[d * node + k] += gained;
            moved.displacement[d * node + k] += moved.time_step * gained;
        }
        None
    }
}

impl Moved<'_> {
    fn components(&self) -> usize {
        self.displacement.len() / self.mass.len()
    }

    fn place(&self, node: usize) -> Vector3 {
        self.positions[node] + vector_at(self.displacement, node, self.components())
    }

    /// Of the material of an obstacle at a node, in the step \[m/s\].
    fn velocity_of(
        &self,
        plan: &ContactPlan,
        (index, now): (u32, &Placed),
        node: usize,
    ) -> Vector3 {
        now.way_since(&plan.placed(index, self.times.0), &self.place(node)) / self.time_step
    }

    /// \[J\]
    fn kinetic(&self) -> f64 {
        let nodes = self.mass.iter().zip(self.velocity.chunks(self.components()));
        nodes.map(|(mass, v)| 0.5 * mass * v.iter().map(|v| v * v).sum::<f64>()).sum()
    }
}
