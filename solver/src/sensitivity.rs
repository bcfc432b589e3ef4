//! Sensitivities: how much answers of a static problem change with its numbers.
//!
//! At an equilibrium r(u; p) + Cᵀλ = 0, C u = g(p), an answer J(u, λ; p) changes with a number p
//! of the problem as
//!   dJ/dp = ∂J/∂p − zᵀ ∂r/∂p + yᵀ ∂w/∂p,  Kᵀz + ∂J/∂u = y = Cᵀν,  C z = ∂J/∂λ,
//! with w any displacement that meets the conditions (method book, eqs. 29.1 to 29.3). The adjoint
//! z takes one linear solution for each answer, and none for a number.
#![allow(non_snake_case)]

use crate::algebra::packed::dot;
use crate::algebra::tensor::Vector3;
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::force::{internal_force, strain_energy};
use crate::model::Model;
use crate::motion::extra_stress::ExtraState;
use crate::motion::newton::Balanced;
use crate::motion::state::State;
use crate::motion::step::{Buffers, add_following, external_force};
use crate::problem::{Motion, Newton, Problem};

/// A number that a solution answers.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// Σ_a s_a u_a \[m\] along a direction: the displacement of a place, where s_a are the shape
    /// functions there, a mean, or that of the centre of mass of a part.
    Displacement {
        /// Nodes and their s_a \[–\].
        weights: Vec<(u32, f64)>,
        /// Unit vector; along the displacement itself its length is answered.
        along: Vector3,
    },
    /// The force \[N\] that a condition exerts along a direction.
    Force {
        /// Index of the condition.
        condition: usize,
        /// Unit vector.
        along: Vector3,
    },
    /// The moment \[N·m\] that a condition exerts about an axis.
    Moment {
        /// Index of the condition.
        condition: usize,
        /// Unit vector.
        along: Vector3,
        /// A point on the axis \[m\].
        about: Vector3,
    },
    /// Of the whole body \[J\].
    StrainEnergy,
}

/// An answer at an equilibrium, and what its adjoint is found from.
#[derive(Debug)]
struct Asked {
    answer: Answer,
    value: f64,
    /// ∂J/∂u
    slope: Vec<f64>,
    /// A motion whose prescribed values are ∂J/∂λ.
    held: Vec<f64>,
}

/// An adjoint.
#[derive(Debug)]
struct Solved {
    /// z
    motion: Vec<f64>,
    /// y
    forces: Vec<f64>,
}

/// The adjoints of some answers at the end of a static run.
pub struct Adjoint<'a> {
    discretisation: &'a Discretisation,
    balanced: Balanced<'a>,
    asked: Vec<Asked>,
    /// None before one was needed.
    solved: Vec<Solved>,
}

/// A problem at displacements that another one has led to.
struct Side {
    /// Unbalanced forces r \[N\].
    force: Vec<f64>,
    /// From these displacements to such as meet the conditions \[m\].
    jump: Vec<f64>,
    /// \[J\]
    energy: f64,
}

