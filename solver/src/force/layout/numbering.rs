//! A numbering of the nodes of one block.

use crate::discretisation::rows::Rows;
use std::ops::Range;

const NONE: u32 = u32::MAX;

/// The local numbers of the nodes of a block, in the order in which its points see them, which is
/// that of the points in space.
pub struct Numbering {
    /// \[global node\]
    numbers: Vec<u32>,
    nodes: Vec<u32>,
}

impl Numbering {
    /// No node of all has a number.
    pub fn new(nodes: usize) -> Numbering {
        Numbering { numbers: vec![NONE; nodes], nodes: Vec::new() }
    }

    /// Numbers the nodes that some points see, unless there would be more than `most` then;
    /// returns whether it has.
    pub fn add(&mut self, supports: &Rows, points: Range<usize>, most: usize) -> bool {
        let before = self.nodes.len();
        for &node in &supports.nodes[supports.starts[points.start]..supports.starts[points.end]] {
            if self.numbers[node as usize] == NONE {
                self.numbers[node as usize] = self.nodes.len() as u32;
                self.nodes.push(node);
            }
        }
        let fits = self.nodes.len() <= most;
        if !fits {
            self.forget(before);
        }
        fits
    }

    /// Takes all numbers back.
    pub fn clear(&mut self) {
        self.forget(0);
    }

    fn forget(&mut self, from: usize) {
        self.nodes.drain(from..).for_each(|node| self.numbers[node as usize] = NONE);
    }

    /// Global node of each local one.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// The local number of a node.
    pub fn of(&self, node: u32) -> u32 {
        self.numbers[node as usize]
    }
}
