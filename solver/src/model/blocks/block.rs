//! A block of quadrature points.

use super::stored_gradients::{StoredGradients, with_gradients};
use crate::algebra::lanes::LANES;
use crate::material::Law;
use crate::model::projection::Projection;
use std::ops::Range;

/// Consecutive quadrature points of one material, with a numbering of their own of
/// the nodes in their supports. Blocks depend on the problem alone, never on the
/// number of threads.
#[derive(Debug, Clone)]
pub struct Block {
    /// The constitutive law.
    pub law: Law,
    /// Global quadrature points.
    pub points: Range<usize>,
    /// Global node of each local one.
    pub nodes: Vec<u32>,
    /// Support of local point p: `starts[p]..starts[p + 1]`, padded to a multiple of
    /// four with its last node and gradients of 0.
    pub starts: Vec<u32>,
    /// Local node indices \[support entry\].
    pub supports: Vec<u32>,
    /// Grad φ \[support entry\] \[1/m\].
    pub grad_phi: StoredGradients,
    /// \[point\] \[m³\]
    pub quadrature_weights: Vec<f64>,
    /// Local points of chunk c: `chunks[c]..chunks[c + 1]`; a patch, or a few points
    /// where nothing is projected.
    pub chunks: Vec<u32>,
    /// Only where the material is nearly incompressible.
    pub projection: Option<Projection>,
}

impl Block {
    /// Local nodes and gradients, D components each, of the support of a local point;
    /// `grad_phi` are the numbers of [`Block::grad_phi`].
    #[inline(always)]
    pub fn support<'a, G, const D: usize>(
        &'a self,
        grad_phi: &'a [G],
        point: usize,
    ) -> (&'a [u32], &'a [[G; D]]) {
        let entries = self.starts[point] as usize..self.starts[point + 1] as usize;
        (&self.supports[entries.clone()], &grad_phi.as_chunks::<D>().0[entries])
    }

    /// The entries from `ahead` entries after the start of a support on.
    #[inline(always)]
    pub fn entries_ahead<'a, G, const D: usize>(
        &'a self,
        grad_phi: &'a [G],
        point: usize,
        ahead: usize,
    ) -> (&'a [u32], &'a [[G; D]]) {
        let first = (self.starts[point] as usize + ahead).min(self.supports.len());
        (&self.supports[first..], &grad_phi.as_chunks::<D>().0[first..])
    }

    /// Bytes that one evaluation of the internal force reads.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.supports[..])
            + with_gradients!(&self.grad_phi, grad_phi => size_of_val(&grad_phi[..]))
    }

    /// The chunks, in order.
    pub fn chunks(&self) -> impl Iterator<Item = Chunk> {
        let mut groups = 0..0;
        self.chunks.windows(2).map(move |ends| {
            let points = ends[0] as usize..ends[1] as usize;
            groups = groups.end..groups.end + points.len().div_ceil(LANES);
            Chunk { points, groups: groups.clone() }
        })
    }
}

/// Points whose forces are computed together.
#[derive(Debug, Clone)]
pub struct Chunk {
    /// Local points.
    pub points: Range<usize>,
    /// Their SIMD blocks, counted through the block.
    pub groups: Range<usize>,
}
