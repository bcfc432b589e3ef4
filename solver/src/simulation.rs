//! The one way from a problem to its solution that leaves nothing out.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::audit::{Audit, audit};
use crate::discretisation::{Discretisation, Warning};
use crate::error::Error;
use crate::model::Model;
use crate::model::contact::{ContactResult, ContactSurface};
use crate::model::essential::Reaction;
use crate::model::unheld::unheld;
use crate::model::zero_energy::refuse_zero_energy_modes;
use crate::motion::energy::{Energies, energies};
use crate::motion::mass_scaling::raise_masses;
use crate::motion::nodal_fields::NodalFields;
use crate::motion::observe::Observer;
use crate::motion::simulate::simulate;
use crate::motion::state::State;
use crate::motion::strain::strain_warnings;
use crate::motion::summary::Summary;
use crate::problem::Problem;
use crate::sensitivity::{Adjoint, Answer};
use std::sync::OnceLock;
use std::time::Instant;

/// A problem that is set up, and the state that it has reached.
///
/// The parts are public, so that a study can look at each and run them one by one:
/// [`Discretisation::new`], [`Model::new`], [`raise_masses`],
/// [`refuse_zero_energy_modes`], [`State::new`], [`simulate`].
#[derive(Debug)]
pub struct Simulation {
    /// What is to be solved.
    pub problem: Problem,
    /// Nodes, quadrature points, shape functions.
    pub discretisation: Discretisation,
    /// Masses, stiffness, conditions, loads, obstacles.
    pub model: Model,
    /// Displacements and velocities.
    pub state: State,
    /// Wall time of the set-up \[s\].
    pub setup_seconds: f64,
    continued: bool,
    has_run: bool,
    contact_surface: OnceLock<ContactSurface>,
}

impl Simulation {
    /// Discretises the body, binds materials, conditions and loads, raises masses where the
    /// motion asks for that, and refuses a recipe whose quadrature leaves zero-energy modes.
    pub fn new(problem: &Problem) -> Result<Simulation, Error> {
        let simulation = Simulation::with_any_recipe(problem)?;
        simulation.refuse_zero_energy_modes()?;
        Ok(simulation)
    }

    /// As [`Simulation::new`], for studies of recipes: one that leaves zero-energy modes is not refused.
    pub fn with_any_recipe(problem: &Problem) -> Result<Simulation, Error> {
        let start = Instant::now();
        let discretisation = Discretisation::new(problem)?;
        let model = raise_masses(Model::new(problem, &discretisation)?, problem, &discretisation)?;
        let setup_seconds = start.elapsed().as_secs_f64();
        Ok(Simulation { setup_seconds, ..Simulation::of_parts(problem, discretisation, model) })
    }

    /// A problem with parts that a study has made for it.
    pub fn of_parts(problem: &Problem, discretisation: Discretisation, model: Model) -> Simulation {
        let state = State::new(&model);
        Simulation {
            problem: problem.clone(),
            discretisation,
            model,
            state,
            setup_seconds: 0.0,
            continued: false,
            has_run: false,
            contact_surface: OnceLock::new(),
        }
    }

    /// Refuses a recipe whose quadrature leaves zero-energy modes.
    pub fn refuse_zero_energy_modes(&self) -> Result<(), Error> {
        refuse_zero_energy_modes(&self.problem, &self.discretisation, &self.model)
    }

    /// What to know before the problem is solved.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut warnings = self.discretisation.warnings();
        warnings.extend(self.model.warnings.iter().cloned());
        warnings.extend(unheld(&self.problem, &self.discretisation, &self.model));
        warnings
    }

    /// Goes on with a motion from a state that it has reached in another run.
    ///
    /// # Errors
    /// A state of another number of nodes or of other materials, and a simulation that has run.
    pub fn continue_from(&mut self, state: State) -> Result<(), Error> {
        if self.has_run {
            return Err(Error::HasRun { time: self.state.time });
        }
        if let Some((found, expected)) = state.misfit(&self.model) {
            return Err(Error::StateOfAnother { found, expected });
        }
        (self.state, self.continued) = (state, true);
        Ok(())
    }

    /// Whether it goes on, or went on, from a state of another run.
    pub fn is_continued(&self) -> bool {
        self.continued
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

    /// Reasons to doubt a run that came to its end with `summary`.
    pub fn doubts(&self, summary: &Summary) -> Vec<String> {
        let Simulation { discretisation, model, state, .. } = self;
        let (t, u) = (state.time, &state.displacement);
        let mut found = model.contact.penetrations(&model.positions, t, u);
        found.extend(model.contact.unresolved(discretisation, t, u));
        found.extend(strain_warnings(model, discretisation, u));
        let found = found.iter().map(Warning::to_string);
        summary.doubts(model).into_iter().chain(found).collect()
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

    /// Where obstacles touch the body, made when it is first asked for; nothing without obstacles.
    ///
    /// # Errors
    /// As [`ContactSurface::new`].
    pub fn contact_surface(&self) -> Result<Option<&ContactSurface>, Error> {
        if self.problem.obstacles.is_empty() {
            return Ok(None);
        }
        if let Some(surface) = self.contact_surface.get() {
            return Ok(Some(surface));
        }
        let surface = ContactSurface::new(&self.problem, &self.discretisation)?;
        Ok(Some(self.contact_surface.get_or_init(|| surface)))
    }

    /// What each obstacle does to the body now, in the order of the problem's obstacles.
    ///
    /// # Errors
    /// As [`Simulation::contact_surface`].
    pub fn contact_results(&self) -> Result<Vec<ContactResult>, Error> {
        let Some(surface) = self.contact_surface()? else { return Ok(Vec::new()) };
        let (plan, state) = (&self.model.contact, &self.state);
        let (forces, u) = (state.contact_forces(), &state.displacement);
        surface.results((plan, state.time), &self.discretisation, &forces, u)
    }

    /// Energies \[J\] half a step before the time of the state.
    pub fn energies(&self) -> Energies {
        energies(&self.model, &self.state)
    }
}
