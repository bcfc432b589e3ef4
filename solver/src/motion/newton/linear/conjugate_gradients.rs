//! Corrections of Newton's method by conjugate gradients.
#![allow(non_snake_case)]

use super::coarse_space::{Held, Stiffness};
use super::due_factors::{DueFactors, MadeFor};
use super::preconditioner::Preconditioner;
use super::system::{Correction, System};
use crate::algebra::packed::{axpy, dot, largest};
use crate::model::Model;
use crate::motion::newton::free_space::FreeSpace;

/// Bodies of fewer nodes, and those in a plane, take no more products with the diagonal alone.
const LEAST_NODES: usize = 200;
/// For more nodes the preconditioner is made at once.
const FEW_NODES: usize = 5000;
/// Products with the diagonal alone in the first correction, and in all after it, beyond which the
/// preconditioner is made: for small and compressible bodies it costs more than it saves.
const OF_FIRST: usize = 24;
const OF_ALL: usize = 200;
/// Products after which the diagonal alone takes over for good: on a few irregular clouds the
/// transform to nodal values is nearly singular.
const PATIENCE: usize = 400;

/// Solves corrections, and keeps the preconditioner from one to the next.
pub(crate) struct Solver {
    pub(super) at_rest: Stiffness,
    preconditioner: Option<Preconditioner>,
    /// Products with the diagonal alone until the preconditioner is made, if it ever is.
    until: Option<usize>,
    /// Whether a correction has been solved.
    corrected: bool,
    /// In place of the preconditioner, once iterations have cost as much as they do.
    pub(super) factors: DueFactors,
    made_for: Option<MadeFor>,
}

impl Solver {
    /// For tangents whose projected bulk moduli are at most `most` shear moduli. Where that is a
    /// bound the preconditioner is made at once, but in a plane and for few nodes: measured on a pipe
    /// of ν = 0.4995 in plane strain, 100 to 190 products a correction by the diagonal alone, and
    /// more than 1000 with it.
    pub fn new(model: &Model, most: f64) -> Solver {
        let at_rest = Stiffness::new(model, most);
        let nodes = if model.components == 3 { model.positions.len() } else { 0 };
        let at_once = nodes > FEW_NODES || (most.is_finite() && nodes >= LEAST_NODES);
        let preconditioner = at_once.then(|| Preconditioner::new(model, &at_rest)).flatten();
        let few = !at_once && (LEAST_NODES..=FEW_NODES).contains(&nodes);
        Solver {
            at_rest,
            preconditioner,
            until: few.then_some(OF_FIRST),
            corrected: false,
            factors: DueFactors::default(),
            made_for: None,
        }
    }

    /// The diagonal of the stiffness at rest \[node\] \[N/m\].
    pub fn diagonal(&self) -> &[f64] {
        &self.at_rest.diagonal
    }

    /// Counts a product; whether the preconditioner was due with it and has been made.
    fn has_become_due(&mut self, model: &Model) -> bool {
        let Some(left) = self.until else { return false };
        self.until = left.checked_sub(1);
        if self.until.is_none() {
            self.preconditioner = Preconditioner::new(model, &self.at_rest);
        }
        self.preconditioner.is_some()
    }

    /// Makes the preconditioner anew where it would no longer serve.
    pub(super) fn prepare(&mut self, free: &FreeSpace, shift: f64) {
        if self.preconditioner.is_none() && !self.factors.are_made() {
            return;
        }
        let now = MadeFor::now(free, shift);
        self.factors.keep_for(&now);
        let Some(preconditioner) = &mut self.preconditioner else { return };
        if self.made_for.as_ref().is_some_and(|made| made.serves(&now)) {
            return;
        }
        let stiffness = |node: u32| self.at_rest.diagonal[node as usize];
        let held = |(node, along)| Held { node, along, stiffness: stiffness(node) };
        let held: Vec<_> = free.held().into_iter().map(held).collect();
        preconditioner.hold(&self.at_rest, &held, shift);
        self.made_for = Some(now);
    }

    /// Counts a product; whether what preconditions is another since.
    pub(super) fn count(&mut self, model: &Model, free: &FreeSpace, system: &mut System) -> bool {
        let due = self.has_become_due(model);
        if due {
            self.prepare(free, system.shift);
        }
        self.factors.count(model, free, &self.at_rest, system) || due
    }

