//! The labels that may occur about a place, without a look at every voxel.

use crate::geometry::voxels::grid::indices;

/// Voxels along each edge of a block.
const BLOCK: usize = 4;

/// The smallest and the largest label of each block of voxels, the first index fastest.
#[derive(Debug, Clone)]
pub(super) struct LabelBlocks {
    size: [usize; 3],
    ranges: Vec<(u32, u32)>,
}

impl LabelBlocks {
    pub fn new(voxels: [usize; 3], labels: &[u32]) -> LabelBlocks {
        let size = voxels.map(|n| n.div_ceil(BLOCK));
        let mut ranges = vec![(u32::MAX, 0); size.iter().product()];
        for (row, labels) in labels.chunks(voxels[0]).enumerate() {
            let (j, k) = (row % voxels[1], row / voxels[1]);
            let start = size[0] * (j / BLOCK + size[1] * (k / BLOCK));
            for (labels, (low, high)) in labels.chunks(BLOCK).zip(&mut ranges[start..]) {
                for &label in labels {
                    (*low, *high) = ((*low).min(label), (*high).max(label));
                }
            }
        }
        LabelBlocks { size, ranges }
    }

    /// Of the voxels between two of them, both included.
    pub fn within(&self, first: [usize; 3], last: [usize; 3]) -> (u32, u32) {
        let (first, last) = (first.map(|n| n / BLOCK), last.map(|n| n / BLOCK));
        indices([0, 1, 2].map(|axis| last[axis] - first[axis] + 1))
            .map(|[i, j, k]| {
                let [i, j, k] = [i + first[0], j + first[1], k + first[2]];
                self.ranges[i + self.size[0] * (j + self.size[1] * k)]
            })
            .fold((u32::MAX, 0), |(low, high), (l, h)| (low.min(l), high.max(h)))
    }
}
