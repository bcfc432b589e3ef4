//! Zero-energy modes of a body: counted, located and refused.

use super::least_captured::{CapturedMotion, least_captured};
use super::pencil::Pencil;
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::model::Model;
use crate::problem::Problem;

/// Captured fraction of its strain energy below which a motion is a zero-energy
/// mode \[–\]. Measured in space and in a plane, on lattices and on clouds with a
/// jitter of 0.3 and 0.45: 0.92 points per node or fewer leave such modes whatever
/// the dilation and the basis; the default recipe captures more than 0.2 of every
/// motion.
pub const ZERO_ENERGY_FRACTION: f64 = 0.05;

/// Points per node up to which recipes are tested for zero-energy modes \[–\].
const FEW: f64 = 1.1;

/// The zero-energy modes of a body.
#[derive(Debug, Clone)]
pub struct ZeroEnergyModes {
    /// Number of modes; `None` for more than 4500 unknowns and constraints.
    pub count: Option<usize>,
    /// Motions with the smallest captured fractions, ascending. They come from a
    /// minimisation, so at least as many modes exist as fractions lie below
    /// [`ZERO_ENERGY_FRACTION`].
    pub least_captured: Vec<CapturedMotion>,
    /// Rigid motions that the conditions at t = 0 leave free.
    pub rigid: usize,
    /// Quadrature points of the finer rule.
    pub finer_points: usize,
}

impl ZeroEnergyModes {
    /// Lower bound of the number of modes.
    pub fn at_least(&self) -> usize {
        self.count.unwrap_or(0).max(below_limit(&self.least_captured))
    }
}

/// The motions below [`ZERO_ENERGY_FRACTION`].
fn below_limit(motions: &[CapturedMotion]) -> usize {
    motions.iter().filter(|motion| motion.fraction < ZERO_ENERGY_FRACTION).count()
}

/// Counts and locates the zero-energy modes of a body at rest under the conditions
/// at t = 0.
pub fn zero_energy_modes(
    problem: &Problem,
    discretisation: &Discretisation,
    model: &Model,
) -> Result<ZeroEnergyModes, Error> {
    let pencil = Pencil::new(problem, discretisation, model)?;
    Ok(ZeroEnergyModes {
        count: pencil.count_below(ZERO_ENERGY_FRACTION),
        least_captured: least_captured(&pencil, 0.0),
        rigid: pencil.free_rigid_motions(),
        finer_points: pencil.finer_points(),
    })
}

/// Refuses a recipe with zero-energy modes; recipes with more than 1.1 points per
/// node are not tested.
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
    let motions = least_captured(&pencil, ZERO_ENERGY_FRACTION);
    let below = below_limit(&motions);
    match motions.first() {
        Some(CapturedMotion { fraction, node, position }) if below > 0 => {
            Err(Error::ZeroEnergyModes {
                points,
                nodes,
                modes: pencil.count_below(ZERO_ENERGY_FRACTION).unwrap_or(0).max(below),
                fraction: *fraction,
                node: *node,
                position: *position,
            })
        }
        _ => Ok(()),
    }
}
