//! A correction of Newton's method, joined from those of unit pressures of fluids.

use super::linear::{Correction, Saddle, System};
use super::solver::{Equilibrium, Solver};
use crate::algebra::packed::{axpy, dot, largest};
use crate::model::Model;
use crate::model::following::{CavityLoad, OwnFluid};
use crate::motion::step::Buffers;
use crate::motion::tangent::Tangent;
use nalgebra::{DMatrix, DVector};

/// Part of the stiffness of a fluid that its tangent has at most \[–\].
const MOST: f64 = 0.5;

/// The row bᵀ Δu + C Δp = m of a fluid (method book, eq. 21.19), and its column a.
struct FluidRow {
    cavity: usize,
    /// The force of a unit pressure \[N/Pa\].
    push: Vec<f64>,
    /// b = ∂V/∂u \[m²\].
    slope: Vec<f64>,
    /// C \[m³/Pa\].
    compliance: f64,
    /// m \[m³\].
    mismatch: f64,
    /// s \[Pa/m³\].
    stiffness: f64,
}

impl FluidRow {
    /// 1 − s C \[–\].
    fn rest(&self) -> f64 {
        1.0 - self.stiffness * self.compliance
    }
}

/// Round-off of the forces of fluids whose pressures follow from the displacements \[N\].
pub(super) fn round_off_of_fluids(model: &Model, u: &[f64]) -> f64 {
    let of_cavity = |cavity: &CavityLoad| {
        let compliance = cavity.compliance()?;
        let (push, _) = cavity.row(u, model.components);
        Some(f64::EPSILON * cavity.volume_at_rest() / compliance * largest(&push))
    };
    model.following.cavities.iter().filter_map(of_cavity).fold(0.0, f64::max)
}

impl Solver<'_> {
    /// The correction of an imbalance, which begins with a `change` \[m\].
    pub(super) fn correction(
        &mut self,
        (now, fraction): (&Equilibrium, f64),
        change: Vec<f64>,
        forcing: f64,
        only_resisting: bool,
        buffers: &mut Buffers,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Correction {
        let model = self.model;
        let forces = self.contact_forces(&now.imbalance);
        let sliding = self.contacts.sliding_stiffness(model, &now.u, &forces, only_resisting);
        let saddle = self.own.patches.as_ref().map(|pressures| pressures.saddle(model));
        let still = saddle.as_ref().map(Saddle::still);
        let residual = now.imbalance.free(model);
        let mut solve = |solver: &mut Self, residual, change, saddle| {
            let own = &solver.own;
            let tangent = Tangent::new(model, &now.u, solver.free.t, &mut buffers.workspace)
                .with_pressures(own.patches.as_ref().map(|pressures| pressures.own.clone()))
                .with_fluids(own.fluids.as_deref());
            let (shift, guide, sliding) = (solver.shift, solver.guide.as_ref(), sliding.clone());
            let system =
                System { tangent, residual, change, forcing, sliding, shift, guide, saddle };
            let correction = solver.linear.solve(model, &mut solver.free, system, go_on);
            solver.counts.products += correction.products;
            solver.counts.evaluations += correction.products + correction.of_factors;
            correction
        };
        let mut correction = solve(self, residual, change, saddle);
        self.counts.iterations += 1;
        let rows = self.fluid_rows(&now.u, fraction);
        if !rows.is_empty() && !correction.stopped {
            let mut units = Vec::with_capacity(rows.len());
            for row in &rows {
                let push = self.free_part(&row.push);
                units.push(solve(self, push, vec![0.0; model.size()], still.clone()));
            }
            correction.stopped = units.iter().any(|unit| unit.stopped);
            self.join(&mut correction, &rows, &units);
        }
        correction
    }

    /// What is left of forces \[N\] without those that hold.
    pub(super) fn free_part(&mut self, forces: &[f64]) -> Vec<f64> {
        let model = self.model;
        let mut free = model.accelerations(forces);
        self.free.project(&mut free);
        let d = model.components;
        free.iter_mut().enumerate().for_each(|(i, a)| *a *= model.inertia[i / d]);
        free
    }
}

