//! An order of the nodes in which factors have few entries.

use crate::algebra::tensor::bounding_box;
use crate::force::Block;
use crate::model::Model;

/// Nodes in an order, and how many entries the factors of a stiffness have in it.
pub(super) struct Order {
    pub nodes: Vec<u32>,
    pub entries: usize,
}

impl Order {
    /// Along the longest axis, or from node to neighbour as in the method of Cuthill and McKee (1969),
    /// which serves bodies that are bent: whichever has fewer entries.
    pub fn of(model: &Model) -> Order {
        let groups = Groups::new(model);
        let along = along_axis(model);
        let first = groups.breadth_first(along[0]);
        let again = groups.breadth_first(first[first.len() - 1]);
        let orders = [along, again].map(|nodes| {
            let entries = groups.profile(&nodes) * model.components.pow(2);
            Order { nodes, entries }
        });
        orders.into_iter().min_by_key(|order| order.entries).unwrap_or_else(|| unreachable!())
    }
}

fn along_axis(model: &Model) -> Vec<u32> {
    let (lower, upper) = bounding_box(&model.positions);
    let axis = (upper - lower).imax();
    let at = |node: &u32| model.positions[*node as usize][axis];
    let mut order: Vec<u32> = (0..model.positions.len() as u32).collect();
    order.sort_by(|a, b| at(a).total_cmp(&at(b)));
    order
}

/// Nodes that are coupled with each other: those of a support, or of the supports of a patch.
struct Groups {
    nodes: Vec<Vec<u32>>,
    /// Groups of each node.
    of: Vec<Vec<u32>>,
}

impl Groups {
    fn new(model: &Model) -> Groups {
        let mut nodes = Vec::new();
        for block in &model.points.blocks {
            add_groups(block, model.components, &mut nodes);
        }
        let mut of = vec![Vec::new(); model.positions.len()];
        for (group, nodes) in nodes.iter().enumerate() {
            nodes.iter().for_each(|node: &u32| of[*node as usize].push(group as u32));
        }
        Groups { nodes, of }
    }

    /// Breadth first from a node; nodes that nothing leads to come after all others.
    fn breadth_first(&self, start: u32) -> Vec<u32> {
        let mut order = Vec::with_capacity(self.of.len());
        let (mut seen, mut used) = (vec![false; self.of.len()], vec![false; self.nodes.len()]);
        for start in std::iter::once(start).chain(0..self.of.len() as u32) {
            let mut next = order.len();
            if !std::mem::replace(&mut seen[start as usize], true) {
                order.push(start);
            }
            while next < order.len() {
                let node = order[next] as usize;
                next += 1;
                for &group in &self.of[node] {
                    if std::mem::replace(&mut used[group as usize], true) {
                        continue;
                    }
                    for &other in &self.nodes[group as usize] {
                        if !std::mem::replace(&mut seen[other as usize], true) {
                            order.push(other);
                        }
                    }
                }
            }
        }
        order
    }

    /// Nodes from each to the last one before which none that it fills is missing.
    fn profile(&self, order: &[u32]) -> usize {
        let mut ranks = vec![0; order.len()];
        order.iter().enumerate().for_each(|(rank, node)| ranks[*node as usize] = rank);
        let mut last: Vec<usize> = (0..order.len()).collect();
        for nodes in &self.nodes {
            let ranks = nodes.iter().map(|node| ranks[*node as usize]);
            let ends = ranks.fold((usize::MAX, 0), |(a, b), rank| (a.min(rank), b.max(rank)));
            last[ends.0] = last[ends.0].max(ends.1);
        }
        let (mut furthest, mut entries) = (0, 0);
        for (rank, last) in last.into_iter().enumerate() {
            furthest = furthest.max(last);
            entries += furthest + 1 - rank;
        }
        entries
    }
}

fn add_groups(block: &Block, components: usize, groups: &mut Vec<Vec<u32>>) {
    for chunk in &block.chunks {
        let together = if block.projection.is_some() { chunk.lanes.len() } else { 1 };
        for first in chunk.lanes.clone().step_by(together) {
            let lanes = first..first + together;
            let nodes = lanes.flat_map(|lane| block.support_nodes(lane, components));
            let mut nodes: Vec<u32> = nodes.map(|node| block.nodes[node]).collect();
            nodes.sort_unstable();
            nodes.dedup();
            groups.push(nodes);
        }
    }
}
