//! Linear problems at an equilibrium: what a small change of the problem does there.
#![allow(non_snake_case)]

use super::increment::{Load, Unsolved};
use super::linear::System;
use super::solver::{Equilibrium, SHIFTS, Solver};
use crate::algebra::packed::{axpy, dot};
use crate::algebra::tensor::Matrix3;
use crate::error::Error;
use crate::model::Model;
use crate::model::essential::ConstraintForces;
use crate::motion::observe::Unobserved;
use crate::motion::state::State;
use crate::motion::step::Buffers;
use crate::motion::tangent::Tangent;
use crate::problem::Newton;

/// Residual of the equilibrium \[–\]: what is left of it is an error of the derivatives.
const BALANCED: f64 = 1e-9;
/// Free forces that a linear problem leaves, over those that it begins with \[–\].
const SOLVED: f64 = 1e-8;
/// Free forces smaller than this part of all are judged by that \[–\]: of a body without loads those
/// of its energy are round-off.
const ROUND_OFF: f64 = 1e-3;
/// The same above which it has no solution to speak of \[–\].
const UNSOLVED: f64 = 1e-5;
/// What one solution with the symmetric part of K aims at \[–\].
const FORCING: f64 = 1e-9;
/// Such solutions: one is enough unless pressures follow a surface with a free rim.
const MOST_ROUNDS: usize = 20;

/// A body in equilibrium, with the contacts that are closed there.
pub(crate) struct Balanced<'a> {
    solver: Solver<'a>,
    now: Equilibrium,
    sliding: Vec<(u32, Matrix3)>,
    buffers: Buffers,
}

impl<'a> Balanced<'a> {
    /// Brings the state at the end of a static run to the equilibrium that it is near to.
    pub fn new(model: &'a Model, settings: &Newton, state: &State) -> Result<Balanced<'a>, Error> {
        let mut buffers = Buffers::new(model, false);
        state.extra.act(model, state.time, &mut buffers.workspace);
        let mut solver = Solver::new(model, settings, state, &mut buffers);
        let load = Load { fraction: 1.0, part: 0.0, tolerance: BALANCED };
        let found = solver.solve(&state.displacement, load, &mut buffers, &mut Unobserved);
        let now = found.map_err(|unsolved| Error::NoEquilibrium {
            reached: 1.0,
            iterations: solver.counts.iterations,
            evaluations: solver.counts.evaluations,
            residual: match &unsolved {
                Unsolved::Failed { residual, .. } => *residual,
                Unsolved::Stopped(here) => here.exact().relative(model),
            },
            indefinite: matches!(unsolved, Unsolved::Failed { indefinite: true, .. }),
        })?;
        solver.shift = if solver.floating { SHIFTS.0 } else { 0.0 };
        let (forces, _) = solver.without_contact(now.exact());
        let sliding = solver.contacts.sliding_stiffness(model, &now.u, &forces, false);
        Ok(Balanced { solver, now, sliding, buffers })
    }

    /// Nodal parameters \[component of node\] \[m\].
    pub fn displacement(&self) -> &[f64] {
        &self.now.u
    }

    /// The forces of the conditions \[N\], as multipliers with a factor of 1.
    pub fn constraint_forces(&mut self) -> ConstraintForces {
        let (model, t) = (self.solver.model, self.solver.free.t);
        let (_, mut acceleration) = self.solver.without_contact(self.now.exact());
        let mut forces = ConstraintForces::default();
        model.constraints.project(t, &model.inertia, &mut acceleration, &mut forces);
        forces
    }

    /// Adds to a motion what keeps closed contacts closed, and leaves what conditions prescribe of it.
    pub fn keep_contacts(&mut self, motion: &mut [f64]) {
        let (mut still, free) = (vec![0.0; motion.len()], &mut self.solver.free);
        // The gaps that are left are none of this motion.
        free.close_contacts(&mut still);
        free.close_contacts(motion);
        axpy(motion, -1.0, &still);
    }

    /// The motion z \[–\] with the values of `held` where something is prescribed, for which
    /// Kᵀ z + `forces` is what conditions and contacts exert; and these forces \[N/m\]. Solutions
    /// with the symmetric part of K are joined so that what is left is least (generalised
    /// conjugate residuals: Eisenstat, Elman, Schultz 1983).
    pub fn adjoint(
        &mut self,
        forces: &[f64],
        held: Vec<f64>,
    ) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let mut z = held;
        let begin = self.left_by(&z, forces);
        let mut free = self.solver.free_part(&begin);
        let least = ROUND_OFF * self.product(&begin, &begin).sqrt();
        let first = self.product(&free, &free).sqrt().max(least);
        let mut directions: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
        while self.product(&free, &free).sqrt() > SOLVED * first && directions.len() < MOST_ROUNDS {
            let mut motion = self.solved(&free);
            let effect = self.left_by(&motion, &vec![0.0; z.len()]);
            let mut effect = self.solver.free_part(&effect);
            for (earlier, of_earlier) in &directions {
                let part = -self.product(&effect, of_earlier);
                axpy(&mut motion, part, earlier);
                axpy(&mut effect, part, of_earlier);
            }
            let size = self.product(&effect, &effect).sqrt();
            if size.is_nan() || size <= f64::MIN_POSITIVE {
                break;
            }
            motion.iter_mut().chain(&mut effect).for_each(|value| *value /= size);
            let part = -self.product(&effect, &free);
            axpy(&mut z, part, &motion);
            axpy(&mut free, part, &effect);
            directions.push((motion, effect));
        }
        let left = self.left_by(&z, forces);
        let free = self.solver.free_part(&left);
        let residual = self.product(&free, &free).sqrt() / first;
        if residual > UNSOLVED || residual.is_nan() && first > 0.0 {
            Err(Error::NoSensitivity { residual, limit: UNSOLVED })
        } else {
            Ok((z, left))
        }
    }

    /// Kᵀ z + `forces`.
    fn left_by(&mut self, z: &[f64], forces: &[f64]) -> Vec<f64> {
        let model = self.solver.model;
        let mut left = forces.to_vec();
        let tangent =
            Tangent::new(model, &self.now.u, self.solver.free.t, &mut self.buffers.workspace);
        let system = System {
            tangent,
            residual: Vec::new(),
            change: Vec::new(),
            forcing: FORCING,
            sliding: self.sliding.clone(),
            shift: 0.0,
            guide: None,
            saddle: None,
        };
        axpy(&mut left, 1.0, &system.transposed_times(model, z));
        left
    }

    /// About K⁻¹ `residual` among the free motions.
    fn solved(&mut self, residual: &[f64]) -> Vec<f64> {
        let Balanced { solver, now, sliding, buffers } = self;
        let model = solver.model;
        let own = solver.own.patches.as_ref().map(|pressures| pressures.own.clone());
        let saddle = solver.own.patches.as_ref().map(|pressures| pressures.saddle(model).still());
        let system = System {
            tangent: Tangent::new(model, &now.u, solver.free.t, &mut buffers.workspace)
                .with_pressures(own),
            change: vec![0.0; residual.len()],
            residual: residual.to_vec(),
            forcing: FORCING,
            sliding: sliding.clone(),
            shift: solver.shift,
            guide: None,
            saddle,
        };
        solver.linear.solve(model, &mut solver.free, system, &mut || true).change
    }

    /// fᵀ M⁻¹ g.
    fn product(&self, f: &[f64], g: &[f64]) -> f64 {
        dot(f, &self.solver.model.accelerations(g))
    }
}
