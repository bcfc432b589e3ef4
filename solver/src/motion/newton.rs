//! Newton's method towards a static solution, the tangent operator by products.
#![allow(non_snake_case)]

use crate::algebra::packed::{axpy, dot, largest};
use crate::error::Error;
use crate::model::Model;
use crate::model::essential::ConstraintForces;
use crate::motion::balance::Imbalance;
use crate::motion::internal_force::{SmallestJacobian, strain_energy};
use crate::motion::observe::{Continue, Observer, notify};
use crate::motion::state::State;
use crate::motion::step::{Buffers, external_force};
use crate::motion::summary::{NewtonCounts, Summary};
use crate::motion::tangent::Tangent;
use crate::problem::Newton;

/// Corrections in one increment of the load.
const MOST_ITERATIONS: usize = 20;
/// Halvings of a correction that overshoots.
const MOST_HALVINGS: usize = 6;
/// Fraction of the load below which an increment is not halved again.
const SMALLEST_INCREMENT: f64 = 1e-3;
/// Residual of the increments before the last one \[–\].
const PASSING_TOLERANCE: f64 = 1e-4;
/// Bounds of the relative residual at which conjugate gradients end.
const FORCING: (f64, f64) = (1e-4, 0.1);
/// The same for the first correction, which is not followed by a line search.
const FIRST_FORCING: f64 = 0.01;
/// A correction may not compress a point to less than this fraction of its volume.
const SMALLEST_VOLUME: f64 = 0.1;
/// Round-off of a nodal force over ε K u.
const ROUND_OFF: f64 = 100.0;

/// Solves f_ext = f_int under the conditions of the end of loading, by
/// corrections K Δu = f_ext − f_int from conjugate gradients that stay in the
/// free displacements, with the inertia as preconditioner. Where this fails,
/// the load is applied in parts. The works of the state are sums over the
/// parts by the trapezoidal rule; their total is the strain energy.
pub(crate) fn equilibrate(
    model: &Model,
    settings: &Newton,
    state: &mut State,
    observer: &mut dyn Observer,
) -> Result<Summary, Error> {
    if !model.contact.obstacles.is_empty() {
        return Err(Error::ContactInNewton);
    }
    let mut buffers = Buffers::new(model, false);
    let mut solver = Solver::new(model, settings, state, &mut buffers);
    let mut stopped = notify(model, state, &mut buffers, 1.0, 0.0, observer) == Continue::Stop;
    let (mut reached, mut increment) = (0.0, 1.0f64);
    while reached < 1.0 && !stopped {
        // No tiny last increment.
        let fraction = if reached + 1.5 * increment > 1.0 { 1.0 } else { reached + increment };
        let last = fraction == 1.0;
        let tolerance = if last { settings.tolerance } else { PASSING_TOLERANCE };
        match solver.solve(&state.displacement, fraction, tolerance, &mut buffers) {
            Ok(equilibrium) => {
                let jacobian = equilibrium.imbalance.smallest_jacobian.jacobian;
                solver.accept(equilibrium, fraction, state, &mut buffers);
                reached = fraction;
                increment *= 2.0;
                let stop = notify(model, state, &mut buffers, jacobian, reached, observer);
                stopped = stop == Continue::Stop;
            }
            Err(failed) => {
                increment = 0.5 * (fraction - reached);
                if increment < SMALLEST_INCREMENT {
                    return Err(Error::NoEquilibrium {
                        reached,
                        iterations: solver.counts.iterations,
                        residual: failed.residual,
                        indefinite: failed.indefinite,
                    });
                }
            }
        }
    }
    Ok(solver.summary(state, stopped))
}

/// The load path from the first state to the loaded one: the initial imbalance
/// fades in proportion to the fraction of the load still to come.
struct Path {
    start: f64,
    end: f64,
    /// Change that meets the conditions at the start \[m\].
    gap: Vec<f64>,
    /// f_ext − f_int at the start \[N\].
    force: Vec<f64>,
}

impl Path {
    fn time(&self, fraction: f64) -> f64 {
        if fraction == 1.0 { self.end } else { self.start + fraction * (self.end - self.start) }
    }

    /// The change of `u` \[m\] that meets the conditions.
    fn jump(
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

    fn external_force(&self, model: &Model, fraction: f64, f_ext: &mut [f64]) {
        external_force(model, self.time(fraction), f_ext);
        f_ext.iter_mut().zip(&self.force).for_each(|(f, force)| *f -= (1.0 - fraction) * force);
    }
}

struct Solver<'a> {
    model: &'a Model,
    path: Path,
    forces: ConstraintForces,
    counts: NewtonCounts,
    smallest_jacobian: SmallestJacobian,
}

/// Displacements in equilibrium at a fraction of the load.
struct Equilibrium {
    u: Vec<f64>,
    imbalance: Imbalance,
}

