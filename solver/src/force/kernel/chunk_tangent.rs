//! ∂P/∂F at the points of a chunk, and how the pressure of its patch follows from J.
#![allow(non_snake_case)]

use super::own_pressures::BlockPressures;
use super::points::{jacobians, pressures, stresses};
use super::scratch::Scratch;
use crate::algebra::block_matrix::PointTangent;
use crate::algebra::lanes::{LANES, Lanes, SimdBlock};
use crate::algebra::tensor::Matrix3;
use crate::force::layout::{Block, Chunk};
use crate::force::projection::OwnPressure;
use crate::material::with_law;
use fearless_simd::Simd;
use std::marker::PhantomData;

/// The tangent operator at the points of a chunk.
#[derive(Debug, Default)]
pub struct ChunkTangent {
    /// At a fixed pressure of the patch \[point\] \[Pa\].
    pub points: Vec<PointTangent>,
    /// F \[point\] \[–\].
    pub deformation: Vec<Matrix3>,
    /// Slopes of the pressure's moments along those of J, as they act \[Pa\]; 0 without a patch.
    pub patch: [[f64; 4]; 4],
}

/// The tangent of the block's chunk of that index where the block was linearised. In a plane only
/// what `components` are left is computed. Patches may have pressures of their own.
#[inline(always)]
pub fn chunk_tangent<S: Simd, R: Lanes<S>>(
    simd: S,
    _: PhantomData<R>,
    (block, own): (&Block, Option<&BlockPressures>),
    (index, components): (usize, usize),
    scratch: &mut Scratch,
    tangent: &mut ChunkTangent,
) {
    let Chunk { lanes, groups } = &block.chunks[index];
    let (count, points) = (groups.len(), lanes.len());
    let frames = block.frames.get(groups.clone()).unwrap_or(&[]);
    let Scratch { extra, linearised, deformation, stress, jacobians: jacobian, .. } = scratch;
    let pressure = &mut scratch.pressures;
    let known = &linearised[9 * groups.start..9 * groups.end];
    deformation.values[..known.len()].copy_from_slice(known);
    deformation.slopes[..known.len()].fill(SimdBlock::default());
    tangent.points.clear();
    tangent.points.resize(points, [[0.0; 9]; 9]);
    tangent.deformation.clear();
    tangent.deformation.extend((0..points).map(|point| deformation_at(known, point)));
    tangent.patch = [[0.0; 4]; 4];
    let fixed = block.projection.as_ref().map(|projection| {
        let own = own.map(|own| own.of(index));
        let part = own.map_or(1.0, |own| own.part);
        let of_points: Vec<f64> = tangent.deformation.iter().map(Matrix3::determinant).collect();
        tangent.patch = projection.slopes(&block.law, groups.clone(), &of_points, part);
        // Chooses the law of the block.
        with_law!(&block.law, law => {
            jacobians::<S, R>(simd, count, deformation, jacobian);
            let of_patch = (projection, own);
            let found = pressures::<S, R, _>(simd, law, of_patch, groups.clone(), jacobian, pressure);
            let moments = own.map_or(found.pressure, |own| own.approached(found.pressure));
            (projection, OwnPressure { moments, slopes: [0.0; 4], part: 0.0 })
        })
    });
    let columns = (0..9).filter(|column| column / 3 < components && column % 3 < components);
    for column in columns {
        set_slope(&mut deformation.slopes, (count, column), 1.0);
        // Chooses the law of the block.
        with_law!(&block.law, law => {
            if let Some((projection, own)) = fixed {
                jacobians::<S, R>(simd, count, deformation, jacobian);
                let of_patch = (projection, Some(own));
                pressures::<S, R, _>(simd, law, of_patch, groups.clone(), jacobian, pressure);
            }
            let pressure = fixed.map(|_| &*pressure);
            let results = (&mut *stress, &mut *jacobian, false);
            stresses::<S, R, _, 3>(simd, (law, frames), count, deformation, pressure, results);
        });
        if let Some(extra) = extra {
            extra.add::<S, R>(simd, groups.clone(), deformation, stress);
        }
        for (point, tangent) in tangent.points.iter_mut().enumerate() {
            let rows = &stress.slopes[9 * (point / LANES)..];
            (0..9).for_each(|entry| tangent[column][entry] = rows[entry].0[point % LANES]);
        }
        set_slope(&mut deformation.slopes, (count, column), 0.0);
    }
}

/// dF of all points of some SIMD blocks in one entry.
fn set_slope(slopes: &mut [SimdBlock], (count, entry): (usize, usize), value: f64) {
    for rows in slopes.chunks_exact_mut(9).take(count) {
        rows[entry] = SimdBlock([value; LANES]);
    }
}

/// F of a point from the rows of SIMD blocks.
fn deformation_at(rows: &[SimdBlock], point: usize) -> Matrix3 {
    let rows = &rows[9 * (point / LANES)..];
    Matrix3::from_fn(|i, j| rows[3 * i + j].0[point % LANES])
}
