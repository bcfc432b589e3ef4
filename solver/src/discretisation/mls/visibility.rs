//! Which nodes a point sees through the body (method book, eq. 6.10).
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::neighbours::Neighbours;
use crate::geometry::{Place, Shape};
use rayon::prelude::*;

/// A way around a gap by another node that is no longer than this is as good as the straight
/// one \[straight way\].
const AROUND: f64 = 1.25;
/// Differences of this size do not choose \[spacing\].
const ROUND_OFF: f64 = 1e-9;
/// Gaps are sought between nodes that are closer than this \[influence radius\]: a point sees
/// no farther, and has a node on its side beside it.
const SOUGHT: f64 = 1.35;

/// What nodes see of one another through a body that is not convex. A point sees the nodes
/// to which no gap bars the straight way, and those that one of these sees where the way by
/// it is not much longer.
#[derive(Debug, Clone)]
pub(super) struct Visibility {
    body: Shape,
    nodes: Vec<Place>,
    /// \[node\] \[m\]
    spacing: Vec<f64>,
    /// For each node those near it to which a gap bars the straight way, ascending.
    barred: Vec<Vec<u32>>,
    /// Influence radius over spacing \[–\].
    dilation: f64,
}

impl Visibility {
    /// Of nodes with their influence radii \[m\], which are `dilation` spacings; `None` where
    /// nothing is barred. A body may not have all of them: about the others nothing is known.
    pub fn new(
        body: &Shape,
        (nodes, radii): (&[Vector3], &[f64]),
        near: &Neighbours,
        dilation: f64,
        has: &(dyn Fn(usize) -> bool + Sync),
    ) -> Option<Visibility> {
        if body.is_convex() {
            return None;
        }
        let spacing: Vec<f64> = radii.iter().map(|radius| radius / dilation).collect();
        let nodes: Vec<Place> = nodes.par_iter().map(|X| body.place(X)).collect();
        let found = |a: usize| {
            let mut barred = Vec::new();
            if !has(a) {
                return barred;
            }
            near.for_each_within(&nodes[a].X, SOUGHT * radii[a], |b, offset| {
                // Once for each pair, by the first that is close enough.
                let is_first = a < b || offset.norm_squared() >= (SOUGHT * radii[b]).powi(2);
                if is_first
                    && has(b)
                    && body.parts(&nodes[a], &nodes[b], spacing[a].min(spacing[b]))
                {
                    barred.push(b as u32);
                }
            });
            barred
        };
        let pairs: Vec<Vec<u32>> = (0..nodes.len()).into_par_iter().map(found).collect();
        if pairs.iter().all(Vec::is_empty) {
            return None;
        }
        let mut barred = pairs.clone();
        for (a, others) in pairs.iter().enumerate() {
            others.iter().for_each(|&b| barred[b as usize].push(a as u32));
        }
        barred.iter_mut().for_each(|others| others.sort_unstable());
        Some(Visibility { body: body.clone(), nodes, spacing, barred, dilation })
    }

    /// Whether a gap bars the way from a node to another.
    pub fn is_beside_gap(&self, node: usize) -> bool {
        !self.barred[node].is_empty()
    }

    /// Influence radius over spacing \[–\].
    pub fn dilation(&self) -> f64 {
        self.dilation
    }

