//! The tangent operator K = ∂f_int/∂u chunk by chunk, for those who need its entries.
#![allow(non_snake_case)]

use super::forces::{OwnPressures, Workspace};
use crate::algebra::lanes::{Number, with_vectors};
use crate::algebra::real::Dual;
use crate::model::{Block, Chunk, Model};
use crate::motion::kernel::{BlockPressures, ChunkTangent, Scratch, chunk_tangent};
use fearless_simd::Simd;
use std::marker::PhantomData;

/// Visits the tangents of all chunks at the displacements of the last
/// [`linearise`](super::linearise), with the patches' own pressures as they are.
///
/// # Panics
/// If there has been none.
pub fn for_each_chunk(
    model: &Model,
    own: Option<&OwnPressures>,
    workspace: &mut Workspace,
    mut visit: impl FnMut(&Block, &Chunk, &ChunkTangent),
) {
    let mut found = ChunkTangent::default();
    for (number, (block, scratch)) in model.blocks.iter().zip(&mut workspace.blocks).enumerate() {
        let pressures = own.map(|own| own.block(number));
        for (index, chunk) in block.chunks.iter().enumerate() {
            let place = (index, model.components);
            with_vectors!(workspace.level, (simd, numbers) => {
                tangent_of(simd, numbers, (block, pressures), place, (scratch, &mut found))
            });
            visit(block, chunk, &found);
        }
    }
}

#[inline(always)]
fn tangent_of<S: Simd, N: Number<S>>(
    simd: S,
    _: PhantomData<N>,
    block: (&Block, Option<&BlockPressures>),
    place: (usize, usize),
    (scratch, found): (&mut Scratch, &mut ChunkTangent),
) {
    chunk_tangent::<S, Dual<N>>(simd, block, place, scratch, found);
}
