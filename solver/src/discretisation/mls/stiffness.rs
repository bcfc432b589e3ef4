//! Borders between materials of different stiffness, and the layers that two of them bound.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::held_sides::ON_BORDER;
use crate::discretisation::neighbours::Neighbours;
use crate::geometry::{LabelMap, Selector, Shape};
use crate::problem::{MaterialBorders, Problem, Region};
use rayon::prelude::*;
use std::sync::Arc;

/// Borders are sought between nodes that are closer than this \[spacing\]: each has another
/// across the border; not round, since round-off would choose on lattices.
const REACH: f64 = 1.603_1;
/// Steps along a way, which a thinner layer may escape \[spacing\].
const STEP: f64 = 0.1;
/// Where the softer side of a border is looked for around a place on it \[spacing\].
const LOOKS: [f64; 3] = [0.06, 0.14, 0.27];
/// Cosine of the normals of two borders that face each other, or away from each other, is smaller
/// than this; not round, so that round-off does not choose at right angles.
const FACING: f64 = -0.151_3;
/// Places that are outside by less than this part of a distance to look at are inside \[–\].
const BOUNDARY: f64 = 1e-3;
/// Halvings towards a border.
const HALVINGS: usize = 40;

/// The shear modulus at rest as a function of the reference position.
#[derive(Debug, Clone)]
pub struct Stiffness {
    /// In the order of the regions \[Pa\].
    parts: Vec<(Selector, f64)>,
    /// The same where one look at a label map tells it.
    by_label: Option<ByLabel>,
    /// The least of all \[Pa\].
    softest: f64,
    flat: bool,
    /// Unit vectors to the neighbours in a lattice of cubes, or of squares.
    ways: Vec<Vector3>,
}

impl Stiffness {
    /// Where borders between materials are sharp; `None` where none is.
    pub fn at_sharp_borders(problem: &Problem) -> Option<Stiffness> {
        match problem.recipe.material_borders {
            MaterialBorders::Straddled => None,
            MaterialBorders::Sharp => {
                Stiffness::new(&problem.regions, problem.dimension.components() == 2)
            }
        }
    }

    /// Of the first region that contains a point; `None` where all are equally stiff.
    pub(crate) fn new(regions: &[Region], flat: bool) -> Option<Stiffness> {
        let modulus = |region: &Region| region.material.law.constants().shear_modulus;
        let parts: Vec<_> = regions.iter().map(|r| (r.part.clone(), modulus(r))).collect();
        let differ = parts.windows(2).any(|two| two[0].1 != two[1].1);
        differ.then(|| {
            let by_label = ByLabel::of(&parts);
            let softest = parts.iter().fold(f64::INFINITY, |least, part| least.min(part.1));
            Stiffness { parts, by_label, softest, flat, ways: ways(flat) }
        })
    }

    /// Whether it is that of a plane.
    pub(crate) fn is_flat(&self) -> bool {
        self.flat
    }

    /// \[Pa\]; 0 outside of all regions.
    pub fn at(&self, X: &Vector3) -> f64 {
        if let Some(by_label) = &self.by_label {
            return by_label.at(X);
        }
        self.parts.iter().find(|(part, _)| part.contains(X)).map_or(0.0, |(_, modulus)| *modulus)
    }

    /// In a body, of the stiffer side where X is on a border: on which side of it round-off would
    /// choose \[Pa\].
    pub(super) fn at_place(&self, X: &Vector3, spacing: f64, body: &Shape) -> f64 {
        let reach = ON_BORDER * spacing;
        if !self.may_change(X, reach) {
            return self.at(X);
        }
        // Regions that end at the boundary of the body have another one beyond.
        let around = self.ways.iter().map(|way| X + reach * way);
        let inside = around.filter(|Y| body.signed_distance(Y) < BOUNDARY * reach);
        inside.map(|Y| self.at(&Y)).fold(self.at(X), f64::max)
    }

    /// Whether a border may be closer than `reach` \[m\] to a place.
    pub(super) fn may_change(&self, X: &Vector3, reach: f64) -> bool {
        for (part, _) in &self.parts {
            match part.holds_around(X, reach) {
                Some(true) => return false,
                Some(false) => {}
                None => return true,
            }
        }
        false
    }