impl Solver<'_> {
    /// Makes the pressures of fluids unknowns, from those on that balance best at the start: what
    /// fills a cavity at once is part of the load.
    pub(super) fn free_fluids(&mut self, u: &[f64], buffers: &mut Buffers) {
        let (model, t, d) = (self.model, self.free.t, self.model.components);
        if !model.following.has_fluid() {
            return;
        }
        let cavities = &model.following.cavities;
        let none = OwnFluid { pressure: 0.0, stiffness: 0.0 };
        self.own.fluids = Some(vec![none; cavities.len()]);
        let left = self.imbalance(u, 0.0, buffers);
        let mut own = Vec::with_capacity(cavities.len());
        for cavity in cavities {
            let Some(compliance) = cavity.compliance() else {
                own.push(none);
                self.path.excess.push(0.0);
                continue;
            };
            let (push, _) = cavity.row(u, d);
            let free = self.free_part(&push);
            let size = dot(&free, &model.accelerations(&free)).max(f64::MIN_POSITIVE);
            let pressure = -dot(&free, &left.acceleration) / size;
            // As stiff against a push as the nodes of the wall.
            let diagonal = self.linear.diagonal();
            let soft: f64 = push.iter().enumerate().map(|(i, f)| f * f / diagonal[i / d]).sum();
            let stiffness = (1.0 / soft).min(MOST / compliance);
            self.path.excess.push(cavity.state(t, u, d).pressure - pressure);
            own.push(OwnFluid { pressure, stiffness });
        }
        self.own.fluids = Some(own);
    }

    /// The pressures of the volumes at displacements `u` \[m\] and a fraction of the load.
    pub(super) fn exact_fluids(&self, u: &[f64], fraction: f64) -> Option<Vec<OwnFluid>> {
        let (model, own) = (self.model, self.own.fluids.as_ref()?);
        let t = self.path.time(fraction);
        let cavities = model.following.cavities.iter().zip(own).zip(&self.path.excess);
        let exact = |((cavity, own), excess): ((&CavityLoad, &OwnFluid), &f64)| OwnFluid {
            pressure: cavity.state(t, u, model.components).pressure - (1.0 - fraction) * excess,
            ..*own
        };
        Some(cavities.map(exact).collect())
    }

    /// The rows of the fluids at displacements `u` \[m\] and a fraction of the load.
    fn fluid_rows(&self, u: &[f64], fraction: f64) -> Vec<FluidRow> {
        let (Some(own), Some(exact)) = (&self.own.fluids, self.exact_fluids(u, fraction)) else {
            return Vec::new();
        };
        let row = |(cavity, (own, exact)): (usize, (&OwnFluid, OwnFluid))| {
            let load = &self.model.following.cavities[cavity];
            let compliance = load.compliance()?;
            let (push, slope) = load.row(u, self.model.components);
            let mismatch = compliance * (exact.pressure - own.pressure);
            let stiffness = own.stiffness;
            Some(FluidRow { cavity, push, slope, compliance, mismatch, stiffness })
        };
        own.iter().zip(exact).enumerate().filter_map(row).collect()
    }

    /// Joins a correction at pressures that stay with those of unit pressures, so that the rows of
    /// the fluids hold.
    fn join(&self, correction: &mut Correction, rows: &[FluidRow], units: &[Correction]) {
        let count = rows.len();
        let entry = |i: usize, j: usize| {
            let own = if i == j { rows[i].compliance / rows[i].rest() } else { 0.0 };
            dot(&rows[i].slope, &units[j].change) + own
        };
        let right = |i: usize| {
            let FluidRow { slope, compliance, mismatch, stiffness, .. } = &rows[i];
            mismatch * (1.0 + compliance * stiffness / rows[i].rest())
                - dot(slope, &correction.change)
        };
        let matrix = DMatrix::from_fn(count, count, entry);
        let right = DVector::from_fn(count, |i, _| right(i));
        let factors = matrix.lu().solve(&right).unwrap_or_else(|| DVector::zeros(count));
        correction.fluids = vec![0.0; self.model.following.cavities.len()];
        for ((row, unit), factor) in rows.iter().zip(units).zip(&factors) {
            axpy(&mut correction.change, *factor, &unit.change);
            axpy(&mut correction.pressures, *factor, &unit.pressures);
            correction.fluids[row.cavity] = (factor - row.stiffness * row.mismatch) / row.rest();
        }
    }
}
