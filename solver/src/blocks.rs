//! Quadrature points in blocks that the internal force runs over.

use crate::discretisation::Discretisation;
use crate::material::Law;
use crate::patches::orthonormal_basis;
use crate::problem::{Dilatation, Problem};
use crate::projection::{Projection, Weighted};
use crate::rows::Rows;
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
    /// Support of local point p is `starts[p]..starts[p + 1]`, filled up to whole
    /// fours with its last node and gradients of 0.
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

    /// The entries that stand `ahead` entries after the support of a point.
    #[inline(always)]
    pub fn coming<const D: usize>(&self, point: usize, ahead: usize) -> (&[u32], &[[f64; D]]) {
        let first = (self.starts[point] as usize + ahead).min(self.supports.len());
        (&self.supports[first..], &self.grad_phi.as_chunks::<D>().0[first..])
    }

    pub fn chunks(&self) -> impl Iterator<Item = Chunk> {
        let mut eights = 0..0;
        self.chunks.windows(2).map(move |ends| {
            let points = ends[0] as usize..ends[1] as usize;
            eights = eights.end..eights.end + points.len().div_ceil(8);
            Chunk { points, eights: eights.clone() }
        })
    }
}

/// Points that are worked on together.
#[derive(Debug, Clone)]
pub struct Chunk {
    /// Local points.
    pub points: Range<usize>,
    /// Where they are where eight points make an entry.
    pub eights: Range<usize>,
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
    let Packed { nodes, starts: entries, supports, grad_phi } =
        pack(rows, points.clone(), components, discretisation.cloud.positions.len());
    let region = discretisation.quadrature.regions[points.start] as usize;
    let law = problem.regions[region].material.law;
    let share = match problem.recipe.dilatation {
        Dilatation::Projected => law.projected_share(),
        Dilatation::Pointwise => 0.0,
    };
    Block {
        law,
        starts: entries,
        supports,
        grad_phi,
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

/// Supports of a block as [`Block`] holds them.
#[derive(Default)]
struct Packed {
    nodes: Vec<u32>,
    starts: Vec<u32>,
    supports: Vec<u32>,
    grad_phi: Vec<f64>,
}

/// Numbers the nodes in the order in which they appear, which is that of the
/// points in space, and fills each support up to whole fours.
fn pack(rows: &Rows, points: Range<usize>, components: usize, nodes: usize) -> Packed {
    const NONE: u32 = u32::MAX;
    let mut numbers = vec![NONE; nodes];
    let mut packed = Packed { starts: vec![0], ..Packed::default() };
    let room = (rows.starts[points.end] - rows.starts[points.start]) + 3 * points.len();
    packed.supports.reserve_exact(room);
    packed.grad_phi.reserve_exact(room * components);
    for point in points {
        for entry in rows.row(point) {
            let number = &mut numbers[rows.nodes[entry] as usize];
            if *number == NONE {
                *number = packed.nodes.len() as u32;
                packed.nodes.push(rows.nodes[entry]);
            }
            packed.supports.push(*number);
            packed.grad_phi.extend(rows.grad_phi[entry].iter().take(components));
        }
        let filled = packed.supports.len().next_multiple_of(4);
        packed.supports.resize(filled, packed.supports.last().copied().unwrap_or(0));
        packed.grad_phi.resize(filled * components, 0.0);
        packed.starts.push(filled as u32);
    }
    packed.supports.shrink_to_fit();
    packed.grad_phi.shrink_to_fit();
    packed
}

fn projection(share: f64, starts: &[usize], discretisation: &Discretisation) -> Projection {
    let quadrature = &discretisation.quadrature;
    let components = discretisation.dimension.components();
    let eights = |patch: &[usize]| {
        let points = patch[0]..patch[1];
        let (positions, weights) = (&quadrature.positions, &quadrature.weights);
        let basis = orthonormal_basis(positions, weights, points.clone(), components);
        Weighted::eights(&weights[points], &basis)
    };
    Projection { share, eights: starts.windows(2).flat_map(eights).collect() }
}

/// How the forces of the blocks are summed: by stretches of nodes that any
/// thread may take, each node in the order of the blocks.
#[derive(Debug, Clone)]
pub struct Sums {
    /// Nodes of a stretch.
    pub stretch: usize,
    /// What the blocks that touch a stretch give to it, in order \[stretch\].
    pub terms: Vec<Vec<Term>>,
}

/// What one block gives to a stretch.
#[derive(Debug, Clone)]
pub struct Term {
    pub block: usize,
    /// Nodes with their local numbers.
    pub nodes: Vec<(u32, u32)>,
}

impl Sums {
    pub fn new(blocks: &[Block], nodes: usize) -> Sums {
        let stretch = nodes.div_ceil(16).max(1);
        let mut terms = vec![Vec::new(); nodes.div_ceil(stretch)];
        for (index, block) in blocks.iter().enumerate() {
            let mut numbers: Vec<(u32, u32)> = block.nodes.iter().copied().zip(0..).collect();
            numbers.sort_unstable();
            let place = |node: u32| node as usize / stretch;
            for nodes in numbers.chunk_by(|a, b| place(a.0) == place(b.0)) {
                terms[place(nodes[0].0)].push(Term { block: index, nodes: nodes.to_vec() });
            }
        }
        Sums { stretch, terms }
    }
}