    /// Where the ways between near nodes pass from one stiffness to another, in the order of the
    /// nodes.
    pub(crate) fn crossings(&self, nodes: &[Vector3], spacing: &[f64]) -> Vec<Crossing> {
        let smallest = spacing.iter().fold(f64::INFINITY, |a, &b| a.min(b));
        let near = Neighbours::new(nodes, REACH * smallest);
        let of_node = |a: usize| {
            let mut others = Vec::new();
            if self.may_change(&nodes[a], REACH * spacing[a]) {
                near.for_each_within(&nodes[a], REACH * spacing[a], |b, offset| {
                    // Once for each pair, by the first that is close enough.
                    let reaches = offset.norm_squared() < (REACH * spacing[b]).powi(2);
                    if a < b || a > b && !reaches {
                        others.push(b);
                    }
                });
            }
            others.sort_unstable();
            let crossings = |b: usize| {
                let (way, spacing) = ([nodes[a], nodes[b]], 0.5 * (spacing[a] + spacing[b]));
                let length = (way[1] - way[0]).norm();
                let changes = self.changes(&way, spacing).into_iter();
                changes.map(move |position| Crossing { position, ends: [a, b], spacing, length })
            };
            others.into_iter().flat_map(crossings).collect::<Vec<_>>()
        };
        let found: Vec<_> = (0..nodes.len()).into_par_iter().map(of_node).collect();
        found.into_iter().flatten().collect()
    }

    /// Where a straight way passes from one stiffness to another, on the stiffer side by a round-off.
    fn changes(&self, way: &[Vector3; 2], spacing: f64) -> Vec<Vector3> {
        let count = ((way[1] - way[0]).norm() / (STEP * spacing)).ceil().max(1.0) as usize;
        let at = |n: usize| way[0] + (way[1] - way[0]) * (n as f64 / count as f64);
        let mut changes = Vec::new();
        let mut last = (way[0], self.at(&way[0]));
        for n in 1..=count {
            let here = (at(n), self.at(&at(n)));
            if here.1 != last.1 {
                changes.push(self.change(last, here));
            }
            last = here;
        }
        changes
    }

    /// Between two places of different stiffness.
    fn change(&self, from: (Vector3, f64), to: (Vector3, f64)) -> Vector3 {
        let (stiff, soft) = if from.1 > to.1 { (from, to) } else { (to, from) };
        self.last_along(&|t| stiff.0 + t * (soft.0 - stiff.0), |found| found == stiff.1)
    }

