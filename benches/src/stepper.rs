//! Time steps without the loop around them.

use anyhow::ensure;
use mtled::discretisation::Discretisation;
use mtled::model::Model;
use mtled::motion::state::State;
use mtled::motion::step::{Buffers, Scheme, step};
use mtled::problem::{Motion, Problem, StepControl};

/// Steps through a dynamic simulation, damped so that it stays bounded.
pub struct Stepper {
    /// The model.
    pub model: Model,
    scheme: Scheme,
    state: State,
    buffers: Buffers,
}

impl Stepper {
    /// Dynamic, whatever the motion of the problem.
    pub fn new(problem: &Problem, discretisation: &Discretisation) -> anyhow::Result<Stepper> {
        let mut problem = problem.clone();
        let damping = match problem.motion {
            Motion::Dynamic { damping, .. } => damping,
            _ => 10.0,
        };
        problem.motion = Motion::Dynamic { end: 1.0, step: StepControl::default(), damping };
        let model = Model::new(&problem, discretisation)?;
        let time_step = 0.9 * model.per_point_bound;
        let scheme = Scheme::central_difference(time_step, time_step, damping);
        let (state, buffers) = (State::new(&model), Buffers::new(&model, false));
        Ok(Stepper { model, scheme, state, buffers })
    }

    /// One step.
    pub fn step(&mut self) {
        let (now, then) = (self.state.time, self.state.time + self.scheme.time_step);
        step(&self.model, &self.scheme, now, then, &mut self.state, &mut self.buffers);
    }

    /// Refuses a measurement of a run that diverged.
    pub fn check(&self) -> anyhow::Result<()> {
        let finite = self.state.displacement.iter().all(|x| x.is_finite());
        ensure!(finite, "the run diverged while it was measured");
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bodies::cube;

    #[test]
    fn a_run_that_diverged_is_refused() {
        let problem = cube(4, 30.0);
        let discretisation = Discretisation::new(&problem).unwrap();
        let mut stepper = Stepper::new(&problem, &discretisation).unwrap();
        (0..3).for_each(|_| stepper.step());
        stepper.check().unwrap();
        stepper.state.displacement[0] = f64::NAN;
        assert!(stepper.check().is_err());
    }
}
