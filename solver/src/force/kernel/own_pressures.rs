//! Pressures of patches as unknowns beside the displacements.
#![allow(non_snake_case)]

use crate::force::at_rest::ModuliAtRest;
use crate::force::layout::PackedPoints;
use crate::force::projection::OwnPressure;

/// Of the patches of all blocks.
#[derive(Debug, Clone)]
pub struct OwnPressures {
    blocks: Vec<BlockPressures>,
}

/// Of the patches of a block.
#[derive(Debug, Clone)]
pub struct BlockPressures {
    /// [`OwnPressure::moments`] \[patch\].
    moments: Vec<[f64; 4]>,
    /// [`OwnPressure::slopes`] \[patch\].
    slopes: Vec<[f64; 4]>,
    /// [`OwnPressure::part`].
    part: f64,
}

impl BlockPressures {
    /// Of one patch.
    #[inline(always)]
    pub fn of(&self, patch: usize) -> OwnPressure {
        let (moments, slopes) = (self.moments[patch], self.slopes[patch]);
        OwnPressure { moments, slopes, part: self.part }
    }
}

impl OwnPressures {
    /// All are 0. The part c of each block is such that no more than `most` shear moduli
    /// of its projected bulk modulus act beside them (method book, eq. 21.14).
    pub fn zero(points: &PackedPoints, most: f64) -> OwnPressures {
        let blocks = points.blocks.iter().map(|block| {
            let patches = if block.projection.is_some() { block.chunks.len() } else { 0 };
            BlockPressures {
                moments: vec![[0.0; 4]; patches],
                slopes: vec![[0.0; 4]; patches],
                part: ModuliAtRest::of(block).part_within(most),
            }
        });
        OwnPressures { blocks: blocks.collect() }
    }

    /// Of a block of the body.
    pub fn block(&self, index: usize) -> &BlockPressures {
        &self.blocks[index]
    }

    /// The moments, patch by patch.
    pub fn values(&self) -> Vec<f64> {
        self.blocks.iter().flat_map(|b| b.moments.as_flattened().iter().copied()).collect()
    }

    /// Replaces them.
    pub fn set_values(&mut self, values: &[f64]) {
        let all = self.blocks.iter_mut().flat_map(|b| b.moments.as_flattened_mut());
        all.zip(values).for_each(|(a, b)| *a = *b);
    }

    /// Replaces what a derivative adds to the slopes that J gives.
    pub fn set_slopes(&mut self, slopes: &[f64]) {
        let all = self.blocks.iter_mut().flat_map(|b| b.slopes.as_flattened_mut());
        all.zip(slopes).for_each(|(a, b)| *a = *b);
    }
}
