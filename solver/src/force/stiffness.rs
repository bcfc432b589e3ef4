//! The tangent operator K = ∂f_int/∂u chunk by chunk, for those who need its entries.
#![allow(non_snake_case)]

use super::forces::Workspace;
use crate::algebra::lanes::{with_slopes, with_vectors};
use crate::force::kernel::{ChunkTangent, OwnPressures, chunk_tangent};
use crate::force::layout::{Block, Chunk, PackedPoints};

/// Visits the tangents of all chunks at the displacements of the last
/// [`linearise`](super::linearise), with the patches' own pressures as they are.
///
/// # Panics
/// If there has been none.
pub fn for_each_chunk(
    points: &PackedPoints,
    own: Option<&OwnPressures>,
    workspace: &mut Workspace,
    mut visit: impl FnMut(&Block, &Chunk, &ChunkTangent),
) {
    let mut found = ChunkTangent::default();
    for (number, (block, scratch)) in points.blocks.iter().zip(&mut workspace.blocks).enumerate() {
        let own = own.map(|own| own.block(number));
        for (index, chunk) in block.chunks.iter().enumerate() {
            let place = (index, points.components);
            // Chooses the instructions of this processor, and how many points at a time the law takes.
            with_vectors!(workspace.level, (simd, numbers) => {
                chunk_tangent(simd, with_slopes(numbers), (block, own), place, scratch, &mut found)
            });
            visit(block, chunk, &found);
        }
    }
}
