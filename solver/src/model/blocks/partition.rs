//! How quadrature points are divided into blocks and packed.

use super::block::Block;
use super::stored_gradients::StoredGradients;
use crate::discretisation::Discretisation;
use crate::discretisation::patches::orthonormal_basis;
use crate::discretisation::rows::Rows;
use crate::model::projection::{BasisBlock, Projection};
use crate::problem::{GradientStorage, Problem, VolumetricProjection};
use std::ops::Range;

/// Points of a chunk where nothing is projected: their gradients stay in the first
/// cache.
const CHUNK: usize = 16;

/// Smallest and largest number of points that the division into blocks aims at.
const BLOCK_POINTS: (usize, usize) = (1024, 8192);

/// All quadrature points in blocks, which end where a patch does.
pub fn blocks(problem: &Problem, discretisation: &Discretisation) -> Vec<Block> {
    let regions = &discretisation.quadrature.regions;
    let most = (regions.len() / 16).clamp(BLOCK_POINTS.0, BLOCK_POINTS.1);
    let patches = &discretisation.patches;
    let mut blocks = Vec::new();
    let mut first = 0;
    while first + 1 < patches.len() {
        let start = patches[first];
        let last = (first + 1..patches.len())
            .take_while(|&p| regions[patches[p] - 1] == regions[start])
            .take_while(|&p| p == first + 1 || patches[p] - start <= most)
            .last()
            .unwrap_or(first + 1);
        blocks.push(block(problem, first..last, discretisation));
        first = last;
    }
    blocks
}

fn block(problem: &Problem, patches: Range<usize>, discretisation: &Discretisation) -> Block {
    let rows = &discretisation.supports;
    let starts = &discretisation.patches[patches.start..=patches.end];
    let points = starts[0]..starts[starts.len() - 1];
    let components = discretisation.dimension.components();
    let storage = problem.recipe.gradient_storage;
    let Packed { nodes, starts: entries, supports, grad_phi } =
        pack(rows, points.clone(), components, storage, discretisation.cloud.positions.len());
    let region = discretisation.quadrature.regions[points.start] as usize;
    let law = problem.regions[region].material.law;
    let fraction = match problem.recipe.volumetric_projection {
        VolumetricProjection::Patches => law.projected_fraction(),
        VolumetricProjection::None => 0.0,
    };
    Block {
        law,
        starts: entries,
        supports,
        grad_phi,
        quadrature_weights: discretisation.quadrature.weights[points.clone()].to_vec(),
        chunks: match fraction > 0.0 {
            true => starts.iter().map(|start| (start - points.start) as u32).collect(),
            false => {
                let count = points.len();
                (0..=count.div_ceil(CHUNK)).map(|c| (c * CHUNK).min(count) as u32).collect()
            }
        },
        projection: (fraction > 0.0).then(|| projection(fraction, starts, discretisation)),
        nodes,
        points,
    }
}

/// The supports of a [`Block`].
struct Packed {
    nodes: Vec<u32>,
    starts: Vec<u32>,
    supports: Vec<u32>,
    grad_phi: StoredGradients,
}

/// Numbers the nodes in the order in which they appear, which is that of the
/// points in space, and pads each support to a multiple of four.
fn pack(
    rows: &Rows,
    points: Range<usize>,
    components: usize,
    storage: GradientStorage,
    nodes: usize,
) -> Packed {
    const NONE: u32 = u32::MAX;
    let mut numbers = vec![NONE; nodes];
    let (mut nodes, mut starts, mut supports) = (Vec::new(), vec![0], Vec::new());
    let padded = |point: usize| rows.row(point).len().next_multiple_of(4);
    supports.reserve_exact(points.clone().map(padded).sum());
    for point in points.clone() {
        for entry in rows.row(point) {
            let number = &mut numbers[rows.nodes[entry] as usize];
            if *number == NONE {
                *number = nodes.len() as u32;
                nodes.push(rows.nodes[entry]);
            }
            supports.push(*number);
        }
        let padded = supports.len().next_multiple_of(4);
        supports.resize(padded, supports.last().copied().unwrap_or(0));
        starts.push(padded as u32);
    }
    let size = supports.len() * components;
    let grad_phi = match storage {
        GradientStorage::Double => {
            StoredGradients::Double(padded_gradients(rows, points, components, size, |g| g))
        }
        GradientStorage::Single => {
            StoredGradients::Single(padded_gradients(rows, points, components, size, |g| g as f32))
        }
    };
    Packed { nodes, starts, supports, grad_phi }
}

/// The gradients at some points, `size` numbers in all: those of each point padded
/// to a multiple of four entries.
fn padded_gradients<G: Copy + Default>(
    rows: &Rows,
    points: Range<usize>,
    components: usize,
    size: usize,
    stored: impl Fn(f64) -> G,
) -> Vec<G> {
    let mut gradients = Vec::with_capacity(size);
    for point in points {
        for gradient in &rows.grad_phi[rows.row(point)] {
            gradients.extend(gradient.iter().take(components).map(|g| stored(*g)));
        }
        gradients.resize(gradients.len().next_multiple_of(4 * components), G::default());
    }
    gradients
}

fn projection(fraction: f64, starts: &[usize], discretisation: &Discretisation) -> Projection {
    let quadrature = &discretisation.quadrature;
    let components = discretisation.dimension.components();
    let blocks_of = |patch: &[usize]| {
        let points = patch[0]..patch[1];
        let (positions, weights) = (&quadrature.positions, &quadrature.weights);
        let basis = orthonormal_basis(positions, weights, points.clone(), components);
        BasisBlock::of_patch(&weights[points], &basis)
    };
    Projection { fraction, blocks: starts.windows(2).flat_map(blocks_of).collect() }
}