    /// The last place along a path whose stiffness `stays` as it is at 0, and does not at 1.
    fn last_along(&self, path: &impl Fn(f64) -> Vector3, stays: impl Fn(f64) -> bool) -> Vector3 {
        let (mut from, mut to) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (from + to);
            if stays(self.at(&path(middle))) {
                from = middle;
            } else {
                to = middle;
            }
        }
        path(from)
    }

    /// The crossing on a surface onto which places are projected; `None` where the ends of its way
    /// are on one side there.
    pub(crate) fn on_surface(
        &self,
        crossing: &Crossing,
        nodes: &[Vector3],
        project: impl Fn(&Vector3) -> Vector3,
    ) -> Option<Crossing> {
        let reach = STEP * crossing.spacing;
        let way = (nodes[crossing.ends[1]] - nodes[crossing.ends[0]]).try_normalize(0.0)?;
        let across = if self.at(&(crossing.position + reach * way)) < self.at(&crossing.position) {
            way
        } else {
            -way
        };
        let path = |t: f64| project(&(crossing.position + (2.0 * t - 1.0) * reach * across));
        let stiffness = self.at(&path(0.0));
        if stiffness <= self.at(&path(1.0)) {
            return None;
        }
        let position = self.last_along(&path, |found| found == stiffness);
        Some(Crossing { position, ..*crossing })
    }

    /// Towards the softer side of the border at X.
    pub(crate) fn normal(&self, X: &Vector3, spacing: f64) -> Vector3 {
        self.normal_of(X, self.at(X), spacing)
    }

    /// The same where the stiffer side is known \[Pa\].
    fn normal_of(&self, X: &Vector3, own: f64, spacing: f64) -> Vector3 {
        let looks = LOOKS.into_iter().flat_map(|look| {
            self.ways.iter().filter(move |way| self.at(&(X + look * spacing * *way)) < own)
        });
        looks.sum::<Vector3>().try_normalize(0.0).unwrap_or_default()
    }

    /// Whether a softer layer lies between two places: the straight way leaves what is as stiff as
    /// the softer of them, `own` \[Pa\], and comes back through borders that face each other.
    pub(super) fn parts(&self, X: &Vector3, Y: &Vector3, own: f64, spacing: f64) -> bool {
        if own <= self.softest {
            return false;
        }
        let (middle, half) = (0.5 * (X + Y), 0.5 * (Y - X).norm());
        if !self.may_change(&middle, half) {
            return false;
        }
        let count = (2.0 * half / (STEP * spacing)).ceil().max(1.0) as usize;
        let at = |n: usize| X + (Y - X) * (n as f64 / count as f64);
        let leaves = |from: Vector3, to: Vector3| {
            self.last_along(&|t| from + t * (to - from), |found| found >= own)
        };
        let mut left: Option<Vector3> = None;
        let mut last = (*X, true);
        for n in 1..=count {
            // On a border, the end is of its stiffer side.
            let here = (at(n), n == count || self.at(&at(n)) >= own);
            match (last.1, here.1) {
                (true, false) => left = Some(leaves(last.0, here.0)),
                (false, true) => {
                    let back = leaves(here.0, last.0);
                    let faces = |left: Vector3| {
                        let normal = |X: &Vector3| self.normal_of(X, own, spacing);
                        are_opposite(&normal(&left), &normal(&back))
                    };
                    if left.is_some_and(faces) {
                        return true;
                    }
                }
                _ => {}
            }
            last = here;
        }
        false
    }
}

/// Whether borders with these normals face each other or away from each other, as those of a layer do.
pub(crate) fn are_opposite(one: &Vector3, other: &Vector3) -> bool {
    one.dot(other) < FACING
}

/// Unit vectors to the neighbours in a lattice of cubes, or of squares.
fn ways(flat: bool) -> Vec<Vector3> {
    let parts = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9].map(|k| k as f64 - 1.0));
    let ways = parts.map(Vector3::from).filter(|way| !flat || way.z == 0.0);
    ways.filter_map(|way| way.try_normalize(0.0)).collect()
}

/// The shear modulus at rest of each label of one map, where regions are labels of it.
#[derive(Debug, Clone)]
struct ByLabel {
    map: Arc<LabelMap>,
    /// The first of a label counts \[Pa\].
    moduli: Vec<(u32, f64)>,
    /// Of all other labels, and outside of the map \[Pa\].
    rest: f64,
}

impl ByLabel {
    fn of(parts: &[(Selector, f64)]) -> Option<ByLabel> {
        let Selector::Label { map, .. } = &parts.first()?.0 else { return None };
        let (mut moduli, mut rest) = (Vec::new(), 0.0);
        for (part, modulus) in parts {
            match part {
                Selector::Label { map: own, label } if Arc::ptr_eq(own, map) => {
                    moduli.push((*label, *modulus));
                }
                Selector::All => {
                    rest = *modulus;
                    break;
                }
                _ => return None,
            }
        }
        Some(ByLabel { map: map.clone(), moduli, rest })
    }

    fn at(&self, X: &Vector3) -> f64 {
        let label = self.map.label_at(X);
        let own = self.moduli.iter().find(|(known, _)| *known == label);
        own.map_or(self.rest, |(_, modulus)| *modulus)
    }
}

/// Where the way between two nodes passes from one stiffness to another.
pub(crate) struct Crossing {
    /// On the stiffer side, by a round-off \[m\].
    pub position: Vector3,
    /// The nodes.
    pub ends: [usize; 2],
    /// Mean of the nodes' \[m\].
    pub spacing: f64,
    /// Between the nodes \[m\].
    pub length: f64,
}
