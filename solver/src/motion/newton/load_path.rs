//! The way from the first state to the loaded one.

use crate::model::Model;
use crate::model::essential::ConstraintForces;
use crate::motion::step::external_force;

/// The load path from the first state to the loaded one: the initial imbalance
/// fades in proportion to the fraction of the load still to come.
pub(super) struct Path {
    start: f64,
    end: f64,
    /// Change that meets the conditions at the start \[m\].
    pub gap: Vec<f64>,
    /// f_ext − f_int at the start \[N\].
    pub force: Vec<f64>,
    /// By how much the pressures of volumes exceed those that balance best at the start
    /// \[cavity\] \[Pa\].
    pub excess: Vec<f64>,
}

impl Path {
    /// From the state at time `start` to the load of time `end` \[s\].
    pub fn new(start: f64, end: f64, size: usize) -> Path {
        Path { start, end, gap: vec![0.0; size], force: vec![0.0; size], excess: Vec::new() }
    }

    pub fn time(&self, fraction: f64) -> f64 {
        if fraction == 1.0 { self.end } else { self.start + fraction * (self.end - self.start) }
    }

    /// The fraction of the load at a time \[s\].
    pub fn fraction(&self, time: f64) -> f64 {
        if self.end == self.start { 1.0 } else { (time - self.start) / (self.end - self.start) }
    }

    /// The change of `u` \[m\] that meets the conditions.
    pub fn jump(
        &self,
        model: &Model,
        fraction: f64,
        u: &[f64],
        forces: &mut ConstraintForces,
    ) -> Vec<f64> {
        let left = 1.0 - fraction;
        let mut moved: Vec<f64> = u.iter().zip(&self.gap).map(|(u, gap)| u + left * gap).collect();
        let t = self.time(fraction);
        let mut jump = vec![0.0; u.len()];
        let positions = &model.positions;
        model.constraints.enforce(t, positions, &model.inertia, &mut moved, forces, |i, delta| {
            jump[i] += delta;
        });
        jump
    }

    pub fn external_force(&self, model: &Model, fraction: f64, f_ext: &mut [f64]) {
        external_force(model, self.time(fraction), f_ext);
        f_ext.iter_mut().zip(&self.force).for_each(|(f, force)| *f -= (1.0 - fraction) * force);
    }
}
