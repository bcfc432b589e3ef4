//! The order of summation over blocks.

use super::block::Block;

/// The order in which the forces of the blocks are summed: by chunks of consecutive
/// nodes, which any thread may take, and for each node in the order of the blocks.
#[derive(Debug, Clone)]
pub struct Sums {
    /// Number of nodes in a chunk.
    pub chunk: usize,
    /// The terms of each chunk in the order of the blocks \[chunk\].
    pub terms: Vec<Vec<Term>>,
}

/// The forces of one block on the nodes of a chunk.
#[derive(Debug, Clone)]
pub struct Term {
    /// Index of the block.
    pub block: usize,
    /// Global nodes with their local numbers.
    pub nodes: Vec<(u32, u32)>,
}

impl Sums {
    pub fn new(blocks: &[Block], nodes: usize) -> Sums {
        let chunk = nodes.div_ceil(16).max(1);
        let mut terms = vec![Vec::new(); nodes.div_ceil(chunk)];
        for (index, block) in blocks.iter().enumerate() {
            let mut numbers: Vec<(u32, u32)> = block.nodes.iter().copied().zip(0..).collect();
            numbers.sort_unstable();
            let place = |node: u32| node as usize / chunk;
            for nodes in numbers.chunk_by(|a, b| place(a.0) == place(b.0)) {
                terms[place(nodes[0].0)].push(Term { block: index, nodes: nodes.to_vec() });
            }
        }
        Sums { chunk, terms }
    }
}
