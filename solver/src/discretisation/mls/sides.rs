//! Which nodes the points of a material see.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::stiffness::Stiffness;
use crate::discretisation::mls::visibility::have_common;
use crate::discretisation::neighbours::Neighbours;
use crate::geometry::Shape;
use rayon::prelude::*;

/// A way around a layer by another node that is no longer than this is as good as the straight
/// one \[straight way\].
const AROUND: f64 = 1.25;
/// Differences of this size do not choose \[–\].
const ROUND_OFF: f64 = 1e-9;
/// Layers are sought between nodes that are closer than this \[influence radius\]: a point sees
/// no farther, and has a node on its side beside it; not round.
const SOUGHT: f64 = 1.351_3;

/// The stiffness around every node: a point sees the nodes that are no softer than itself, so
/// that the displacement of the stiffer side of a border does not follow that of the softer one,
/// and of these the ones that it sees without a softer layer between (method book, section 6).
#[derive(Debug, Clone)]
pub(super) struct Sides {
    stiffness: Stiffness,
    body: Shape,
    nodes: Vec<Vector3>,
    /// \[node\] \[m\]
    spacing: Vec<f64>,
    /// The least of them \[m\].
    smallest_spacing: f64,
    /// \[node\] \[Pa\]
    of_node: Vec<f64>,
    /// For each node those near it from which a softer layer parts it, ascending.
    parted: Vec<Vec<u32>>,
}

impl Sides {
    /// Of nodes of a body, with their influence radii \[m\], which are `dilation` spacings.
    pub fn new(
        stiffness: Stiffness,
        body: &Shape,
        (nodes, radii): (&[Vector3], &[f64]),
        dilation: f64,
    ) -> Sides {
        let spacing: Vec<f64> = radii.iter().map(|radius| radius / dilation).collect();
        let at_node = |(X, spacing): (&Vector3, &f64)| stiffness.at_place(X, *spacing, body);
        let of_node: Vec<f64> = (nodes, &spacing).into_par_iter().map(at_node).collect();
        let smallest = radii.iter().fold(f64::INFINITY, |a, &b| a.min(b));
        let near = Neighbours::new(nodes, SOUGHT * smallest);
        let reach = |node: usize| SOUGHT * radii[node];
        // Once for each pair, by the first that is close enough.
        let found = |a: usize| {
            let mut parted = Vec::new();
            if stiffness.may_change(&nodes[a], reach(a)) {
                near.for_each_within(&nodes[a], reach(a), |b, offset| {
                    let both = offset.norm_squared() < reach(b) * reach(b);
                    let spacing = spacing[a].min(spacing[b]);
                    let own = of_node[a].min(of_node[b]);
                    if (a < b || a > b && !both)
                        && stiffness.parts(&nodes[a], &nodes[b], own, spacing)
                    {
                        parted.push((b as u32, both));
                    }
                });
            }
            parted
        };
        let found: Vec<_> = (0..nodes.len()).into_par_iter().map(found).collect();
        let mut parted = vec![Vec::new(); nodes.len()];
        for (a, others) in found.into_iter().enumerate() {
            for (b, both) in others {
                parted[a].push(b);
                if both {
                    parted[b as usize].push(a as u32);
                }
            }
        }
        parted.iter_mut().for_each(|others| others.sort_unstable());
        let (body, nodes, smallest_spacing) = (body.clone(), nodes.to_vec(), smallest / dilation);
        Sides { stiffness, body, nodes, spacing, smallest_spacing, of_node, parted }
    }

    /// The softest nodes that a point sees \[Pa\].
    pub fn softest_seen(&self, X: &Vector3) -> f64 {
        self.stiffness.at_place(X, self.smallest_spacing, &self.body)
    }

    /// Whether a node is at least as stiff \[Pa\].
    pub fn is_seen(&self, node: u32, softest: f64) -> bool {
        self.of_node[node as usize] >= softest
    }

    /// Drops the nodes of an ascending list, those around a point that are at least as stiff as the
    /// `softest`, that a softer layer parts from it. Only nodes are looked at that one parts from
    /// others of the list.
    pub fn keep_seen(&self, X: &Vector3, softest: f64, around: &mut Vec<u32>) {
        let others = |node: u32| &self.parted[node as usize];
        let is_hidden = |&node: &u32| {
            let spacing = self.spacing[node as usize];
            have_common(others(node), around)
                && self.stiffness.parts(X, &self.nodes[node as usize], softest, spacing)
        };
        let hidden: Vec<u32> = around.iter().copied().filter(is_hidden).collect();
        if hidden.is_empty() {
            return;
        }
        let place = |node: u32| &self.nodes[node as usize];
        let seen = |node: &u32| hidden.binary_search(node).is_err();
        let by_others = |&node: &u32| {
            let most = (1.0 + ROUND_OFF) * AROUND * (place(node) - X).norm();
            let leads_there = |&by: &u32| {
                let way = (place(by) - X).norm() + (place(node) - place(by)).norm();
                way <= most && others(by).binary_search(&node).is_err()
            };
            around.iter().filter(|node| seen(node)).any(leads_there)
        };
        let lost: Vec<u32> = hidden.iter().copied().filter(|node| !by_others(node)).collect();
        around.retain(|node| lost.binary_search(node).is_err());
    }
}
