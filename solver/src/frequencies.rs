//! Natural frequencies of a body at rest.
//!
//! Small free vibrations u(t) = φ cos(ω t) about u = 0 meet K φ = ω² M φ, with the tangent K at u = 0
//! and the masses M of the body, among the displacements that the conditions of t = 0 leave
//! free (method book, eqs. 30.1 to 30.4). Loads and obstacles play no part in them.
//!
//! ```
//! use mtled::{
//!     Discretisation, ElasticConstants, Law, MassKind, Material, Model, NaturalModes, NeoHookeanLogJ,
//!     Problem, Recipe, Shape, Vector3, body_at_rest,
//! };
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(0.1) };
//! let law = NeoHookeanLogJ::new(ElasticConstants::from_young_poisson(3000.0, 0.3)?);
//! let tissue = Material { density: 1000.0, law: Law::NeoHookeanLogJ(law) };
//! let problem = body_at_rest(&Problem::new(body, tissue, Recipe::with_spacing(0.0125)));
//! let discretisation = Discretisation::new(&problem)?;
//! let model = Model::new(&problem, &discretisation)?;
//! let asked = (5, MassKind::Consistent);
//! let found = NaturalModes::find(&problem, &discretisation, &model, asked, &mut |_| true)?;
//! assert!(found.converged() && found.rigid_motions == 6);
//! assert!((found.modes[0].frequency - 4.883).abs() < 0.01);
//! # Ok(())
//! # }
//! ```

use crate::algebra::lowest_modes::{Operators, Pair, lowest_pairs};
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::model::{Model, masses};
use crate::motion::newton::{MassPlaces, Vibration};
use crate::problem::{Loads, Motion, Problem, Relaxation, RelaxationMass};
use std::f64::consts::TAU;

/// Residual of a mode up to which its frequency counts as found \[–\].
pub const CONVERGED: f64 = 1e-6;
/// Part of the residual at which the search ends \[–\]: what is said to be found is so by a
/// product of its own.
const ENOUGH: f64 = 0.5;
/// Displacement over the largest from which on one decides on the sign of a mode \[–\].
const LARGE: f64 = 0.99;

/// The masses of natural frequencies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MassKind {
    /// Those of the quadrature points, which move with the displacement there.
    Consistent,
    /// The lumped masses of motions, which move with the displacement at their nodes.
    Lumped,
}

/// The lowest natural frequencies of a body.
#[derive(Debug, Clone)]
pub struct NaturalModes {
    /// Rigid motions that nothing prevents, of all pieces of the body together: as many frequencies
    /// of 0.
    pub rigid_motions: usize,
    /// The lowest ones of elastic vibrations, in ascending order.
    pub modes: Vec<NaturalMode>,
    /// Products with K that were needed.
    pub products: usize,
    /// Whether the caller ended the search; there are no modes then.
    pub stopped: bool,
}

/// A natural frequency and how the body moves.
#[derive(Debug, Clone)]
pub struct NaturalMode {
    /// ω/2π \[Hz\].
    pub frequency: f64,
    /// √(rᵀ K⁻¹ r)/ω of r = K φ − ω² M φ \[–\]: some ω² of the discretised body differs from this one
    /// by at most this part of itself (method book, eq. 30.4).
    pub residual: f64,
    /// Whether the residual is at most [`CONVERGED`].
    pub converged: bool,
    /// φ with φᵀ M φ = 1 kg·m², nodal parameters \[component of node\] \[m\]; its largest component
    /// is positive.
    pub motion: Vec<f64>,
}

impl NaturalModes {
    /// Whether all modes have been found.
    pub fn converged(&self) -> bool {
        !self.stopped && self.modes.iter().all(|mode| mode.converged)
    }

    /// So many of the lowest natural frequencies beside those of rigid motions. The parts are those
    /// of [`body_at_rest`]. `go_on` takes the number of those found so far; its `false` ends the search.
    ///
    /// # Errors
    /// [`Error::NoFrequencies`], [`Error::TooManyFrequencies`], and [`Error::FictitiousMass`] for a
    /// model whose masses are not those of the body.
    pub fn find(
        problem: &Problem,
        discretisation: &Discretisation,
        model: &Model,
        (count, kind): (usize, MassKind),
        go_on: &mut dyn FnMut(usize) -> bool,
    ) -> Result<NaturalModes, Error> {
        let lumped = model.inertia == model.lumped_mass;
        let at_nodes = model.nodal_rows.as_ref().filter(|_| lumped).ok_or(Error::FictitiousMass)?;
        if count == 0 {
            return Err(Error::NoFrequencies);
        }
        let density: Vec<f64> = problem.regions.iter().map(|own| own.material.density).collect();
        let places = match kind {
            MassKind::Lumped => {
                vec![MassPlaces { rows: at_nodes, masses: model.lumped_mass.clone() }]
            }
            MassKind::Consistent => discretisation
                .volumes()
                .map(|(quadrature, rows)| MassPlaces {
                    rows,
                    masses: masses(quadrature, &density).collect(),
                })
                .collect(),
        };
        let mut vibration = Vibration::new(model, places, go_on);
        let (has, rigid) = (vibration.dimension(), vibration.rigid_motions());
        if count > has {
            let (asked, components) = (count, model.size());
            let held = components - has - rigid;
            return Err(Error::TooManyFrequencies { asked, has, components, held, rigid });
        }
        let pairs = lowest_pairs(&mut vibration, count, ENOUGH * CONVERGED);
        let stopped = pairs.is_none();
        let modes = pairs.into_iter().flatten().map(natural_mode).collect();
        Ok(NaturalModes { rigid_motions: rigid, modes, products: vibration.products, stopped })
    }
}

/// The problem without what plays no part in natural frequencies: loads, obstacles, active tension,
/// inflows, viscosity (what is left is the stiffness against sudden strains) and mass scaling. Conditions
/// stay, and what they prescribe counts as held; springs stay, and fluids with their stiffness.
pub fn body_at_rest(problem: &Problem) -> Problem {
    let mut rest = problem.clone();
    rest.loads = Loads {
        springs: problem.loads.springs.clone(),
        cavities: problem.loads.cavities.clone(),
        ..Loads::default()
    };
    for fluid in rest.loads.cavities.iter_mut().filter_map(|cavity| cavity.fluid.as_mut()) {
        fluid.inflow = 0.0;
    }
    rest.obstacles.clear();
    for region in &mut rest.regions {
        (region.viscosity, region.active) = (None, None);
        if !region.material.law.has_fibres() {
            region.fibres = None;
        }
    }
    let load_end = problem.motion.end();
    let mass = RelaxationMass::Lumped;
    rest.motion = Motion::Static(Relaxation { load_end, mass, ..Relaxation::default() });
    rest
}

fn natural_mode(pair: Pair) -> NaturalMode {
    let (mut motion, residual) = (pair.vector, pair.residual);
    let largest = motion.iter().fold(0.0f64, |largest, u| largest.max(u.abs()));
    // The first of those that are about as large: round-off must not choose.
    if motion.iter().find(|u| u.abs() >= LARGE * largest).is_some_and(|u| *u < 0.0) {
        motion.iter_mut().for_each(|u| *u = -*u);
    }
    NaturalMode {
        frequency: pair.value.max(0.0).sqrt() / TAU,
        residual,
        converged: pair.value > 0.0 && residual <= CONVERGED,
        motion,
    }
}

#[cfg(test)]
mod tests;