impl<'a> Adjoint<'a> {
    /// Brings the state at the end of a run by Newton's method to equilibrium up to round-off, and
    /// asks for answers there.
    ///
    /// # Errors
    /// [`Error::NoEquilibriumToVary`] for motions and for relaxation, [`Error::MemoryToVary`] where a
    /// material has viscosity, [`Error::NoEquilibrium`] where
    /// the state is near to none.
    pub fn new(
        problem: &Problem,
        discretisation: &'a Discretisation,
        model: &'a Model,
        state: &State,
        answers: &[Answer],
    ) -> Result<Adjoint<'a>, Error> {
        if !problem.by_newton() || model.nodal_rows.is_none() {
            return Err(Error::NoEquilibriumToVary);
        }
        if model.has_memory() {
            return Err(Error::MemoryToVary);
        }
        let settings = match problem.motion {
            Motion::Newton(settings) => settings,
            _ => Newton { load_end: problem.motion.end(), tolerance: 1.0, ..Newton::default() },
        };
        let mut balanced = Balanced::new(model, &settings, state)?;
        let t = problem.motion.end();
        let asked = answers.iter().map(|answer| asked(answer, model, &mut balanced, t)).collect();
        Ok(Adjoint { discretisation, balanced, asked, solved: Vec::new() })
    }

    /// The answers, in their order and units.
    pub fn values(&self) -> Vec<f64> {
        self.asked.iter().map(|asked| asked.value).collect()
    }

    /// First-order change of each answer from one problem to another. Both differ little from the
    /// one that was solved, in what leaves nodes and shape functions as they are: constants of
    /// materials, loads, prescribed values, amplitudes. Obstacles stay as they were, closed contacts
    /// closed, open ones open. The first call solves an adjoint problem for each answer.
    ///
    /// Half of it over the step of a number p is dJ/dp for `before` with p − step and `after` with
    /// p + step.
    ///
    /// # Errors
    /// Those of [`Model::new`], and [`Error::NoSensitivity`] where an adjoint problem has no
    /// solution.
    pub fn change(&mut self, before: &Problem, after: &Problem) -> Result<Vec<f64>, Error> {
        for Asked { slope, held, .. } in &self.asked[self.solved.len()..] {
            let (motion, forces) = self.balanced.adjoint(slope, held.clone())?;
            self.solved.push(Solved { motion, forces });
        }
        let [before, after] = [self.side(before)?, self.side(after)?];
        let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect();
        let force: Vec<f64> = difference(&after.force, &before.force);
        let jump: Vec<f64> = difference(&after.jump, &before.jump);
        let change = |(asked, solved): (&Asked, &Solved)| {
            let own = match asked.answer {
                Answer::StrainEnergy => after.energy - before.energy,
                _ => 0.0,
            };
            own - dot(&solved.motion, &force) + dot(&solved.forces, &jump)
        };
        Ok(self.asked.iter().zip(&self.solved).map(change).collect())
    }

    fn side(&mut self, problem: &Problem) -> Result<Side, Error> {
        let model = Model::new(problem, self.discretisation)?;
        let mut buffers = Buffers::new(&model, false);
        let (t, u) = (problem.motion.end(), self.balanced.displacement().to_vec());
        ExtraState::new(&model).act(&model, t, &mut buffers.workspace);
        external_force(&model, t, &mut buffers.f_ext);
        add_following(&model, t, &u, &mut buffers.f_ext);
        internal_force(&model.points, &u, &mut buffers.workspace, &mut buffers.f_int);
        let unbalanced = buffers.f_ext.iter().zip(&buffers.f_int).map(|(ext, int)| ext - int);
        let mut jump = vec![0.0; u.len()];
        let mut moved = u.clone();
        let forces = &mut Default::default();
        let Model { positions, inertia, .. } = &model;
        model.constraints.enforce(t, positions, inertia, &mut moved, forces, |i, delta| {
            jump[i] += delta;
        });
        self.balanced.keep_contacts(&mut jump);
        Ok(Side { force: unbalanced.collect(), jump, energy: strain_energy(&model.points, &u) })
    }
}

/// An answer at an equilibrium under the conditions of time `t` \[s\].
fn asked(answer: &Answer, model: &Model, balanced: &mut Balanced, t: f64) -> Asked {
    let u = balanced.displacement().to_vec();
    let d = model.components;
    let still = || vec![0.0; u.len()];
    let Model { positions, inertia, constraints, .. } = model;
    let body = (&positions[..], &inertia[..], &u[..]);
    // ∂J/∂u, and the motion that ∂J/∂λ is.
    let (value, slope, mut held) = match answer {
        Answer::Displacement { weights, along } => {
            let mut slope = still();
            for (node, weight) in weights {
                let own = &mut slope[d * *node as usize..][..d];
                own.iter_mut().zip(along).for_each(|(slope, along)| *slope += weight * along);
            }
            (dot(&slope, &u), slope, still())
        }
        Answer::Force { condition, along } => {
            let forces = balanced.constraint_forces();
            let all = constraints.reactions(&forces, 1.0, &Vector3::zeros(), positions, &u);
            let motion = |_: &Vector3| *along;
            let held = constraints.motion_of(*condition, t, body, &motion);
            (all[*condition].force.dot(along), still(), held)
        }
        Answer::Moment { condition, along, about } => {
            let forces = balanced.constraint_forces();
            let all = constraints.reactions(&forces, 1.0, about, positions, &u);
            let motion = |x: &Vector3| along.cross(&(x - about));
            let held = constraints.motion_of(*condition, t, body, &motion);
            let size = (d, u.len());
            let slope = constraints.moment_slope(*condition, (&forces, 1.0), along, size);
            (all[*condition].moment.dot(along), slope, held)
        }
        Answer::StrainEnergy => {
            let mut buffers = Buffers::new(model, false);
            internal_force(&model.points, &u, &mut buffers.workspace, &mut buffers.f_int);
            (strain_energy(&model.points, &u), buffers.f_int, still())
        }
    };
    balanced.keep_contacts(&mut held);
    Asked { answer: answer.clone(), value, slope, held }
}
