//! Search of the nodes near a point.

use crate::algebra::tensor::{Vector3, bounding_box};
use std::ops::Range;

/// Distances that differ by less are equal, over the radius that is searched \[–\].
const TIE: f64 = 1e-6;

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

    /// The cell that is nearest to `x`.
    pub fn cell_of(&self, x: &Vector3) -> usize {
        let [i, j, k] = [0, 1, 2].map(|axis| {
            let index = (x[axis] - self.origin[axis]) / self.cell;
            (index.max(0.0) as usize).min(self.counts[axis] - 1)
        });
        (k * self.counts[1] + j) * self.counts[0] + i
    }

    /// The cells along an axis that the cube of half edge `radius` \[m\] around `x` meets.
    fn range(&self, x: &Vector3, radius: f64, axis: usize) -> Range<usize> {
        let low = (x[axis] - radius - self.origin[axis]) / self.cell;
        let high = (x[axis] + radius - self.origin[axis]) / self.cell;
        if high < 0.0 || low >= self.counts[axis] as f64 {
            return 0..0;
        }
        low.max(0.0) as usize..(high as usize).min(self.counts[axis] - 1) + 1
    }

    /// For each cell the largest of the `radii` \[node\] \[m\] of the nodes that are nearer than
    /// theirs to some point of it, or to one outside of all cells to which it is the nearest; 0
    /// where there is none.
    pub fn reaches(&self, radii: &[f64]) -> Vec<f64> {
        let mut reaches = vec![0.0f64; self.starts.len() - 1];
        for (&node, position) in self.nodes.iter().zip(&self.positions) {
            let radius = radii[node as usize];
            for k in self.range(position, radius, 2) {
                for j in self.range(position, radius, 1) {
                    let row = (k * self.counts[1] + j) * self.counts[0];
                    let columns = self.range(position, radius, 0);
                    let cells = &mut reaches[row + columns.start..row + columns.end];
                    cells.iter_mut().for_each(|reach| *reach = reach.max(radius));
                }
            }
        }
        reaches
    }

    /// The node of some closer to `x` than `radius` \[m\] that is nearest, and those that are as
    /// near but for round-off, ascending; none where none is so close.
    pub fn nearest(&self, x: &Vector3, radius: f64, some: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut least = f64::INFINITY;
        self.for_each_within(x, radius, |node, offset| {
            if some(node) {
                least = least.min(offset.norm());
            }
        });
        let mut found = Vec::new();
        if least.is_finite() {
            self.for_each_within(x, least + TIE * radius, |node, _| {
                if some(node) {
                    found.push(node);
                }
            });
        }
        found.sort_unstable();
        found
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
        for k in self.range(x, radius, 2) {
            for j in self.range(x, radius, 1) {
                let row = (k * self.counts[1] + j) * self.counts[0];
                let columns = self.range(x, radius, 0);
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

        #[test]
        fn no_node_covers_a_point_from_farther_away_than_the_reach_of_its_cell(
            points in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 1..100),
            radius in prop::array::uniform2(0.01..1.0f64),
            x in prop::array::uniform3(-1.5..1.5f64),
            cell in 0.05..0.7f64,
        ) {
            let positions: Vec<Vector3> = points.into_iter().map(Vector3::from).collect();
            let x = Vector3::from(x);
            let radii: Vec<f64> = (0..positions.len()).map(|node| radius[node % 2]).collect();
            let neighbours = Neighbours::new(&positions, cell);
            let reach = neighbours.reaches(&radii)[neighbours.cell_of(&x)];
            for (position, radius) in positions.iter().zip(&radii) {
                prop_assert!((position - x).norm() >= *radius || *radius <= reach);
            }
        }
    }

    #[test]
    fn nodes_as_near_but_for_round_off_are_all_the_nearest() {
        let at = |x: f64| Vector3::new(x, 0.0, 0.0);
        let nodes = Neighbours::new(&[at(1.3), at(-1.0), at(1.0 + 1e-13), at(0.2)], 0.5);
        let nearest = |radius: f64| nodes.nearest(&at(0.0), radius, |node| node != 3);
        assert_eq!((nearest(2.0), nearest(0.9)), (vec![1, 2], vec![]));
        assert_eq!(nodes.nearest(&at(0.0), 2.0, |_| true), [3]);
    }
}
