//! Quadrature points in blocks that the internal force runs over.

use crate::discretisation::Discretisation;
use crate::lanes::Four;
use crate::material::Law;
use crate::patches::orthonormal_basis;
use crate::problem::{Dilatation, Problem};
use crate::projection::Projection;
use std::ops::Range;

/// Consecutive quadrature points of one material, with their own numbering of
/// the nodes they touch. Blocks depend on the problem alone, never on the
/// number of threads.
#[derive(Debug, Clone)]
pub struct Block {
    pub law: Law,
    pub points: Range<usize>,
    /// Global node of each local one.
    pub nodes: Vec<u32>,
    /// Support of local point p is `starts[p]..starts[p + 1]`.
    pub starts: Vec<u32>,
    /// Local node indices \[support entry\].
    pub supports: Vec<u32>,
    /// Grad φ, `components` per entry \[1/m\].
    pub grad_phi: Vec<f64>,
    /// \[point\] \[m³\]
    pub quadrature_weights: Vec<f64>,
    /// Points that are worked on together are `chunks[c]..chunks[c + 1]`: a
    /// patch, or a few where nothing is projected.
    pub chunks: Vec<u32>,
    /// Only where the material is nearly incompressible.
    pub projection: Option<Projection>,
}

impl Block {
    /// Local nodes and gradients of a local point, D components each.
    #[inline(always)]
    pub fn support<const D: usize>(&self, point: usize) -> (&[u32], &[[f64; D]]) {
        let entries = self.starts[point] as usize..self.starts[point + 1] as usize;
        (&self.supports[entries.clone()], &self.grad_phi.as_chunks::<D>().0[entries])
    }

    /// Local points of each chunk.
    pub fn chunks(&self) -> impl Iterator<Item = Range<usize>> {
        self.chunks.windows(2).map(|ends| ends[0] as usize..ends[1] as usize)
    }
}

/// Points worked on together where nothing is projected: their gradients stay
/// in the first cache.
const CHUNK: usize = 16;

/// A block holds at least and at most this many points.
const BLOCK_POINTS: (usize, usize) = (1024, 8192);

/// Blocks end where a patch does.
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
    let entries = rows.starts[points.start]..rows.starts[points.end];
    let (nodes, supports) =
        number_by_appearance(&rows.nodes[entries.clone()], discretisation.cloud.positions.len());
    let offset = entries.start;
    let region = discretisation.quadrature.regions[points.start] as usize;
    let law = problem.regions[region].material.law;
    let share = match problem.recipe.dilatation {
        Dilatation::Projected => law.projected_share(),
        Dilatation::Pointwise => 0.0,
    };
    Block {
        law,
        starts: rows.starts[points.start..=points.end]
            .iter()
            .map(|s| (s - offset) as u32)
            .collect(),
        supports,
        grad_phi: rows.grad_phi[entries]
            .iter()
            .flat_map(|gradient| gradient.iter().take(components).copied())
            .collect(),
        quadrature_weights: discretisation.quadrature.weights[points.clone()].to_vec(),
        chunks: match share > 0.0 {
            true => starts.iter().map(|start| (start - points.start) as u32).collect(),
            false => {
                let count = points.len();
                (0..=count.div_ceil(CHUNK)).map(|c| (c * CHUNK).min(count) as u32).collect()
            }
        },
        projection: (share > 0.0).then(|| projection(share, starts, discretisation)),
        nodes,
        points,
    }
}

/// The nodes in the order in which they appear, which is that of the points in
/// space, and the local number of each entry.
fn number_by_appearance(entries: &[u32], nodes: usize) -> (Vec<u32>, Vec<u32>) {
    const NONE: u32 = u32::MAX;
    let mut numbers = vec![NONE; nodes];
    let mut seen = Vec::new();
    let mut local = Vec::with_capacity(entries.len());
    for &node in entries {
        let number = &mut numbers[node as usize];
        if *number == NONE {
            *number = seen.len() as u32;
            seen.push(node);
        }
        local.push(*number);
    }
    (seen, local)
}

fn projection(share: f64, starts: &[usize], discretisation: &Discretisation) -> Projection {
    let quadrature = &discretisation.quadrature;
    let components = discretisation.dimension.components();
    let basis = |patch: &[usize]| {
        let points = patch[0]..patch[1];
        orthonormal_basis(&quadrature.positions, &quadrature.weights, points, components)
    };
    Projection { share, basis: starts.windows(2).flat_map(basis).map(Four).collect() }
}

/// How the forces of the blocks are summed: by stretches of nodes that any
/// thread may take, each node in the order of the blocks.
#[derive(Debug, Clone)]
pub struct Sums {
    /// Nodes of a stretch.
    pub stretch: usize,
    /// The blocks that touch a stretch, in order, with their nodes in it and the
    /// local numbers of these \[stretch\].
    pub terms: Vec<Vec<(usize, Vec<(u32, u32)>)>>,
}

impl Sums {
    pub fn new(blocks: &[Block], nodes: usize) -> Sums {
        let stretch = nodes.div_ceil(16).max(1);
        let mut terms = vec![Vec::new(); nodes.div_ceil(stretch)];
        for (index, block) in blocks.iter().enumerate() {
            let mut numbers: Vec<(u32, u32)> =
                block.nodes.iter().zip(0..).map(|(&node, local)| (node, local)).collect();
            numbers.sort_unstable();
            for entries in numbers.chunk_by(|a, b| a.0 as usize / stretch == b.0 as usize / stretch)
            {
                terms[entries[0].0 as usize / stretch].push((index, entries.to_vec()));
            }
        }
        Sums { stretch, terms }
    }
}
