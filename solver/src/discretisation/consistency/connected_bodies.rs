//! Separate bodies of one discretisation.

use crate::discretisation::rows::Rows;

/// The connected body of each node: nodes that share a support belong together.
pub fn connected_bodies(supports: &[&Rows], nodes: usize) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..nodes as u32).collect();
    fn root(parent: &mut [u32], mut node: u32) -> u32 {
        while parent[node as usize] != node {
            parent[node as usize] = parent[parent[node as usize] as usize];
            node = parent[node as usize];
        }
        node
    }
    for (rows, q) in supports.iter().flat_map(|rows| (0..rows.len()).map(move |q| (rows, q))) {
        let row = rows.row(q);
        let first = root(&mut parent, rows.nodes[row.start]);
        for entry in row {
            let other = root(&mut parent, rows.nodes[entry]);
            parent[first.max(other) as usize] = first.min(other);
        }
    }
    let mut number = vec![u32::MAX; nodes];
    let mut count = 0;
    (0..nodes as u32)
        .map(|node| {
            let root = root(&mut parent, node) as usize;
            if number[root] == u32::MAX {
                number[root] = count;
                count += 1;
            }
            number[root]
        })
        .collect()
}
