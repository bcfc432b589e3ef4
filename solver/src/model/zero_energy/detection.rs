//! Zero-energy modes of a body: counted, located and refused.

use super::least_captured::{CapturedMotion, least_captured};
use super::neighbourhood::{least_captured_nearby, points_per_spacing};
use super::pencil::{POINTS_PER_NODE, POINTS_PER_POINT, Pencil};
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::model::Model;
use crate::model::rigid_motions::free_rigid_motions;
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
    /// Rigid motions that the conditions at t = 0 and contacts closed then leave free.
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
        rigid: free_rigid_motions(model, 0.0, &vec![0.0; model.size()]),
        finer_points: pencil.finer_points(),
    })
}

/// Number of points of the finer rule by which [`refuse_zero_energy_modes`] tests a recipe;
/// 0 where it does not.
pub fn tested_points(discretisation: &Discretisation) -> f64 {
    let (points, nodes) = (discretisation.supports.len(), discretisation.deforming_nodes());
    let few = points as f64 <= FEW * nodes as f64;
    if few || points_per_spacing(discretisation).iter().any(|&density| density < FEW) {
        f64::max(POINTS_PER_POINT * points as f64, POINTS_PER_NODE * nodes as f64)
    } else {
        0.0
    }
}

/// Refuses a recipe with zero-energy modes. Neighbourhoods are tested where a node has
/// fewer than 1.1 points per spacing squared or cubed, the whole body where it has no
/// more than 1.1 points per node.
pub fn refuse_zero_energy_modes(
    problem: &Problem,
    discretisation: &Discretisation,
    model: &Model,
) -> Result<(), Error> {
    let (points, nodes) = (discretisation.supports.len(), discretisation.deforming_nodes());
    let few = points as f64 <= FEW * nodes as f64;
    let density = points_per_spacing(discretisation);
    let sparse: Vec<u32> = (0..nodes as u32).filter(|&node| density[node as usize] < FEW).collect();
    if !few && sparse.is_empty() {
        return Ok(());
    }
    let pencil = Pencil::new(problem, discretisation, model)?;
    let nearby = least_captured_nearby(&pencil, &density, sparse);
    let mut motions: Vec<CapturedMotion> = nearby.into_iter().collect();
    if few && below_limit(&motions) == 0 {
        motions = least_captured(&pencil, ZERO_ENERGY_FRACTION);
    }
    let below = below_limit(&motions);
    match motions.first() {
        Some(CapturedMotion { fraction, node, position }) if below > 0 => {
            Err(Error::ZeroEnergyModes {
                points,
                nodes,
                modes: pencil.count_below(ZERO_ENERGY_FRACTION).unwrap_or(0).max(below),
                fraction: *fraction,
                node: *node,
                density: density[*node],
                position: *position,
            })
        }
        _ => Ok(()),
    }
}