    /// Conjugate gradients within the free displacements, while `go_on` says so.
    pub fn solve(
        &mut self,
        model: &Model,
        free: &mut FreeSpace,
        mut system: System,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Correction {
        if let Some(saddle) = system.saddle.take() {
            return self.solve_saddle(model, free, system, saddle, go_on);
        }
        let (forcing, shift) = (system.forcing, system.shift);
        let mut change = std::mem::take(&mut system.change);
        self.prepare(free, shift);
        let (mut residual, mut products) = self.beside(model, &mut system, &change);
        let mut descent = self.preconditioned(model, free, &mut residual);
        let mut direction = descent.clone();
        let mut square = dot(&residual, &descent);
        let target = forcing * forcing * norm_squared(model, &residual);
        let most = PATIENCE + 2 * tangent_size(model, free);
        let (mut indefinite, mut stopped) = (false, false);
        for count in 0..most {
            let left = norm_squared(model, &residual);
            stopped = !go_on();
            if stopped || square.is_nan() || left <= target {
                break;
            }
            products += 1;
            let product = system.stiffness_times(model, &self.at_rest.diagonal, &direction);
            let curvature = dot(&direction, &product);
            if curvature <= 0.0 {
                if count == 0 {
                    axpy(&mut change, square / curvature.abs(), &direction);
                }
                indefinite = true;
                self.factors.leave();
                break;
            }
            axpy(&mut change, square / curvature, &direction);
            axpy(&mut residual, -square / curvature, &product);
            let due = self.count(model, free, &mut system);
            let restart = due || count + 1 == PATIENCE && self.preconditioner.take().is_some();
            descent = self.preconditioned(model, free, &mut residual);
            let before = std::mem::replace(&mut square, dot(&residual, &descent));
            if restart {
                direction.clone_from(&descent);
                continue;
            }
            for (p, z) in direction.iter_mut().zip(&descent) {
                *p = z + square / before * *p;
            }
        }
        // Each takes more than the one before; what was not due with the first is due late.
        self.until = self.until.map(|left| if self.corrected { left } else { OF_ALL });
        self.corrected = true;
        let of_factors = self.factors.take_cost();
        Correction { change, indefinite, products, of_factors, stopped, ..Correction::default() }
    }

    /// What a change \[m\] that is made at once leaves of the residual \[N\], and the products that
    /// took.
    fn beside(&self, model: &Model, system: &mut System, change: &[f64]) -> (Vec<f64>, usize) {
        let mut residual = std::mem::take(&mut system.residual);
        if largest(change) == 0.0 {
            return (residual, 0);
        }
        let product = system.stiffness_times(model, &self.at_rest.diagonal, change);
        axpy(&mut residual, -1.0, &product);
        (residual, 1)
    }

    /// z = Π B r; r becomes M Π M⁻¹ r, without the forces of what is held, whose round-off
    /// would exceed the rest.
    pub(super) fn preconditioned(
        &mut self,
        model: &Model,
        free: &mut FreeSpace,
        residual: &mut [f64],
    ) -> Vec<f64> {
        let d = model.components;
        let mut descent = model.accelerations(residual);
        free.project(&mut descent);
        for (i, (r, z)) in residual.iter_mut().zip(&descent).enumerate() {
            *r = model.inertia[i / d] * z;
        }
        if self.factors.are_made() {
            descent.copy_from_slice(residual);
            self.factors.solve(&mut descent);
            free.project(&mut descent);
        } else if let Some(preconditioner) = &mut self.preconditioner {
            preconditioner.apply(d, residual, &mut descent);
            free.project(&mut descent);
        } else if self.at_rest.most.is_finite() {
            // Beside pressures the scale of displacements counts.
            for (i, (r, z)) in residual.iter().zip(&mut descent).enumerate() {
                *z = r / self.at_rest.diagonal[i / d];
            }
            free.project(&mut descent);
        }
        descent
    }
}

/// rᵀ M⁻¹ r.
fn norm_squared(model: &Model, residual: &[f64]) -> f64 {
    let d = model.components;
    residual.iter().enumerate().map(|(i, r)| r * r / model.inertia[i / d]).sum()
}

/// Number of free displacements.
fn tangent_size(model: &Model, free: &FreeSpace) -> usize {
    model.size().saturating_sub(free.held().len()).max(1)
}
