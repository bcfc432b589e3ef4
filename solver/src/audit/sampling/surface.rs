//! Pieces of the boundary, and what of them a selection contains.
#![allow(non_snake_case)]

use super::level::{Level, level};
use super::simplex::{Triangle, vector_area};
use crate::algebra::tensor::Vector3;
use crate::geometry::Selector;
use crate::problem::Dimension;

/// A flat piece of the boundary.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Facet {
    /// Anticlockwise as seen from outside \[m\].
    pub corners: Triangle,
    /// Whether an edge of the body may run through it.
    pub edge: bool,
}

impl Facet {
    /// \[m\]
    pub fn centre(&self) -> Vector3 {
        middle(&self.corners)
    }

    /// \[m²\]
    pub fn area(&self) -> f64 {
        vector_area(&self.corners).norm()
    }

    /// Out of the body.
    pub fn normal(&self) -> Vector3 {
        vector_area(&self.corners).normalize()
    }

    /// Places spread evenly over it, `parts` along each side \[m\].
    pub fn places(&self, parts: usize) -> impl Iterator<Item = Vector3> {
        let [a, b, c] = self.corners;
        let at = move |i: usize, j: usize| {
            let [u, v] = [i, j].map(|n| (n as f64 + 1.0 / 3.0) / parts as f64);
            a + u * (b - a) + v * (c - a)
        };
        (0..parts).flat_map(move |i| (0..parts - i).map(move |j| at(i, j)))
    }
}

/// Edge of the smallest pieces at the rim of a selection, over the nodal spacing \[–\].
const RIM: f64 = 1.0 / 64.0;
/// Deviation of a level from a linear function over the edge of these \[–\]: a rim is straight.
const STRAIGHT: f64 = 0.01;
/// Area of a cell that is cut at an edge of the body, over the square of its edge, which may
/// be wrong \[–\]: a chamfer takes the place of two faces.
const CHAMFER: f64 = 0.6;

/// What a selection contains of the boundary.
#[derive(Debug, Default)]
pub(crate) struct PartOfSurface {
    /// Centre \[m\] and normal times area \[m²\] of pieces.
    pub pieces: Vec<(Vector3, Vector3)>,
    /// \[m²\]
    pub area: f64,
    /// Area that may be wrong \[m²\].
    pub doubt: f64,
}

/// The pieces of facets that a selection contains.
pub(crate) fn part_of_surface(
    facets: &[Facet],
    selector: &Selector,
    dimension: &Dimension,
    spacing: f64,
) -> PartOfSurface {
    let mut part = PartOfSurface::default();
    for facet in facets {
        let area = vector_area(&facet.corners);
        let normal = area.normalize();
        let search = Search { selector, dimension, normal, smallest: RIM * spacing };
        let before = part.area;
        search.visit(facet.corners, &mut part);
        if facet.edge {
            let near = search.level(&middle(&facet.corners)).value <= 2.0 * area.norm().sqrt();
            let own = part.area - before;
            part.doubt += if near { CHAMFER * area.norm().max(own) } else { 0.0 };
        }
    }
    part
}

struct Search<'a> {
    selector: &'a Selector,
    dimension: &'a Dimension,
    normal: Vector3,
    smallest: f64,
}

fn middle(corners: &Triangle) -> Vector3 {
    corners.iter().sum::<Vector3>() / 3.0
}

impl Search<'_> {
    fn at(&self, mut X: Vector3) -> Vector3 {
        if let Dimension::PlaneStrain { z, .. } = self.dimension {
            X.z = *z;
        }
        X
    }

    fn level(&self, X: &Vector3) -> Level {
        level(self.selector, &self.at(*X), Some(&self.normal))
    }

    /// Adds what is selected of a triangle; it is halved where that may not be all or nothing.
    fn visit(&self, corners: Triangle, part: &mut PartOfSurface) {
        let centre = middle(&corners);
        let level = self.level(&centre);
        let lengths: [f64; 3] =
            [0, 1, 2].map(|i| (self.at(corners[i]) - self.at(corners[(i + 1) % 3])).norm());
        let reach = lengths.iter().copied().fold(0.0, f64::max);
        let uniform = level.is_uniform(reach);
        let levels = if uniform { [level; 3] } else { corners.map(|X| self.level(&X)) };
        let decided = uniform || (level.selects() && levels.iter().all(Level::selects));
        let values = levels.map(|level| level.value);
        if decided || reach <= self.smallest || self.is_linear(&corners, level, &values) {
            match decided || !level.metric {
                true if level.selects() => part.add(self.at(centre), vector_area(&corners)),
                true => {}
                false => self.clip(corners, values, part),
            }
            return;
        }
        let longest = (0..3).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b])).unwrap_or_default();
        let [a, b, c] = [0, 1, 2].map(|i| corners[(longest + i) % 3]);
        let half = 0.5 * (a + b);
        self.visit([a, half, c], part);
        self.visit([half, b, c], part);
    }

    /// Whether a level with these values in the middle and at the corners of a triangle is linear in it.
    fn is_linear(&self, corners: &Triangle, middle: Level, values: &[f64; 3]) -> bool {
        let at = |X: &Vector3| self.level(X).value;
        let off = |value: f64, mean: f64| (value - mean).abs() <= STRAIGHT * self.smallest;
        let half = |n: usize| {
            let m = (n + 1) % 3;
            off(at(&(0.5 * (corners[n] + corners[m]))), 0.5 * (values[n] + values[m]))
        };
        middle.metric && off(middle.value, values.iter().sum::<f64>() / 3.0) && (0..3).all(half)
    }

    /// Adds what is selected of a triangle in which the level is linear.
    fn clip(&self, corners: Triangle, levels: [f64; 3], part: &mut PartOfSurface) {
        let mut polygon: Vec<Vector3> = Vec::with_capacity(4);
        for i in 0..3 {
            let (j, own) = ((i + 1) % 3, levels[i]);
            if own <= 0.0 {
                polygon.push(corners[i]);
            }
            if (own <= 0.0) != (levels[j] <= 0.0) {
                polygon.push(corners[i] + (corners[j] - corners[i]) * (own / (own - levels[j])));
            }
        }
        for n in 2..polygon.len() {
            let piece = [polygon[0], polygon[n - 1], polygon[n]];
            part.add(self.at(middle(&piece)), vector_area(&piece));
        }
    }
}

impl PartOfSurface {
    fn add(&mut self, centre: Vector3, area: Vector3) {
        self.area += area.norm();
        self.pieces.push((centre, area));
    }
}
