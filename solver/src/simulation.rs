//! The one way from a problem to its solution that leaves nothing out.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::audit::{Audit, audit};
use crate::discretisation::{Discretisation, Warning};
use crate::error::Error;
use crate::model::Model;
use crate::model::essential::Reaction;
use crate::model::zero_energy::refuse_zero_energy_modes;
use crate::motion::energy::{Energies, energies};
use crate::motion::mass_scaling::raise_masses;
use crate::motion::nodal_fields::NodalFields;
use crate::motion::observe::Observer;
use crate::motion::simulate::simulate;
use crate::motion::state::State;
use crate::motion::summary::Summary;
use crate::problem::Problem;
use crate::sensitivity::{Adjoint, Answer};

/// A problem that is set up, and the state that it has reached.
///
/// The parts are public, so that a study can look at each and run them one by one:
/// [`Discretisation::new`], [`Model::new`], [`raise_masses`],
/// [`refuse_zero_energy_modes`], [`State::new`], [`simulate`].
#[derive(Debug)]
pub struct Simulation {
    /// Nodes, quadrature points, shape functions.
    pub discretisation: Discretisation,
    /// Masses, stiffness, conditions, loads, obstacles.
    pub model: Model,
    /// Displacements and velocities.
    pub state: State,
    problem: Problem,
    has_run: bool,
}

impl Simulation {
    /// Discretises the body, binds materials, conditions and loads, raises masses where the
    /// motion asks for that, and refuses a recipe whose quadrature leaves zero-energy modes.
    pub fn new(problem: &Problem) -> Result<Simulation, Error> {
        let discretisation = Discretisation::new(problem)?;
        let model = Model::new(problem, &discretisation)?;
        let model = raise_masses(model, problem, &discretisation)?;
        refuse_zero_energy_modes(problem, &discretisation, &model)?;
        let state = State::new(&model);
        Ok(Simulation { discretisation, model, state, problem: problem.clone(), has_run: false })
    }

    /// What to know before the result is trusted.
    pub fn warnings(&self) -> Vec<Warning> {
        let of_problem = self.model.warnings.iter().cloned();
        self.discretisation.warnings().into_iter().chain(of_problem).collect()
    }

    /// Runs to the end of the motion, or to static equilibrium, and notifies `observer`
    /// after every step. After an error [`Simulation::state`] is the last one reached. A
    /// simulation runs once: the loads of a second run would begin anew on a body that they have
    /// deformed.
    pub fn run(&mut self, observer: &mut dyn Observer) -> Result<Summary, Error> {
        if std::mem::replace(&mut self.has_run, true) {
            return Err(Error::HasRun { time: self.state.time });
        }
        simulate(&self.model, &self.problem.motion, &mut self.state, observer)
    }

    /// What the problem asked beside what the run has done, once it has come to its end.
    pub fn audit(&self) -> Result<Audit, Error> {
        audit(&self.problem, &self.discretisation, &self.model, &self.state)
    }

    /// How answers at the end of a static run change with the numbers of the problem.
    ///
    /// # Errors
    /// As [`Adjoint::new`].
    pub fn adjoint(&self, answers: &[Answer]) -> Result<Adjoint<'_>, Error> {
        Adjoint::new(&self.problem, &self.discretisation, &self.model, &self.state, answers)
    }

    /// The displacement field \[m\] at reference positions \[m\]. Shape functions do not
    /// interpolate: this, not a nodal parameter, is the displacement of a point.
    pub fn displacements_at(&self, positions: &[Vector3]) -> Result<Vec<Vector3>, Error> {
        let rows = self.discretisation.rows_at(positions)?;
        let (u, components) = (&self.state.displacement, self.model.components);
        Ok((0..positions.len()).map(|i| rows.interpolate(i, u, components)).collect())
    }

    /// J, Cauchy stress, pressure and strain of the material at the nodes and between them.
    pub fn nodal_fields(&self) -> NodalFields {
        let (model, u) = (&self.model, &self.state.displacement);
        let extra = self.state.extra.stresses(model);
        NodalFields::new(&self.problem, &self.discretisation, model, u, &extra)
    }

    /// Force \[N\] and moment about `about` \[m\] that each condition exerts on the body, in
    /// the order of the problem's conditions.
    pub fn reactions(&self, about: &Vector3) -> Vec<Reaction> {
        self.state.reactions(&self.model, about)
    }

    /// Energies \[J\] half a step before the time of the state.
    pub fn energies(&self) -> Energies {
        energies(&self.model, &self.state)
    }
}