/// Why an increment failed.
struct FailedIncrement {
    residual: f64,
    indefinite: bool,
}

/// Approximate solution of K Δu = f_ext − f_int.
struct Correction {
    change: Vec<f64>,
    /// Whether a direction of negative curvature was met.
    indefinite: bool,
}

impl<'a> Solver<'a> {
    fn new(
        model: &'a Model,
        settings: &Newton,
        state: &State,
        buffers: &mut Buffers,
    ) -> Solver<'a> {
        let zeros = vec![0.0; model.size()];
        let path =
            Path { start: state.time, end: settings.load_end, gap: zeros.clone(), force: zeros };
        let mut solver = Solver {
            model,
            path,
            forces: ConstraintForces::default(),
            counts: NewtonCounts::default(),
            smallest_jacobian: SmallestJacobian::NONE,
        };
        // Before anything fades: the conditions and forces at the start.
        solver.path.gap = solver.path.jump(model, 0.0, &state.displacement, &mut solver.forces);
        solver.path.force = solver.imbalance(&state.displacement, 0.0, buffers).force;
        solver
    }

    fn imbalance(&mut self, u: &[f64], fraction: f64, buffers: &mut Buffers) -> Imbalance {
        self.counts.evaluations += 1;
        self.path.external_force(self.model, fraction, &mut buffers.f_ext);
        let t = self.path.time(fraction);
        Imbalance::new(self.model, u, t, buffers, &mut self.forces)
    }

    /// Newton's method at a fraction of the load from displacements `start` \[m\].
    fn solve(
        &mut self,
        start: &[f64],
        fraction: f64,
        tolerance: f64,
        buffers: &mut Buffers,
    ) -> Result<Equilibrium, FailedIncrement> {
        let model = self.model;
        let jump = self.path.jump(model, fraction, start, &mut self.forces);
        let mut imbalance = self.imbalance(start, fraction, buffers);
        let first = self.correction(start, fraction, &imbalance, jump, FIRST_FORCING, buffers);
        let (mut u, mut indefinite) = (moved(start, &first.change, 1.0), first.indefinite);
        let volume = imbalance.smallest_jacobian.jacobian;
        imbalance = self.imbalance(&u, fraction, buffers);
        let mut forcing = FORCING.1;
        for _ in 0..MOST_ITERATIONS {
            let residual = imbalance.relative(model);
            let valid = imbalance.smallest_jacobian.jacobian > SMALLEST_VOLUME * volume.min(1.0);
            if residual.is_nan() || !valid {
                return Err(FailedIncrement { residual, indefinite });
            }
            let round_off = ROUND_OFF * f64::EPSILON * largest(&model.stiffness) * largest(&u);
            let balanced = residual <= tolerance || imbalance.largest(model) <= round_off;
            if balanced && !indefinite {
                return Ok(Equilibrium { u, imbalance });
            }
            let no_jump = vec![0.0; u.len()];
            let correction = self.correction(&u, fraction, &imbalance, no_jump, forcing, buffers);
            indefinite = correction.indefinite;
            let equilibrium = self
                .search(&u, &correction.change, &imbalance, fraction, buffers)
                .ok_or(FailedIncrement { residual, indefinite })?;
            // Eisenstat and Walker 1996, choice 2.
            let fallen = equilibrium.imbalance.norm(model) / imbalance.norm(model);
            forcing = (0.9 * fallen * fallen).clamp(FORCING.0, FORCING.1);
            Equilibrium { u, imbalance } = equilibrium;
        }
        Err(FailedIncrement { residual: imbalance.relative(model), indefinite })
    }

    /// K Δu = f_ext − f_int by conjugate gradients from `change` \[m\], within
    /// the displacements that the conditions leave free.
    fn correction(
        &mut self,
        u: &[f64],
        fraction: f64,
        imbalance: &Imbalance,
        mut change: Vec<f64>,
        forcing: f64,
        buffers: &mut Buffers,
    ) -> Correction {
        let (model, t) = (self.model, self.path.time(fraction));
        self.counts.iterations += 1;
        let mut tangent = Tangent::new(model, u, t, &mut buffers.workspace);
        let mut residual = imbalance.free(model);
        let mut descent = imbalance.acceleration.clone();
        if largest(&change) > 0.0 {
            self.count_product();
            axpy(&mut residual, -1.0, &tangent.stiffness_times(&change));
            descent = preconditioned(model, t, &mut residual, &mut self.forces);
        }
        let mut direction = descent.clone();
        let mut square = dot(&residual, &descent);
        let target = forcing * forcing * square;
        for count in 0..2 * tangent.free_size() {
            if square.is_nan() || square <= target {
                break;
            }
            self.count_product();
            let product = tangent.stiffness_times(&direction);
            let curvature = dot(&direction, &product);
            if curvature <= 0.0 {
                if count == 0 {
                    axpy(&mut change, square / curvature.abs(), &direction);
                }
                return Correction { change, indefinite: true };
            }
            axpy(&mut change, square / curvature, &direction);
            axpy(&mut residual, -square / curvature, &product);
            descent = preconditioned(model, t, &mut residual, &mut self.forces);
            let before = std::mem::replace(&mut square, dot(&residual, &descent));
            for (p, z) in direction.iter_mut().zip(&descent) {
                *p = z + square / before * *p;
            }
        }
        Correction { change, indefinite: false }
    }

    fn count_product(&mut self) {
        self.counts.products += 1;
        self.counts.evaluations += 1;
    }

    /// The longest of the halved corrections that keeps points from collapsing
    /// and brings the forces, or their work along it, closer to balance.
    fn search(
        &mut self,
        u: &[f64],
        change: &[f64],
        before: &Imbalance,
        fraction: f64,
        buffers: &mut Buffers,
    ) -> Option<Equilibrium> {
        let model = self.model;
        let slope = dot(change, &before.free(model)).abs();
        let volume = SMALLEST_VOLUME * before.smallest_jacobian.jacobian.min(1.0);
        (0..=MOST_HALVINGS).find_map(|halvings| {
            let u = moved(u, change, 0.5f64.powi(halvings as i32));
            let imbalance = self.imbalance(&u, fraction, buffers);
            let valid = imbalance.smallest_jacobian.jacobian > volume;
            let closer = imbalance.norm(model) <= 0.99 * before.norm(model)
                || dot(change, &imbalance.free(model)).abs() <= 0.8 * slope;
            (valid && closer).then_some(Equilibrium { u, imbalance })
        })
    }

    /// Makes an equilibrium the state of the body, at rest.
    fn accept(
        &mut self,
        equilibrium: Equilibrium,
        fraction: f64,
        state: &mut State,
        buffers: &mut Buffers,
    ) {
        let model = self.model;
        let (u, imbalance) = (equilibrium.u, equilibrium.imbalance);
        self.counts.increments += 1;
        self.counts.residual = imbalance.relative(model);
        self.smallest_jacobian = self.smallest_jacobian.or(imbalance.smallest_jacobian);
        let stored = strain_energy(model, &u, &mut buffers.workspace)
            - strain_energy(model, &state.displacement, &mut buffers.workspace);
        external_force(model, state.time, &mut buffers.f_ext);
        let before = std::mem::take(&mut state.displacement);
        let steps: Vec<f64> = u.iter().zip(&before).map(|(u, before)| u - before).collect();
        let mut external = 0.5 * dot(&buffers.f_ext, &steps);
        state.time = self.path.time(fraction);
        external_force(model, state.time, &mut buffers.f_ext);
        external += 0.5 * dot(&buffers.f_ext, &steps);
        state.work.external += external;
        state.work.constraint += stored - external;
        state.displacement = u;
        state.velocity.fill(0.0);
        state.time_step = 0.0;
        state.step = self.counts.iterations;
        // f_int − f_ext is the force of the conditions.
        let mut acceleration: Vec<f64> = imbalance
            .force
            .iter()
            .enumerate()
            .map(|(i, f)| f / model.inertia[i / model.components])
            .collect();
        let forces = &mut state.constraint_forces;
        model.constraints.project(state.time, &model.inertia, &mut acceleration, forces);
        state.force_factor = 1.0;
    }

    fn summary(&self, state: &State, stopped: bool) -> Summary {
        Summary {
            steps: self.counts.iterations,
            time: state.time,
            time_steps: (0.0, 0.0),
            critical_time_step: 0.0,
            force_evaluations: self.counts.evaluations,
            lanczos_evaluations: 0,
            smallest_jacobian: self.smallest_jacobian,
            relaxation: None,
            newton: Some(self.counts),
            stopped,
            instability: None,
            stability_products: 0,
        }
    }
}

/// z = Π M⁻¹ r; r becomes M z, without the constraint forces, whose round-off would
/// exceed the rest.
fn preconditioned(
    model: &Model,
    t: f64,
    residual: &mut [f64],
    forces: &mut ConstraintForces,
) -> Vec<f64> {
    let d = model.components;
    let mut descent: Vec<f64> =
        residual.iter().enumerate().map(|(i, r)| r / model.inertia[i / d]).collect();
    model.constraints.project(t, &model.inertia, &mut descent, forces);
    for (i, (r, z)) in residual.iter_mut().zip(&descent).enumerate() {
        *r = model.inertia[i / d] * z;
    }
    descent
}

fn moved(u: &[f64], change: &[f64], length: f64) -> Vec<f64> {
    u.iter().zip(change).map(|(u, change)| u + length * change).collect()
}
