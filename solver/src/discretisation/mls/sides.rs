//! Which nodes the points of a material see.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::neighbours::Neighbours;
use crate::geometry::Selector;
use crate::problem::{MaterialBorders, Problem, Region};
use rayon::prelude::*;

/// Borders are sought between nodes that are closer than this \[spacing\]: each has another
/// across the border.
const REACH: f64 = 1.6;
/// A material that is thinner than this beside a border is not told apart \[spacing\].
const THIN: f64 = 1.0;
/// Where both sides of a border are looked at \[THIN\].
const LOOKS: [f64; 3] = [0.33, 0.67, 1.0];
/// Normals of borders come from places so far away \[spacing\].
const NORMAL: f64 = 0.3;
/// The sum of these directions, signed by side, is longer than this beside a single border \[–\].
const PLAIN: f64 = 3.0;
/// Halvings of the way between two nodes.
const HALVINGS: usize = 40;

/// The shear modulus at rest as a function of the reference position.
#[derive(Debug, Clone)]
pub struct Stiffness(Vec<(Selector, f64)>);

impl Stiffness {
    /// Where borders between materials are sharp; `None` where none is.
    pub fn at_sharp_borders(problem: &Problem) -> Option<Stiffness> {
        match problem.recipe.material_borders {
            MaterialBorders::Straddled => None,
            MaterialBorders::Sharp => Stiffness::new(&problem.regions),
        }
    }

    /// Of the first region that contains a point; `None` where all are equally stiff.
    pub(crate) fn new(regions: &[Region]) -> Option<Stiffness> {
        let modulus = |region: &Region| region.material.law.constants().shear_modulus;
        let all: Vec<_> = regions.iter().map(|r| (r.part.clone(), modulus(r))).collect();
        all.windows(2).any(|two| two[0].1 != two[1].1).then_some(Stiffness(all))
    }

    /// \[Pa\]; 0 outside of all regions.
    pub fn at(&self, X: &Vector3) -> f64 {
        self.0.iter().find(|(part, _)| part.contains(X)).map_or(0.0, |(_, modulus)| *modulus)
    }

    /// Where the ways between near nodes leave the stiffer material, in the order of the nodes
    /// on that side.
    pub(crate) fn crossings(&self, nodes: &[Vector3], spacing: &[f64]) -> Vec<Crossing> {
        let own: Vec<f64> = nodes.par_iter().map(|X| self.at(X)).collect();
        let smallest = spacing.iter().fold(f64::INFINITY, |a, &b| a.min(b));
        let near = Neighbours::new(nodes, REACH * smallest);
        let flat = nodes.iter().all(|X| X.z == nodes[0].z);
        let of_node = |stiff: usize| {
            let mut softer = Vec::new();
            near.for_each_within(&nodes[stiff], REACH * spacing[stiff], |soft, _| {
                if own[soft] < own[stiff] {
                    softer.push(soft);
                }
            });
            softer.sort_unstable();
            let crossing = |soft| self.crossing((stiff, soft), nodes, spacing[stiff], flat);
            softer.into_iter().map(crossing).collect::<Vec<_>>()
        };
        let found: Vec<_> = (0..nodes.len()).into_par_iter().map(of_node).collect();
        found.into_iter().flatten().collect()
    }

    fn crossing(
        &self,
        ends: (usize, usize),
        nodes: &[Vector3],
        spacing: f64,
        flat: bool,
    ) -> Crossing {
        let (mut from, mut to) = (nodes[ends.0], nodes[ends.1]);
        let (own, way) = (self.at(&from), to - from);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (from + to);
            if self.at(&middle) == own {
                from = middle;
            } else {
                to = middle;
            }
        }
        let thin = self.is_thin(&from, own, spacing, flat);
        Crossing { position: from, ends, spacing, length: way.norm(), thin }
    }
}

impl Stiffness {
    /// Whether, along the normal of a border at X, one of the two sides ends within [`THIN`]
    /// spacings.
    fn is_thin(&self, X: &Vector3, own: f64, spacing: f64, flat: bool) -> bool {
        let softer = |offset: Vector3| self.at(&(X + offset)) < own;
        let normal: Vector3 = directions(flat)
            .map(|way| if softer(NORMAL * spacing * way) { way } else { -way })
            .sum();
        let Some(normal) = normal.try_normalize(PLAIN) else { return true };
        let ends = |look: f64| {
            let step = look * THIN * spacing * normal;
            !softer(step) || softer(-step)
        };
        LOOKS.into_iter().any(ends)
    }
}

/// Unit vectors to the neighbours in a lattice of cubes, or of squares.
fn directions(flat: bool) -> impl Iterator<Item = Vector3> {
    let parts = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9].map(|k| k as f64 - 1.0));
    let ways = parts.map(Vector3::from).filter(move |way| !flat || way.z == 0.0);
    ways.filter_map(|way| way.try_normalize(0.0))
}

/// Where the way between two nodes leaves the stiffer material, by a round-off before.
pub(crate) struct Crossing {
    /// \[m\]
    pub position: Vector3,
    /// The nodes, that on the stiffer side first.
    pub ends: (usize, usize),
    /// Of the node on the stiffer side \[m\].
    pub spacing: f64,
    /// Between the nodes \[m\].
    pub length: f64,
    /// Whether one of the materials is too thin here to be told apart.
    pub thin: bool,
}

/// The stiffness around every node: a point sees the nodes that are no softer than itself, so
/// that the displacement of the stiffer side of a border does not follow that of the softer one
/// (method book, section 6). Nodes beside materials that are too thin are seen by all.
#[derive(Debug, Clone)]
pub(super) struct Sides {
    stiffness: Stiffness,
    /// \[node\] \[Pa\]; infinite for nodes that all points see.
    of_node: Vec<f64>,
}

impl Sides {
    pub fn new(stiffness: Stiffness, nodes: &[Vector3], spacing: &[f64]) -> Sides {
        let mut of_node: Vec<f64> = nodes.par_iter().map(|X| stiffness.at(X)).collect();
        let smallest = spacing.iter().fold(f64::INFINITY, |a, &b| a.min(b));
        let near = Neighbours::new(nodes, smallest);
        for crossing in stiffness.crossings(nodes, spacing).iter().filter(|c| c.thin) {
            of_node[crossing.ends.0] = f64::INFINITY;
            of_node[crossing.ends.1] = f64::INFINITY;
            near.for_each_within(&crossing.position, REACH * crossing.spacing, |node, _| {
                of_node[node] = f64::INFINITY;
            });
        }
        Sides { stiffness, of_node }
    }

    /// The softest nodes that a point sees \[Pa\].
    pub fn softest_seen(&self, X: &Vector3) -> f64 {
        self.stiffness.at(X)
    }

    /// Whether a node is at least as stiff \[Pa\].
    pub fn is_seen(&self, node: u32, softest: f64) -> bool {
        self.of_node[node as usize] >= softest
    }
}