    /// Middle \[m\] and width \[m\] of the widest gap on a straight way to one of some nodes.
    pub fn widest_gap(&self, X: &Vector3, nodes: &[u32]) -> Option<(Vector3, f64)> {
        let point = self.body.place(X);
        let gap = |&node: &u32| {
            let (to, spacing) = (&self.nodes[node as usize], self.spacing[node as usize]);
            let parted = self.body.parts(&point, to, spacing);
            parted.then(|| self.body.outside_between(&point, to, spacing))
        };
        nodes.iter().filter_map(gap).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Drops the nodes of an ascending list, those around a point, that it does not see.
    /// Only nodes are looked at to which the way is barred from others of the list.
    pub fn keep_seen(&self, X: &Vector3, around: &mut Vec<u32>) {
        let doubtful = |node: u32| have_common(&self.barred[node as usize], around);
        let doubts: Vec<u32> = around.iter().copied().filter(|&node| doubtful(node)).collect();
        if doubts.is_empty() {
            return;
        }
        let point = self.body.place(X);
        let guides = self.guides(&point, around);
        let is_barred = |&node: &u32| {
            let barring = guides.iter().filter(|guide| !self.see(**guide, node)).count();
            match guides.len() {
                0 | 1 => self.is_barred(&point, node),
                all if barring == 0 || barring == all => barring > 0,
                _ => self.is_barred(&point, node),
            }
        };
        let hidden: Vec<u32> = doubts.into_iter().filter(is_barred).collect();
        let seen = |node: &u32| hidden.binary_search(node).is_err();
        let by_others = |&node: &u32| {
            let place = &self.nodes[node as usize].X;
            let most = (1.0 + ROUND_OFF) * AROUND * (place - X).norm();
            let leads_there = |&by: &u32| {
                let middle = &self.nodes[by as usize].X;
                (middle - X).norm() + (place - middle).norm() <= most && self.see(by, node)
            };
            around.iter().filter(|node| seen(node)).any(leads_there)
        };
        let lost: Vec<u32> = hidden.iter().copied().filter(|node| !by_others(node)).collect();
        around.retain(|node| lost.binary_search(node).is_err());
    }

    /// The two nodes nearest to a point, of the four nearest, that it sees, and others that are
    /// as near: where they agree about a node farther away, it does.
    fn guides(&self, point: &Place, around: &[u32]) -> Vec<u32> {
        let distance = |node: u32| {
            let way = (self.nodes[node as usize].X - point.X) / self.spacing[node as usize];
            way.norm_squared()
        };
        let mut nearest: Vec<(f64, u32)> = around.iter().map(|&n| (distance(n), n)).collect();
        nearest.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut guides: Vec<(f64, u32)> = Vec::new();
        let as_near = |list: &[(f64, u32)], count: usize, distance: f64| {
            list.get(count - 1).is_none_or(|&(farthest, _)| distance <= farthest + ROUND_OFF)
        };
        for &(distance, node) in &nearest {
            if !as_near(&nearest, 4, distance) || !as_near(&guides, 2, distance) {
                break;
            }
            if !self.is_barred(point, node) {
                guides.push((distance, node));
            }
        }
        guides.into_iter().map(|(_, node)| node).collect()
    }

    /// Whether a gap bars the straight way from a point to a node.
    fn is_barred(&self, point: &Place, node: u32) -> bool {
        let (to, spacing) = (&self.nodes[node as usize], self.spacing[node as usize]);
        self.body.parts(point, to, spacing)
    }

    /// Whether no gap bars the way between two nodes.
    fn see(&self, a: u32, b: u32) -> bool {
        let (a, b) = (a as usize, b as usize);
        let spacing = self.spacing[a].min(self.spacing[b]);
        let reach = SOUGHT * self.dilation * spacing;
        if (self.nodes[a].X - self.nodes[b].X).norm_squared() < reach * reach {
            self.barred[a].binary_search(&(b as u32)).is_err()
        } else {
            !self.body.parts(&self.nodes[a], &self.nodes[b], spacing)
        }
    }
}

/// Whether two ascending lists share a member.
pub(super) fn have_common(mut a: &[u32], mut b: &[u32]) -> bool {
    while let (Some(x), Some(y)) = (a.first(), b.first()) {
        match x.cmp(y) {
            std::cmp::Ordering::Less => a = &a[1..],
            std::cmp::Ordering::Greater => b = &b[1..],
            std::cmp::Ordering::Equal => return true,
        }
    }
    false
}
