//! How quadrature points are divided into blocks.

use super::block::{Block, Chunk};
use super::local_vectors::most_nodes;
use super::numbering::Numbering;
use super::packing::{Packed, pack};
use crate::algebra::lanes::{LANES, SimdBlock};
use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::Discretisation;
use crate::discretisation::patches::orthonormal_basis;
use crate::discretisation::rows::Rows;
use crate::error::Error;
use crate::force::projection::{BasisBlock, Projection};
use crate::problem::{Problem, Region, VolumetricProjection};
use std::ops::Range;

/// Points of a chunk where nothing is projected: their gradients stay in the first
/// cache.
const CHUNK: usize = 16;

/// Smallest and largest number of points that the division into blocks aims at.
const BLOCK_POINTS: (usize, usize) = (1024, 8192);

/// All quadrature points in blocks, which end where a patch does.
///
/// # Errors
/// [`Error::LargeSupports`] if the points of one patch see more nodes than a block can have.
pub fn blocks(problem: &Problem, discretisation: &Discretisation) -> Result<Vec<Block>, Error> {
    let regions = &discretisation.quadrature.regions;
    let points = (regions.len() / 16).clamp(BLOCK_POINTS.0, BLOCK_POINTS.1);
    let most = most_nodes(discretisation.dimension.components());
    let patches = &discretisation.patches;
    let mut numbering = Numbering::new(discretisation.cloud.positions.len());
    let mut blocks = Vec::new();
    let mut first = 0;
    while first + 1 < patches.len() {
        let start = patches[first];
        let mut last = first;
        while last + 1 < patches.len()
            && regions[patches[last + 1] - 1] == regions[start]
            && (last == first || patches[last + 1] - start <= points)
            && numbering.add(&discretisation.supports, patches[last]..patches[last + 1], most)
        {
            last += 1;
        }
        if last == first {
            let position = discretisation.quadrature.positions[start];
            return Err(Error::LargeSupports { point: start, position, most });
        }
        blocks.push(block(problem, first..last, discretisation, &numbering)?);
        numbering.clear();
        first = last;
    }
    Ok(blocks)
}

fn block(
    problem: &Problem,
    patches: Range<usize>,
    discretisation: &Discretisation,
    numbering: &Numbering,
) -> Result<Block, Error> {
    let starts = &discretisation.patches[patches.start..=patches.end];
    let points = starts[0]..starts[starts.len() - 1];
    let region = discretisation.quadrature.regions[points.start] as usize;
    let region = &problem.regions[region];
    let law = region.material.law;
    let fraction = match problem.recipe.volumetric_projection {
        VolumetricProjection::Patches => law.projected_fraction(),
        VolumetricProjection::None => 0.0,
    };
    let projected = fraction > 0.0;
    let order = by_size(starts, &discretisation.supports, projected);
    let sizes: Vec<usize> = if projected {
        starts.windows(2).map(|patch| patch[1] - patch[0]).collect()
    } else {
        order.chunks(CHUNK).map(<[usize]>::len).collect()
    };
    let mut chunks: Vec<Chunk> = Vec::with_capacity(sizes.len());
    for size in sizes {
        chunks.push(Chunk::new(chunks.last().map_or(0, |chunk| chunk.groups.end), size));
    }
    let mut lanes = vec![None; LANES * chunks.last().map_or(0, |chunk| chunk.groups.end)];
    let taken = chunks.iter().flat_map(|chunk| chunk.lanes.clone());
    taken.zip(&order).for_each(|(lane, &point)| lanes[lane] = Some(point));
    let components = discretisation.dimension.components();
    let entries = discretisation.supports.nodes.len();
    let single = problem.recipe.gradient_storage.is_single(entries);
    let weights = &discretisation.quadrature.weights;
    let Packed { starts: slots, places, grad_phi } =
        pack(&discretisation.supports, &lanes, numbering, components, single);
    Ok(Block {
        law,
        frames: frames(region, &lanes, &discretisation.quadrature.positions)?,
        viscosity: region.viscosity,
        active: region.active.clone(),
        nodes: numbering.nodes().to_vec(),
        lanes: lanes.iter().map(|q| q.map_or(0, |q| (q - points.start) as u32)).collect(),
        starts: slots,
        places,
        grad_phi,
        quadrature_weights: lanes.iter().map(|q| q.map_or(0.0, |q| weights[q])).collect(),
        chunks,
        projection: projected.then(|| projection(fraction, starts, &order, discretisation)),
        points,
    })
}

/// The fibre frames of the points in some lanes; padding has any.
fn frames(
    region: &Region,
    lanes: &[Option<usize>],
    positions: &[Vector3],
) -> Result<Vec<[SimdBlock; 9]>, Error> {
    if region.fibres.is_none() {
        return Ok(Vec::new());
    }
    let mut frames = vec![[SimdBlock::default(); 9]; lanes.len() / LANES];
    for (lane, point) in lanes.iter().enumerate() {
        let frame = point.map(|q| region.frame(&positions[q])).transpose()?.flatten();
        let rows = frame.unwrap_or_else(Matrix3::identity).transpose();
        for (entry, value) in frames[lane / LANES].iter_mut().zip(rows.iter()) {
            entry.0[lane % LANES] = *value;
        }
    }
    Ok(frames)
}

/// The points of some patches, those of each by the size of their supports: the largest first,
/// or the smallest first in every other patch where `apart` is false and four points can be of
/// two patches.
fn by_size(starts: &[usize], supports: &Rows, apart: bool) -> Vec<usize> {
    let mut order: Vec<usize> = (starts[0]..starts[starts.len() - 1]).collect();
    for (count, patch) in starts.windows(2).enumerate() {
        let points = &mut order[patch[0] - starts[0]..patch[1] - starts[0]];
        points.sort_by_key(|&q| std::cmp::Reverse(supports.row(q).len()));
        if !apart && count % 2 == 1 {
            points.reverse();
        }
    }
    order
}

fn projection(
    fraction: f64,
    starts: &[usize],
    order: &[usize],
    discretisation: &Discretisation,
) -> Projection {
    let quadrature = &discretisation.quadrature;
    let components = discretisation.dimension.components();
    let blocks_of = |patch: &[usize]| {
        let points = patch[0]..patch[1];
        let (positions, weights) = (&quadrature.positions, &quadrature.weights);
        let basis = orthonormal_basis(positions, weights, points, components);
        let order = &order[patch[0] - starts[0]..patch[1] - starts[0]];
        let weights: Vec<f64> = order.iter().map(|&q| weights[q]).collect();
        let basis: Vec<[f64; 4]> = order.iter().map(|&q| basis[q - patch[0]]).collect();
        BasisBlock::of_patch(&weights, &basis)
    };
    Projection { fraction, blocks: starts.windows(2).flat_map(blocks_of).collect() }
}
