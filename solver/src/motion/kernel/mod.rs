//! The hot loop over the quadrature points of one block, eight points or one node at a
//! time: chunk by chunk the gradients of the displacement, J, the projected pressure,
//! the stress and the nodal forces (method book, section 11).
#![allow(non_snake_case)]

mod nodes;
mod points;

use crate::algebra::lanes::{LANES, Lanes, PaddedVector, Parts, SimdBlock};
use crate::material::with_law;
use crate::model::blocks::with_gradients;
use crate::model::{Block, Chunk};
use fearless_simd::Simd;
use nodes::{add_forces, displacement_gradients};
use points::{jacobians, pressures, read_columns, stresses, write_columns};
use std::ops::Range;

/// Scratch memory of one block; nothing in it outlives a step.
#[derive(Debug, Clone)]
pub struct Scratch {
    /// Displacements of the block's nodes \[m\].
    pub u: Vec<PaddedVector>,
    /// Displacements of the direction of a derivative \[m\]; empty without one.
    pub v: Vec<PaddedVector>,
    /// Forces on the block's nodes, or their derivative \[N\].
    pub f: Vec<PaddedVector>,
    /// The smallest J and its local point.
    pub smallest: (f64, usize),
    /// Columns of ∂u/∂X \[–\], later of P \[Pa\], of each point of a chunk.
    columns: Parts<PaddedVector>,
    /// F \[–\], row by row, of each eight points of a chunk.
    deformation: Parts<SimdBlock>,
    /// P \[Pa\] in the same order.
    stress: Parts<SimdBlock>,
    jacobians: Parts<SimdBlock>,
    pressures: Parts<SimdBlock>,
}

impl Scratch {
    pub fn new(block: &Block, components: usize) -> Scratch {
        let groups = block.chunks().map(|chunk| chunk.groups.len()).max().unwrap_or(0);
        let mut deformation: Parts<SimdBlock> = Parts::new(9 * groups);
        // What a plane leaves as it is: F₃₃ = 1.
        for rows in deformation.values.chunks_exact_mut(9) {
            (0..3).for_each(|i| rows[4 * i] = SimdBlock([1.0; LANES]));
        }
        Scratch {
            u: vec![PaddedVector::default(); block.nodes.len()],
            v: Vec::new(),
            f: vec![PaddedVector::default(); block.nodes.len()],
            smallest: (f64::INFINITY, 0),
            columns: Parts::new(LANES * groups * components),
            deformation,
            stress: Parts::new(9 * groups),
            jacobians: Parts::new(groups),
            pressures: Parts::new(groups),
        }
    }
}

/// f_a = Σ_q w_q P(F_q) Grad φ_a(X_q) of the block's points at `scratch.u`; with
/// dual numbers its derivative along `scratch.v`.
#[inline(always)]
pub fn block_force<S: Simd, R: Lanes<S>, const D: usize>(
    simd: S,
    block: &Block,
    scratch: &mut Scratch,
) {
    scratch.f.fill(PaddedVector::default());
    scratch.smallest = (f64::INFINITY, 0);
    let Scratch { u, v, f, smallest, columns, deformation, stress, .. } = scratch;
    let (jacobian, pressure) = (&mut scratch.jacobians, &mut scratch.pressures);
    for Chunk { points, groups } in block.chunks() {
        let count = groups.len();
        with_gradients!(&block.grad_phi, grad_phi => {
            let stream = (block, &grad_phi[..]);
            displacement_gradients::<S, _, D>(simd, stream, &points, u, &mut columns.values);
            if R::SLOPES {
                displacement_gradients::<S, _, D>(simd, stream, &points, v, &mut columns.slopes);
            }
        });
        read_columns::<S, D>(simd, &columns.values, count, 1.0, &mut deformation.values);
        if R::SLOPES {
            read_columns::<S, D>(simd, &columns.slopes, count, 0.0, &mut deformation.slopes);
        }
        let projection = block.projection.as_ref();
        with_law!(&block.law, law => {
            if let Some(projection) = projection {
                jacobians::<S, R>(simd, count, deformation, jacobian);
                pressures::<S, R, _>(simd, law, projection, groups, jacobian, pressure);
            }
            let pressure = projection.map(|_| &*pressure);
            let results = (&mut *stress, &mut *jacobian);
            // In a plane half of a law is not needed; a derivative is, rarely enough.
            match D == 2 && !R::SLOPES {
                true => stresses::<S, R, _, 2>(simd, law, count, deformation, pressure, results),
                false => stresses::<S, R, _, 3>(simd, law, count, deformation, pressure, results),
            }
        });
        keep_smallest(&points, &jacobian.values, smallest);
        let (stress, columns) = match R::SLOPES {
            true => (&stress.slopes, &mut columns.slopes),
            false => (&stress.values, &mut columns.values),
        };
        write_columns::<D>(stress, count, columns);
        with_gradients!(&block.grad_phi, grad_phi => {
            add_forces::<S, _, D>(simd, (block, &grad_phi[..]), &points, columns, f);
        });
    }
}

#[inline(always)]
fn keep_smallest(chunk: &Range<usize>, jacobians: &[SimdBlock], smallest: &mut (f64, usize)) {
    let jacobians = jacobians.iter().flat_map(|block| block.0);
    for (point, jacobian) in chunk.clone().zip(jacobians) {
        if jacobian < smallest.0 {
            *smallest = (jacobian, point);
        }
    }
}
