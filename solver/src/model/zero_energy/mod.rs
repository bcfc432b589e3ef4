//! Motions that the quadrature does not see: zero-energy modes.
//!
//! A motion v counts as a zero-energy mode where the quadrature of the model
//! sees less than the share [`SEEN`] of the strain energy that a finer rule
//! over the same shape functions sees:
//!
//! (vᵀK v + δ vᵀM v)/(vᵀK̂ v + δ vᵀM v) < SEEN, v as the conditions allow,
//!
//! with vᵀK v = Σ_q w_q ε_q : ε_q, K̂ the same by the finer rule, M the volumes
//! of the nodes and δ = 1/L², L the size of the body. The ratio has no unit and
//! does not depend on the spacing; smooth motions have 1 however soft they are,
//! rigid ones too by the terms with δ. Materials play no part: every sound one
//! resists ε at each point by its shear and the pointwise part of its bulk
//! term, so that the motions without any energy are the same for all.
#![allow(non_snake_case)]

mod lowest;
mod pencil;

use crate::algebra::tensor::Vector3;
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::model::Model;
use crate::problem::Problem;
use pencil::Pencil;

/// Share of its strain energy below which a motion counts as one of zero
/// energy \[–\]. Measured in space and in a plane, on lattices and on clouds
/// with a jitter of 0.3 and 0.45: 0.92 points per node or fewer leave motions
/// below it whatever the dilation and the basis; the default recipe sees more
/// than 0.2 of every motion.
pub const SEEN: f64 = 0.05;

/// Up to this many unknowns and constraints all modes are counted \[–\].
pub const LARGEST_COUNT: usize = 4500;

/// Points per node up to which a recipe is suspected \[–\].
const FEW: f64 = 1.1;

/// What was found about zero-energy modes.
#[derive(Debug, Clone)]
pub struct ZeroEnergyModes {
    /// Number of all modes; `None` where the body is too large to count.
    pub count: Option<usize>,
    /// The motions that are seen least, ascending; found by minimisation, so
    /// that at least as many modes exist as shares lie below [`SEEN`].
    pub softest: Vec<SoftMotion>,
    /// Rigid motions that the conditions of the start leave free.
    pub rigid: usize,
    /// Quadrature points of the finer rule.
    pub finer_points: usize,
}

/// A motion that the quadrature sees in part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoftMotion {
    /// Of its strain energy by the finer rule \[–\].
    pub share: f64,
    /// The node that moves most.
    pub node: usize,
    pub position: Vector3,
}

impl ZeroEnergyModes {
    /// Modes that exist for sure.
    pub fn at_least(&self) -> usize {
        let found = self.softest.iter().filter(|motion| motion.share < SEEN).count();
        self.count.unwrap_or(0).max(found)
    }
}

/// Counts and finds the zero-energy modes of a body at rest under the
/// conditions of the start.
pub fn zero_energy_modes(
    problem: &Problem,
    discretisation: &Discretisation,
    model: &Model,
) -> Result<ZeroEnergyModes, Error> {
    let pencil = Pencil::new(problem, discretisation, model)?;
    Ok(ZeroEnergyModes {
        count: pencil.count_below(SEEN),
        softest: lowest::softest(&pencil, 0.0),
        rigid: pencil.free_rigid_motions(),
        finer_points: pencil.finer_points(),
    })
}

/// Refuses a recipe with few points if that leaves zero-energy modes; nothing
/// is computed for recipes with more than 1.1 points per node.
pub fn refuse_zero_energy_modes(
    problem: &Problem,
    discretisation: &Discretisation,
    model: &Model,
) -> Result<(), Error> {
    let (points, nodes) = (discretisation.supports.len(), model.positions.len());
    if points as f64 > FEW * nodes as f64 {
        return Ok(());
    }
    let pencil = Pencil::new(problem, discretisation, model)?;
    let softest = lowest::softest(&pencil, SEEN);
    let found = softest.iter().filter(|motion| motion.share < SEEN).count();
    match softest.first() {
        Some(SoftMotion { share, node, position }) if found > 0 => Err(Error::ZeroEnergyModes {
            points,
            nodes,
            modes: pencil.count_below(SEEN).unwrap_or(0).max(found),
            share: *share,
            node: *node,
            position: *position,
        }),
        _ => Ok(()),
    }
}
