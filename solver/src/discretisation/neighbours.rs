//! Search of the nodes near a point.

use crate::algebra::tensor::{Vector3, bounding_box};

/// Nodes sorted into cubes whose edge is the largest influence radius or a
/// fraction of it, so that a query visits few of them.
#[derive(Debug, Clone)]
pub struct Neighbours {
    origin: Vector3,
    cell: f64,
    counts: [usize; 3],
    /// Nodes of cell c are `nodes[starts[c]..starts[c + 1]]`.
    starts: Vec<u32>,
    nodes: Vec<u32>,
    /// Positions in the order of `nodes`, so that a query reads in sequence \[m\].
    positions: Vec<Vector3>,
}

impl Neighbours {
    /// Sorts `positions` \[m\] into cells of edge `cell` \[m\], enlarged where
    /// there would be many more cells than nodes.
    pub fn new(positions: &[Vector3], cell: f64) -> Neighbours {
        let (min, max) = bounding_box(positions);
        let mut cell = cell;
        let counts = loop {
            let counts = [0, 1, 2].map(|k| ((max[k] - min[k]) / cell) as usize + 1);
            if counts.iter().product::<usize>() <= 8 * positions.len() + 64 {
                break counts;
            }
            cell *= 1.5;
        };
        let mut neighbours = Neighbours {
            origin: min,
            cell,
            counts,
            starts: Vec::new(),
            nodes: Vec::new(),
            positions: Vec::new(),
        };
        neighbours.fill(positions);
        neighbours
    }

    /// Counting sort, stable: nodes of a cell are in ascending order.
    fn fill(&mut self, positions: &[Vector3]) {
        let cells: Vec<usize> = positions.iter().map(|x| self.cell_of(x)).collect();
        let mut starts = vec![0u32; self.counts.iter().product::<usize>() + 1];
        for &cell in &cells {
            starts[cell + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut nodes = vec![0u32; positions.len()];
        for (node, &cell) in cells.iter().enumerate() {
            nodes[next[cell] as usize] = node as u32;
            next[cell] += 1;
        }
        self.positions = nodes.iter().map(|&node| positions[node as usize]).collect();
        self.starts = starts;
        self.nodes = nodes;
    }

    fn cell_of(&self, x: &Vector3) -> usize {
        let [i, j, k] = [0, 1, 2].map(|axis| {
            let index = (x[axis] - self.origin[axis]) / self.cell;
            (index.max(0.0) as usize).min(self.counts[axis] - 1)
        });
        (k * self.counts[1] + j) * self.counts[0] + i
    }

    /// Calls `visit(node, position − x)` for every node closer to `x` than
    /// `radius` \[m\], in the order of the cells.
    #[inline]
    pub fn for_each_within(
        &self,
        x: &Vector3,
        radius: f64,
        mut visit: impl FnMut(usize, &Vector3),
    ) {
        let square = radius * radius;
        let range = |axis: usize| {
            let low = (x[axis] - radius - self.origin[axis]) / self.cell;
            let high = (x[axis] + radius - self.origin[axis]) / self.cell;
            if high < 0.0 || low >= self.counts[axis] as f64 {
                return 0..0;
            }
            low.max(0.0) as usize..(high as usize).min(self.counts[axis] - 1) + 1
        };
        for k in range(2) {
            for j in range(1) {
                let row = (k * self.counts[1] + j) * self.counts[0];
                let columns = range(0);
                if columns.is_empty() {
                    continue;
                }
                let from = self.starts[row + columns.start] as usize;
                let to = self.starts[row + columns.end] as usize;
                for (&node, position) in self.nodes[from..to].iter().zip(&self.positions[from..to])
                {
                    let offset = position - x;
                    if offset.norm_squared() < square {
                        visit(node as usize, &offset);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_cells_contain_every_node_that_an_exhaustive_search_finds(
            points in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 1..200),
            x in prop::array::uniform3(-1.5..1.5f64),
            radius in 0.01..1.0f64,
            cell in 0.05..0.7f64,
        ) {
            let positions: Vec<Vector3> = points.into_iter().map(Vector3::from).collect();
            let x = Vector3::from(x);
            let mut found = Vec::new();
            Neighbours::new(&positions, cell).for_each_within(&x, radius, |node, offset| {
                assert_eq!(*offset, positions[node] - x);
                found.push(node);
            });
            found.sort_unstable();
            let near = |a: &usize| (positions[*a] - x).norm_squared() < radius * radius;
            let expected: Vec<usize> = (0..positions.len()).filter(near).collect();
            prop_assert_eq!(found, expected);
        }
    }
}
