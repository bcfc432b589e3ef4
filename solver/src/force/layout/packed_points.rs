//! The quadrature points of a body in blocks.

use super::block::Block;
use super::partition::blocks;
use super::summation::Sums;
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::problem::Problem;

/// The quadrature points of a body, packed for vector instructions: all that internal forces and
/// their derivative need beside displacements.
#[derive(Debug, Clone)]
pub struct PackedPoints {
    /// Displacement components per node: 3, or 2 in a plane.
    pub components: usize,
    /// The points, block by block.
    pub blocks: Vec<Block>,
    /// The order in which the forces of the blocks are summed.
    pub sums: Sums,
}

impl PackedPoints {
    /// Packs the points of a discretisation with the laws of their regions.
    ///
    /// # Errors
    /// [`Error::LargeSupports`] if the points of one patch see more nodes than a block can have, and
    /// fibres without a direction.
    pub fn new(problem: &Problem, discretisation: &Discretisation) -> Result<PackedPoints, Error> {
        let blocks = blocks(problem, discretisation)?;
        Ok(PackedPoints {
            components: discretisation.dimension.components(),
            sums: Sums::new(&blocks, discretisation.cloud.positions.len()),
            blocks,
        })
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.blocks.last().map_or(0, |block| block.points.end)
    }
}
