//! Kinetic energy of nodes that strike an obstacle: kept while they touch it, given back when
//! they leave (method book, eqs. 16.4 and 16.5).

use super::plan::ContactPlan;
use super::touch::Touch;
use super::values::Pushed;
use crate::algebra::tensor::Vector3;
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
    /// Those after it, had there been no contact; noted where something is kept.
    #[serde(skip)]
    free: Vec<f64>,
    /// What nodes that left have been given beyond what was kept of them \[J\]; the next ones pay.
    debt: f64,
    /// By obstacle and node.
    kept: Vec<Kept>,
    scratch: Vec<Kept>,
    /// Those of the step at hand.
    #[serde(skip)]
    leaving: Vec<Leaving>,
    /// Whether an obstacle pushes, of each node.
    pushed: Vec<bool>,
    /// What contact has given to the nodes \[J\].
    pub work: f64,
    /// Of it, what damping has taken from kept energy \[J\].
    pub damped: f64,
    /// Taken for good \[J\]: of motion along obstacles without slip, and what the path along
    /// a curved surface costs in steps of finite length.
    pub lost: f64,
    /// Of it, by Coulomb friction \[J\].
    pub rubbed: f64,
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

/// A node that an obstacle no longer pushes.
#[derive(Debug, Clone, Copy)]
struct Leaving {
    /// What is given back to it \[J\].
    kept: Kept,
    row: u32,
    /// Away from the obstacle.
    normal: Vector3,
    /// The impulse that would give it back if nothing else left \[N·s\].
    impulse: f64,
    /// The speed on which it does work \[m/s\].
    speed: f64,
    /// The node's velocity before along the normal \[m/s\].
    velocity: f64,
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
        self.kept.iter().map(|kept| kept.energy).sum::<f64>() - self.debt
    }

    /// Notes the velocities before a step \[m/s\].
    pub(crate) fn begin(&mut self, velocity: &[f64]) {
        if self.is_active() {
            self.before.copy_from_slice(velocity);
        }
    }

    /// Notes the velocities of a step before contact changes them \[m/s\].
    pub(crate) fn note_free(&mut self, velocity: &[f64]) {
        if !self.kept.is_empty() {
            self.free.clear();
            self.free.extend_from_slice(velocity);
        }
    }

    /// Keeps what the touches of a step, by obstacle and node, have taken from the nodes, and gives
    /// back what is kept of nodes that nothing pushes any more.
    pub(super) fn settle(&mut self, plan: &ContactPlan, touches: &[Touch], moved: Moved) {
        if !self.is_active() || touches.is_empty() && self.kept.is_empty() {
            return;
        }
        self.largest_kinetic = self.largest_kinetic.max(moved.kinetic());
        let before = std::mem::take(&mut self.kept);
        let mut after = std::mem::take(&mut self.scratch);
        after.clear();
        touches.iter().for_each(|touch| self.pushed[touch.node as usize] = true);
        let mut moved = moved;
        let key = |kept: &Kept| (kept.obstacle, kept.node);
        for touch in touches {
            let (obstacle, node) = (touch.obstacle, touch.node);
            let kept = before.binary_search_by_key(&(obstacle, node), key);
            let kept = kept.map_or(0.0, |index| before[index].energy);
            let energy = self.damp(kept, moved.keep) + self.strike(plan, touch, &moved);
            after.push(Kept { obstacle, node, energy });
        }
        // What leaves changes the velocities by which strikes work.
        let touching = after.len();
        for kept in &before {
            if after[..touching].binary_search_by_key(&key(kept), key).is_err() {
                after.extend(self.leave(kept, moved.keep));
            }
        }
        self.give_back(plan, &mut moved);
        after.sort_unstable_by_key(key);
        touches.iter().for_each(|touch| self.pushed[touch.node as usize] = false);
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
    fn strike(&mut self, plan: &ContactPlan, touch: &Touch, moved: &Moved) -> f64 {
        let impulse = touch.push / moved.time_step;
        let mean = self.mean(plan, (touch.obstacle, touch.row), moved);
        let work = impulse.dot(&mean);
        self.work += work;
        let along = match touch.friction {
            Friction::Frictionless => work,
            Friction::NoSlip | Friction::Coulomb(_) => {
                impulse.dot(&touch.normal) * mean.dot(&touch.normal)
            }
        };
        self.lost += along - work;
        if let Friction::Coulomb(_) = touch.friction {
            self.rubbed += along - work;
        }
        -along
    }

    /// Mean velocity of a step, as a push on a value of a row does work on it, seen from an obstacle
    /// \[m/s\].
    fn mean(&self, plan: &ContactPlan, (obstacle, row): (u32, u32), moved: &Moved) -> Vector3 {
        let value = |field: &[f64]| plan.pushed_value(row, field);
        let mean = 0.5 * (value(&self.before) + value(moved.velocity));
        let now = plan.placed(obstacle, moved.times.1);
        let way = now.way_since(&plan.placed(obstacle, moved.times.0), &moved.place(plan, row));
        mean - plan.share(row).component_mul(&way) / moved.time_step
    }

    /// Lists a node as leaving, or keeps its energy while another obstacle pushes it.
    fn leave(&mut self, kept: &Kept, keep: f64) -> Option<Kept> {
        let kept = Kept { energy: self.damp(kept.energy, keep), ..*kept };
        if self.pushed[kept.node as usize] {
            return Some(kept);
        }
        let (row, normal) = (0, Vector3::zeros());
        self.leaving.push(Leaving { kept, row, normal, impulse: 0.0, speed: 0.0, velocity: 0.0 });
        None
    }

    /// Gives back what is kept of the nodes that leave in a step, along the normals: to each by the
    /// impulse that would do it if no other left, all times one factor with which the sum is right.
    /// One after the other would give a body that leaves a floor with many nodes a turn that
    /// goes with their numbers.
    fn give_back(&mut self, plan: &ContactPlan, moved: &mut Moved) {
        if self.leaving.is_empty() {
            return;
        }
        let mut leaving = std::mem::take(&mut self.leaving);
        let energies = || leaving.iter().map(|one| one.kept.energy);
        let left = energies().sum::<f64>() - self.debt;
        let gains: f64 = energies().map(|energy| energy.max(0.0)).sum();
        self.debt = (-left).max(0.0);
        let share = if left > 0.0 { left / gains } else { 0.0 };
        leaving.retain_mut(|one| {
            one.kept.energy = share * one.kept.energy.max(0.0);
            self.throws(plan, moved, one)
        });
        push_all(plan, &leaving, 1.0, moved);
        let (mut linear, mut square, mut energy) = (0.0, 0.0, 0.0);
        for one in &leaving {
            let gained = plan.pushed_value(one.row, moved.velocity).dot(&one.normal) - one.velocity;
            linear += one.impulse * one.speed;
            square += 0.5 * one.impulse * gained;
            energy += one.kept.energy;
        }
        if leaving.len() > 1 {
            let root = (linear * linear + 4.0 * square * energy).sqrt();
            push_all(plan, &leaving, 0.5 * (root - linear) / square - 1.0, moved);
        }
        self.work += energy;
        leaving.clear();
        self.leaving = leaving;
    }

    /// Whether a node that leaves is to be pushed, and how: where it cannot be, its energy is lost.
    fn throws(&mut self, plan: &ContactPlan, moved: &Moved, one: &mut Leaving) -> bool {
        let Kept { obstacle, node, energy } = one.kept;
        if energy <= 0.0 {
            return false;
        }
        let normal = |row: u32| {
            let place = moved.place(plan, row);
            let n = plan.placed(obstacle, moved.times.1).normal(&place, plan.free(node));
            let mobility = n.component_mul(&n).dot(&plan.mobility(row, moved.mass));
            (mobility > 0.0).then_some((row, n, mobility))
        };
        let Some((row, n, mobility)) = plan.row_of(node).and_then(normal) else {
            self.lost += energy;
            return false;
        };
        // J s + J² w/2 is the energy, with w = Σ φ²/m and the speed s away from the obstacle: with
        // half of what contact has changed on top, by which J changes the work of the pushes before.
        let value = plan.pushed_value(row, moved.velocity);
        let changed = value - plan.pushed_value(row, &self.free);
        let speed = (self.mean(plan, (obstacle, row), moved) + 0.5 * changed).dot(&n);
        let impulse = ((speed * speed + 2.0 * mobility * energy).sqrt() - speed) / mobility;
        *one = Leaving { row, normal: n, impulse, speed, velocity: value.dot(&n), ..*one };
        true
    }
}

/// Pushes nodes that leave by a factor times their impulses.
fn push_all(plan: &ContactPlan, leaving: &[Leaving], factor: f64, moved: &mut Moved) {
    let Moved { mass, displacement, velocity, time_step, .. } = moved;
    let (displacement, velocity) = (&mut displacement[..], &mut velocity[..]);
    let mut pushed = Pushed { mass, displacement, velocity, time_step: *time_step };
    for one in leaving {
        let push = factor * one.impulse * pushed.time_step * one.normal;
        plan.push(one.row, &push, &mut pushed);
    }
}

impl Moved<'_> {
    fn components(&self) -> usize {
        self.displacement.len() / self.mass.len()
    }

    /// Of the node of a row \[m\].
    fn place(&self, plan: &ContactPlan, row: u32) -> Vector3 {
        plan.place_of(row, self.positions, self.displacement)
    }

    /// \[J\]
    fn kinetic(&self) -> f64 {
        let nodes = self.mass.iter().zip(self.velocity.chunks(self.components()));
        nodes.map(|(mass, v)| 0.5 * mass * v.iter().map(|v| v * v).sum::<f64>()).sum()
    }
}
