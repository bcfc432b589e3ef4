//! The energies of a run over time, and a free vibration of finite amplitude.

use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::error::Error;
use mtled::force::Workspace;
use mtled::model::Model;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::motion::energy::{Energies, excess_of_mean};
use mtled::motion::observe::{Continue, Observer, View};
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::problem::{Dimension, Motion, StepControl};
use mtled_checks::measure::larger;
use mtled_run::specimens::simple::{SIZE, block_shape, free_body, recipe, tissue};

/// Records the energies every few steps.
#[derive(Debug, Default)]
pub(crate) struct Log {
    every: usize,
    /// Time \[s\] and energies.
    pub rows: Vec<(f64, Energies)>,
    /// Most nodes that touched an obstacle at once.
    pub touched: usize,
    /// By how much the mean of strain energies that the balance has exceeds what central differences
    /// keep, of each row \[J\]; nothing where it is not asked for.
    excess: Option<Vec<f64>>,
}

impl Observer for Log {
    fn observe(&mut self, view: &mut View) -> Continue {
        self.touched = self.touched.max(view.state.contact.touching.len());
        if view.state.step.is_multiple_of(self.every) {
            let energies = view.energies();
            self.rows.push((view.state.time, energies));
            let excess = self.excess.as_mut();
            excess.into_iter().for_each(|e| e.push(excess_of_mean(view.model, view.state)));
        }
        Continue::Yes
    }

    fn tracks_work(&self) -> bool {
        true
    }
}

impl Log {
    /// Records every so many steps.
    pub(crate) fn new(every: usize) -> Log {
        Log { every, ..Log::default() }
    }

    /// The same, whose imbalance is that of the energy which central differences keep.
    pub(crate) fn of_what_is_kept(every: usize) -> Log {
        Log { excess: Some(Vec::new()), ..Log::new(every) }
    }

    /// Largest of all energies and works \[J\].
    fn largest(&self) -> f64 {
        let magnitudes = self.rows.iter().flat_map(|(_, e)| {
            [e.kinetic, e.strain, e.external_work.abs(), e.constraint_work.abs(), e.damping_loss]
        });
        magnitudes.fold(0.0, larger)
    }

    /// (balance − first balance)/largest energy over time.
    pub(crate) fn imbalance(&self) -> Vec<(f64, f64)> {
        let excess = |row: usize| self.excess.as_ref().map_or(0.0, |excess| excess[row]);
        let balance = |row: usize| self.rows[row].1.balance() - excess(row);
        let largest = self.largest();
        let rows = self.rows.iter().enumerate();
        rows.map(|(row, (t, _))| (*t, (balance(row) - balance(0)) / largest)).collect()
    }
}

/// Result of a run.
#[derive(Debug)]
pub(crate) struct Vibration {
    /// (time \[s\], change of the energy balance over the largest energy \[–\]).
    pub imbalance: Vec<(f64, f64)>,
    /// Steps until it ended or failed.
    pub survived: usize,
}

impl Vibration {
    /// Standard deviation of the energy \[–\].
    pub(crate) fn fluctuation(&self) -> f64 {
        let mean = average(&self.imbalance);
        let squares = self.imbalance.iter().map(|(_, e)| (e - mean) * (e - mean));
        (squares.sum::<f64>() / self.imbalance.len() as f64).sqrt()
    }

    /// Change of the mean energy from the first to the last quarter \[–\].
    pub(crate) fn drift(&self) -> f64 {
        let quarter = self.imbalance.len() / 4;
        let last = &self.imbalance[self.imbalance.len() - quarter..];
        (average(last) - average(&self.imbalance[..quarter])).abs()
    }
}

fn average(samples: &[(f64, f64)]) -> f64 {
    samples.iter().map(|(_, e)| e).sum::<f64>() / samples.len() as f64
}

/// A free block released from a stretched state, over `steps` steps of a fraction of the critical
/// step at rest.
pub(crate) fn vibrate(steps: usize, fraction: f64, seed: u64) -> anyhow::Result<Vibration> {
    let recipe = recipe(SIZE / 4.0, 0.3, seed);
    let mut problem = free_body(Dimension::Three, block_shape(), tissue(0.49)?, recipe);
    problem.motion = Motion::Dynamic { end: 1.0, step: StepControl::default(), damping: 0.0 };
    let model = Simulation::with_any_recipe(&problem)?.model;
    let at_rest = vec![0.0; model.size()];
    let critical =
        critical_time_step(&model, &at_rest, 0.0, None, &mut Workspace::new(&model.points));
    let time_step = fraction * critical.time_step;
    let control = StepControl { fixed: Some(time_step), ..StepControl::default() };
    let end = time_step * steps as f64;
    let motion = Motion::Dynamic { end, step: control, damping: 0.0 };
    let mut log = Log::new((steps / 2000).max(1));
    let survived = match simulate(&model, &motion, &mut stretched(&model), &mut log) {
        Ok(summary) => summary.steps.min(steps),
        Err(Error::Inverted { step, .. } | Error::Diverged { step, .. }) => step,
        Err(error) => return Err(error.into()),
    };
    Ok(Vibration { imbalance: log.imbalance(), survived })
}

/// 10 % longer along x, thinner across, with some shear.
fn stretched(model: &Model) -> State {
    let mut state = State::new(model);
    for (node, position) in model.positions.iter().enumerate() {
        let from_middle = position - Vector3::repeat(0.5 * SIZE);
        state.displacement[3 * node] = 0.1 * from_middle.x + 0.05 * from_middle.y;
        state.displacement[3 * node + 1] = -0.05 * from_middle.y;
        state.displacement[3 * node + 2] = -0.05 * from_middle.z;
    }
    state
}
