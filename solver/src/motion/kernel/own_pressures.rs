//! Pressures of patches as unknowns beside the displacements.
#![allow(non_snake_case)]

use crate::model::projection::OwnPressure;
use crate::model::{Model, ModuliAtRest};

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
    /// [`OwnPressure::part`].
    part: f64,
}

impl BlockPressures {
    /// Of one patch.
    #[inline(always)]
    pub fn of(&self, patch: usize) -> OwnPressure {
        OwnPressure { moments: self.moments[patch], part: self.part }
    }
}

impl OwnPressures {
    /// All are 0. The part c of each block is such that no more than `most` shear moduli
    /// of its projected bulk modulus act in the tangent (method book, eq. 21.14).
    pub fn zero(model: &Model, most: f64) -> OwnPressures {
        let blocks = model.blocks.iter().map(|block| {
            let moduli = ModuliAtRest::of(block);
            let patches = if block.projection.is_some() { block.chunks.len() } else { 0 };
            BlockPressures {
                moments: vec![[0.0; 4]; patches],
                part: moduli.capped(most).projected / moduli.projected,
            }
        });
        OwnPressures { blocks: blocks.collect() }
    }

    /// Of a block of the model.
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

    /// Goes `factor` times the part c of the way to the pressures that J gives, no farther than
    /// to them.
    pub fn approach<'a>(&mut self, of_j: impl Iterator<Item = &'a [[f64; 4]]>, factor: f64) {
        for (block, found) in self.blocks.iter_mut().zip(of_j) {
            let part = (factor * block.part).min(1.0);
            for (moments, found) in block.moments.iter_mut().zip(found) {
                *moments = OwnPressure { moments: *moments, part }.approached(*found);
            }
        }
    }
}
