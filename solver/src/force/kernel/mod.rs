//! The hot loop over the quadrature points of one block: chunk by chunk the deformation
//! gradients, J, the projected pressure, the stress and the nodal forces, four points side by
//! side where nodes are read and eight in the law (method book, section 11).
#![allow(non_snake_case)]

mod chunk_tangent;
mod extra;
mod nodes;
mod own_pressures;
mod points;
mod scratch;
mod tangents;

use crate::algebra::lanes::{Lanes, Parts, SimdBlock};
use crate::force::layout::{Block, Chunk, LocalVectors};
use crate::material::with_law;
pub use chunk_tangent::{ChunkTangent, chunk_tangent};
pub use extra::{ENTRIES, ExtraStress, Found, Symmetric};
use fearless_simd::Simd;
use nodes::{add_forces, deformation_gradients};
pub use own_pressures::{BlockPressures, OwnPressures};
use points::{jacobians, pressures, stresses};
pub use scratch::{Local, Scratch};
use std::marker::PhantomData;
use std::ops::Range;

/// Keeps F at displacements `u` for the derivatives there, of which each would compute it again.
#[inline(always)]
pub fn keep_gradients<S: Simd, const D: usize>(
    simd: S,
    block: &Block,
    u: &LocalVectors,
    scratch: &mut Scratch,
) {
    let Scratch { linearised, tangents, deformation, .. } = scratch;
    linearised.clear();
    tangents.clear();
    for Chunk { groups, .. } in &block.chunks {
        let rows = &mut deformation.values[..9 * groups.len()];
        deformation_gradients::<S, D>(simd, block, groups.clone(), u, 1.0, rows);
        linearised.extend_from_slice(rows);
    }
}

/// f_a = Σ_q w_q P(F_q) Grad φ_a(X_q) of the block's points at the local displacements; with
/// dual numbers the derivative along them where the block was linearised. Patches may have
/// pressures of their own.
#[inline(always)]
pub fn block_force<S: Simd, R: Lanes<S>, const D: usize>(
    simd: S,
    _: PhantomData<R>,
    (block, own): (&Block, Option<&BlockPressures>),
    Local { u, f }: &mut Local,
    scratch: &mut Scratch,
) {
    f.clear::<D>(block.nodes.len());
    scratch.smallest = (f64::INFINITY, 0);
    let Scratch { smallest, patches, linearised, tangents, extra, .. } = scratch;
    let (deformation, stress) = (&mut scratch.deformation, &mut scratch.stress);
    let (jacobian, pressure) = (&mut scratch.jacobians, &mut scratch.pressures);
    let is_known = R::SLOPES && tangents.are_worth(block);
    for (patch, Chunk { lanes, groups }) in block.chunks.iter().enumerate() {
        let count = groups.len();
        let Parts { values, slopes } = &mut *deformation;
        if R::SLOPES {
            let known = &linearised[9 * groups.start..9 * groups.end];
            values[..known.len()].copy_from_slice(known);
            deformation_gradients::<S, D>(simd, block, groups.clone(), u, 0.0, slopes);
        } else {
            deformation_gradients::<S, D>(simd, block, groups.clone(), u, 1.0, values);
        }
        let projection = block.projection.as_ref();
        let frames = block.frames.get(groups.clone()).unwrap_or(&[]);
        // Chooses the law of the block.
        with_law!(&block.law, law => {
            if is_known {
                let work = (&mut *deformation, &mut *stress, &mut *jacobian);
                tangents.multiply::<S, R, _>(simd, (law, frames), groups.clone(), work);
            }
            if let Some(projection) = projection {
                jacobians::<S, R>(simd, count, deformation, jacobian);
                let projection = (projection, own.map(|own| own.of(patch)));
                patches[patch] =
                    pressures::<S, R, _>(simd, law, projection, groups.clone(), jacobian, pressure);
            }
            let pressure = projection.map(|_| &*pressure);
            let results = (&mut *stress, &mut *jacobian, is_known);
            // In a plane half of a law is not needed; a derivative is, rarely enough.
            if D == 2 && !R::SLOPES && extra.is_none() {
                stresses::<S, R, _, 2>(simd, (law, frames), count, deformation, pressure, results)
            } else {
                stresses::<S, R, _, 3>(simd, (law, frames), count, deformation, pressure, results)
            }
        });
        if let Some(extra) = extra {
            extra.add::<S, R>(simd, groups.clone(), deformation, stress);
        }
        *smallest = smaller(*smallest, lanes.clone(), jacobian);
        let stress = if R::SLOPES { &stress.slopes } else { &stress.values };
        add_forces::<S, D>(simd, block, groups.clone(), stress, f);
    }
}

/// The smallest J so far with its lane, or that of some lanes.
#[inline(always)]
fn smaller(
    mut smallest: (f64, usize),
    lanes: Range<usize>,
    jacobians: &Parts<SimdBlock>,
) -> (f64, usize) {
    for (lane, value) in lanes.zip(jacobians.values.iter().flat_map(|block| block.0)) {
        if value < smallest.0 {
            smallest = (value, lane);
        }
    }
    smallest
}
