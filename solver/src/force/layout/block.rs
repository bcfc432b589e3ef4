//! A block of quadrature points.
#![allow(non_snake_case)]

use super::local_vectors::{Place, QUAD, stride};
use super::stored_gradients::{GradientQuad, StoredGradients, with_gradients};
use crate::algebra::lanes::{LANES, SimdBlock};
use crate::algebra::tensor::Matrix3;
use crate::force::projection::Projection;
use crate::material::{Law, PronySeries};
use crate::problem::ActiveStress;
use std::ops::Range;

/// Consecutive quadrature points of one material, with a numbering of their own of
/// the nodes in their supports. Blocks depend on the problem alone, never on the
/// number of threads.
///
/// Points take lanes, [`LANES`] of them in a SIMD block, the larger supports of a chunk
/// first. Four lanes make a quad, which reads its supports slot by slot, one entry for
/// each lane (method book, section 11).
#[derive(Debug, Clone)]
pub struct Block {
    /// The constitutive law.
    pub law: Law,
    /// Fibre frames Q by rows \[SIMD block\]; nothing where neither the law nor an active stress
    /// has fibres.
    pub frames: Vec<[SimdBlock; 9]>,
    /// How the isochoric stress relaxes, where it does.
    pub viscosity: Option<PronySeries>,
    /// Along the fibres, where there is one.
    pub active: Option<ActiveStress>,
    /// Global quadrature points.
    pub points: Range<usize>,
    /// Global node of each local one.
    pub nodes: Vec<u32>,
    /// Local point in each lane; padding repeats one.
    pub lanes: Vec<u32>,
    /// Slots of quad g: `starts[g]..starts[g + 1]`.
    pub starts: Vec<u32>,
    /// The node in each lane of a slot. Lanes with fewer entries than others, and those
    /// without a point, are filled up with gradients of 0.
    pub places: Vec<[Place; QUAD]>,
    /// Grad φ \[slot\]\[component\]\[lane of the quad\] \[1/m\].
    pub grad_phi: StoredGradients,
    /// \[lane\] \[m³\], 0 for padding.
    pub quadrature_weights: Vec<f64>,
    /// In the order in which forces are computed.
    pub chunks: Vec<Chunk>,
    /// Only where the material is nearly incompressible.
    pub projection: Option<Projection>,
}

impl Block {
    /// Places and gradients, D components each, of the slots of a quad; `grad_phi` are the
    /// quads of [`Block::grad_phi`].
    #[inline(always)]
    pub fn slots<'a, G, const D: usize>(
        &'a self,
        grad_phi: &'a [G],
        quad: usize,
    ) -> (&'a [[Place; QUAD]], &'a [[G; D]]) {
        let slots = self.starts[quad] as usize..self.starts[quad + 1] as usize;
        let gradients = grad_phi.as_chunks::<D>().0;
        (&self.places[slots.clone()], &gradients[slots])
    }

    /// All slots that begin `ahead` slots after those of a quad.
    #[inline(always)]
    pub fn slots_ahead<'a, G, const D: usize>(
        &'a self,
        grad_phi: &'a [G],
        quad: usize,
        ahead: u32,
    ) -> (&'a [[Place; QUAD]], &'a [[G; D]]) {
        let first = ((self.starts[quad] + ahead) as usize).min(self.places.len());
        (&self.places[first..], &grad_phi.as_chunks::<D>().0[first..])
    }

    /// Local nodes and gradients of the support of the point in a lane, one entry after the
    /// other; what fills it up has gradients of 0.
    pub fn support<'a, G: GradientQuad, const D: usize>(
        &'a self,
        grad_phi: &'a [G],
        lane: usize,
    ) -> impl Iterator<Item = (usize, [f64; D])> + Clone + 'a {
        let (places, gradients) = self.slots::<G, D>(grad_phi, lane / QUAD);
        places.iter().zip(gradients).map(move |(places, gradients)| {
            let node = places[lane % QUAD] as usize / stride(D);
            (node, gradients.map(|component| component.at(lane % QUAD)))
        })
    }

    /// Local nodes of the support of the point in a lane, the last one again where it is filled up.
    pub fn support_nodes(
        &self,
        lane: usize,
        components: usize,
    ) -> impl Iterator<Item = usize> + Clone {
        let slots = self.starts[lane / QUAD] as usize..self.starts[lane / QUAD + 1] as usize;
        let places = self.places[slots].iter();
        places.map(move |places| places[lane % QUAD] as usize / stride(components))
    }

    /// The lanes with points, in order.
    pub fn occupied(&self) -> impl Iterator<Item = usize> {
        self.chunks.iter().flat_map(|chunk| chunk.lanes.clone())
    }

    /// Its SIMD blocks.
    pub fn groups(&self) -> usize {
        self.lanes.len() / LANES
    }

    /// Global quadrature point in a lane.
    pub fn point(&self, lane: usize) -> usize {
        self.points.start + self.lanes[lane] as usize
    }

    /// The fibre frame Q at the point in a lane, where the law has fibres.
    pub fn frame(&self, lane: usize) -> Option<Matrix3> {
        let frame = self.frames.get(lane / LANES)?;
        Some(Matrix3::from_row_iterator(frame.iter().map(|entry| entry.0[lane % LANES])))
    }

    /// A deformation gradient at the point in a lane as the law needs it: F Q, where it has fibres.
    pub fn as_the_law_needs(&self, F: &Matrix3, lane: usize) -> Matrix3 {
        self.frame(lane).filter(|_| self.law.has_fibres()).map_or(*F, |frame| F * frame)
    }

    /// Whether there are stresses beside those of the law.
    pub fn has_extra_stress(&self) -> bool {
        self.viscosity.is_some() || self.active.is_some()
    }

    /// Bytes that one evaluation of the internal force reads.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.places[..])
            + size_of_val(&self.frames[..])
            + with_gradients!(&self.grad_phi, grad_phi => size_of_val(&grad_phi[..]))
    }
}

/// Points whose forces are computed together: a patch, or a few points where nothing is
/// projected.
#[derive(Debug, Clone)]
pub struct Chunk {
    /// Lanes with points.
    pub lanes: Range<usize>,
    /// Their SIMD blocks, counted through the block.
    pub groups: Range<usize>,
}

impl Chunk {
    /// The chunk of some points that begins with a SIMD block.
    pub fn new(first_group: usize, points: usize) -> Chunk {
        let first = first_group * LANES;
        Chunk {
            lanes: first..first + points,
            groups: first_group..first_group + points.div_ceil(LANES),
        }
    }
}
