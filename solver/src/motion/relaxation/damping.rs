//! The damping factor of dynamic relaxation.

use crate::model::Model;
use crate::motion::stability::Curvature;
use crate::motion::state::State;
use crate::motion::step::Buffers;
use crate::problem::Relaxation;

/// Steps between two estimates of the lowest frequency.
const ESTIMATE_EVERY: usize = 10;

/// Adapts the damping factor c to the lowest frequency in motion.
pub(crate) struct Damping {
    pub c: f64,
    /// Velocity \[m/s\] of the last step but one, then its change of displacement \[m\]
    /// \[component of node\].
    pub change: Vec<f64>,
    force_before: Vec<f64>,
    since: usize,
}

impl Damping {
    pub fn new(model: &Model, settings: &Relaxation) -> Damping {
        // Initially as if the load took one period of the slowest mode.
        let kappa = (settings.load_steps as f64 / std::f64::consts::PI).max(2.0);
        let zeros = vec![0.0; model.size()];
        Damping { c: factor(kappa), change: zeros.clone(), force_before: zeros, since: 0 }
    }

    /// Drops the last differences, which belong to another step.
    pub fn reset(&mut self) {
        self.since = 0;
    }

    /// Returns the curvature along the motion where it was measured.
    pub fn update(&mut self, model: &Model, state: &State, buffers: &Buffers) -> Option<Curvature> {
        self.since += 1;
        if self.since == ESTIMATE_EVERY - 1 {
            self.force_before.copy_from_slice(&buffers.f_int);
            self.change.copy_from_slice(&state.velocity);
        }
        if self.since < ESTIMATE_EVERY {
            return None;
        }
        self.since = 0;
        self.change.iter_mut().for_each(|change| *change *= state.time_step);
        Some(self.adapt(model, &buffers.f_int, state.time_step))
    }

    /// ω² = |Σ Δu·Δf|/Σ m Δu², κ = 2/(ωΔt), c = (κ − 1)/(κ + 1)
    /// (Joldes, Wittek, Miller 2011, eqs. 17–22).
    fn adapt(&mut self, model: &Model, f_int: &[f64], time_step: f64) -> Curvature {
        let (mut stiffness, mut inertia, mut sizes) = (0.0, 0.0, 0.0);
        let forces = f_int.iter().zip(&self.force_before);
        for (i, (change, (f, before))) in self.change.iter().zip(forces).enumerate() {
            let work = change * (f - before);
            stiffness += work;
            sizes += work.abs();
            inertia += model.inertia[i / model.components] * change * change;
        }
        let omega = (stiffness.abs() / inertia).sqrt();
        if omega.is_finite() && omega > 0.0 {
            self.c = factor((2.0 / (omega * time_step)).max(1.5));
        }
        Curvature { work: stiffness, sizes }
    }
}

fn factor(kappa: f64) -> f64 {
    (kappa - 1.0) / (kappa + 1.0)
}
