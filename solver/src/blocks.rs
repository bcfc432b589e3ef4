//! Quadrature points in blocks that the internal force runs over.

use crate::discretisation::Discretisation;
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

    /// Points of the largest patch; 0 without a projection.
    pub fn largest_patch(&self) -> usize {
        let patches = self.projection.iter().flat_map(|p| p.starts.windows(2));
        patches.map(|ends| (ends[1] - ends[0]) as usize).max().unwrap_or(0)
    }
}

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
    let mut nodes: Vec<u32> = rows.nodes[entries.clone()].to_vec();
    nodes.sort_unstable();
    nodes.dedup();
    let local = |node: &u32| nodes.binary_search(node).unwrap_or_default() as u32;
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
        supports: rows.nodes[entries.clone()].iter().map(local).collect(),
        grad_phi: rows.grad_phi[entries]
            .iter()
            .flat_map(|gradient| gradient.iter().take(components).copied())
            .collect(),
        quadrature_weights: discretisation.quadrature.weights[points.clone()].to_vec(),
        projection: (share > 0.0).then(|| projection(share, starts, discretisation)),
        nodes,
        points,
    }
}

fn projection(share: f64, starts: &[usize], discretisation: &Discretisation) -> Projection {
    let quadrature = &discretisation.quadrature;
    let components = discretisation.dimension.components();
    let basis = |patch: &[usize]| {
        let points = patch[0]..patch[1];
        orthonormal_basis(&quadrature.positions, &quadrature.weights, points, components)
    };
    Projection {
        share,
        starts: starts.iter().map(|start| (start - starts[0]) as u32).collect(),
        basis: starts.windows(2).flat_map(basis).collect(),
    }
}
