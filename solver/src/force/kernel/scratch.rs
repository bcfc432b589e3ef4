//! What a block works with.

use super::extra::ExtraStress;
use super::tangents::Tangents;
use crate::algebra::lanes::{LANES, Parts, SimdBlock};
use crate::force::layout::Block;
use crate::force::layout::LocalVectors;
use crate::force::projection::PatchMoments;

/// Vectors at the nodes of the block that a thread works on.
#[derive(Debug)]
pub struct Local {
    /// Displacements \[m\].
    pub u: LocalVectors,
    /// Forces, or their derivative \[N\].
    pub f: LocalVectors,
}

impl Local {
    /// All are 0.
    pub fn zeros() -> Local {
        Local { u: LocalVectors::zeros(), f: LocalVectors::zeros() }
    }
}

/// Scratch memory of one block; but for what `keep_gradients` keeps, nothing in it outlives a step.
#[derive(Debug)]
pub struct Scratch {
    /// Forces on the block's nodes, where they are added later \[component of node\] \[N\].
    pub forces: Vec<f64>,
    /// The smallest J and its lane.
    pub smallest: (f64, usize),
    /// What the last displacements made of the patches; volumes are slopes after a derivative.
    pub patches: Vec<PatchMoments>,
    /// Where there are stresses beside those of the law.
    pub extra: Option<ExtraStress>,
    /// F \[–\] of all points at the displacements of a derivative, once there has been one.
    pub(super) linearised: Vec<SimdBlock>,
    /// What derivatives there have of a costly law.
    pub(super) tangents: Tangents,
    /// F \[–\], row by row, of each eight points of a chunk.
    pub(super) deformation: Parts<SimdBlock>,
    /// P \[Pa\] in the same order.
    pub(super) stress: Parts<SimdBlock>,
    pub(super) jacobians: Parts<SimdBlock>,
    pub(super) pressures: Parts<SimdBlock>,
}

impl Scratch {
    pub fn new(block: &Block) -> Scratch {
        let groups = block.chunks.iter().map(|chunk| chunk.groups.len()).max().unwrap_or(0);
        let mut deformation: Parts<SimdBlock> = Parts::new(9 * groups);
        // What a plane leaves as it is: F₃₃ = 1.
        for rows in deformation.values.chunks_exact_mut(9) {
            (0..3).for_each(|i| rows[4 * i] = SimdBlock([1.0; LANES]));
        }
        Scratch {
            forces: Vec::new(),
            smallest: (f64::INFINITY, 0),
            patches: match block.projection {
                Some(_) => vec![PatchMoments::default(); block.chunks.len()],
                None => Vec::new(),
            },
            extra: block.has_extra_stress().then(|| ExtraStress::zero(block.groups())),
            linearised: Vec::new(),
            tangents: Tangents::default(),
            deformation,
            stress: Parts::new(9 * groups),
            jacobians: Parts::new(groups),
            pressures: Parts::new(groups),
        }
    }
}
