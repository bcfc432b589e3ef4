//! Cells cut along the zero level of values at the vertices.
#![allow(non_snake_case)]

use super::mesh::Mesh;
use mtled::algebra::tensor::Vector3;
use rayon::prelude::*;
use std::collections::HashMap;

/// What a vertex was made of: the fraction `t` of the way from one vertex to another; 0 for a
/// vertex that was there before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Parents {
    pub from: u32,
    pub to: u32,
    pub t: f64,
}

/// Steps towards the zero of a level along an edge.
const STEPS: usize = 10;
/// What the level may have left there, over its change along the edge \[–\].
const LEFT: f64 = 1e-4;

/// Where a level is zero between two points at which it has values of opposite signs: the
/// fraction of the way from the first, by regula falsi and bisection in turn.
pub(crate) fn crossing(
    level: impl Fn(&Vector3) -> f64,
    ends: [&Vector3; 2],
    values: [f64; 2],
) -> f64 {
    let ([mut a, mut b], [mut f_a, mut f_b]) = ([0.0, 1.0], values);
    let secant = |a: f64, b: f64, f_a: f64, f_b: f64| a + (b - a) * f_a / (f_a - f_b);
    let mut t = secant(a, b, f_a, f_b);
    for step in 0..STEPS {
        let f = level(&(ends[0] + (ends[1] - ends[0]) * t));
        if f.is_nan() || f.abs() <= LEFT * (values[0] - values[1]).abs() {
            break;
        }
        if (f < 0.0) == (f_a < 0.0) {
            (a, f_a) = (t, f)
        } else {
            (b, f_b) = (t, f)
        }
        t = if step % 2 == 1 { 0.5 * (a + b) } else { secant(a, b, f_a, f_b) };
    }
    t.clamp(0.0, 1.0)
}

/// Edges of cells whose ends lie on opposite sides, the lower number first, in ascending order.
pub(crate) fn crossed_edges(mesh: &Mesh, values: &[f64]) -> Vec<[u32; 2]> {
    let mut edges = Vec::new();
    for cell in mesh.iter() {
        for (n, &a) in cell.iter().enumerate() {
            for &b in &cell[..n] {
                if values[a as usize] * values[b as usize] < 0.0 {
                    edges.push([a.min(b), a.max(b)]);
                }
            }
        }
    }
    edges.par_sort_unstable();
    edges.dedup();
    edges
}

/// The cells cut along the zero level of `values` \[vertex\], which `level` is everywhere: the new
/// mesh, whether each of its cells lies inside, where the level is negative, and what its
/// vertices are made of. A cell with all vertices on the level is inside if its centre is.
pub(crate) fn split(
    mesh: &Mesh,
    values: &[f64],
    level: &(dyn Fn(&Vector3) -> f64 + Sync),
) -> (Mesh, Vec<bool>, Vec<Parents>) {
    let edges = crossed_edges(mesh, values);
    let between = |&[a, b]: &[u32; 2]| {
        let ends = [a, b].map(|n| &mesh.vertices[n as usize]);
        let t = crossing(level, ends, [a, b].map(|n| values[n as usize]));
        Parents { from: a, to: b, t }
    };
    let made: Vec<Parents> = edges.par_iter().map(between).collect();
    let count = mesh.vertices.len();
    let own = (0..count as u32).map(|n| Parents { from: n, to: n, t: 0.0 });
    let parents: Vec<Parents> = own.chain(made).collect();
    let place = |p: &Parents| {
        let [a, b] = [p.from, p.to].map(|n| mesh.vertices[n as usize]);
        a + (b - a) * p.t
    };
    let numbers = edges.iter().zip(count as u32..).map(|(edge, number)| (*edge, number));
    let cutter = Cutter { numbers: numbers.collect(), values };
    let mut cut =
        Mesh { vertices: parents.iter().map(place).collect(), ..Mesh::empty(mesh.corners) };
    let mut inside = Vec::new();
    for (index, cell) in mesh.iter().enumerate() {
        for side in [true, false] {
            let parts = match cutter.is_crossed(cell) {
                true => cutter.part(cell, side),
                false if cutter.lies(cell, &|| level(&mesh.centre(cell))) == side => {
                    vec![cell.to_vec()]
                }
                false => Vec::new(),
            };
            for mut part in parts {
                if cut.measure(&part) < 0.0 {
                    part.swap(0, 1);
                }
                cut.cells.extend(part);
                cut.regions.push(mesh.regions[index]);
                inside.push(side);
            }
        }
    }
    (cut, inside, parents)
}

/// The part of a mesh where a level is negative, and what its vertices are made of.
pub(crate) fn cut_away(
    mesh: &Mesh,
    values: &[f64],
    level: &(dyn Fn(&Vector3) -> f64 + Sync),
) -> (Mesh, Vec<Parents>) {
    let (mut cut, inside, parents) = split(mesh, values, level);
    let cells = cut.cells.chunks_exact(cut.corners).zip(&inside);
    cut.cells = cells.filter(|(_, inside)| **inside).flat_map(|(cell, _)| cell).copied().collect();
    let regions = cut.regions.iter().zip(&inside).filter(|(_, inside)| **inside);
    cut.regions = regions.map(|(region, _)| *region).collect();
    let kept = cut.drop_unused_vertices();
    let parents = kept.into_iter().map(|vertex| parents[vertex as usize]).collect();
    (cut, parents)
}

/// Cuts cells with the numbers that the new vertices have.
struct Cutter<'a> {
    numbers: HashMap<[u32; 2], u32>,
    values: &'a [f64],
}

impl Cutter<'_> {
    fn value(&self, vertex: u32) -> f64 {
        self.values[vertex as usize]
    }

    fn is_crossed(&self, cell: &[u32]) -> bool {
        cell.iter().any(|&n| self.value(n) < 0.0) && cell.iter().any(|&n| self.value(n) > 0.0)
    }

    /// Whether a cell that is not crossed lies inside.
    fn lies(&self, cell: &[u32], at_centre: &dyn Fn() -> f64) -> bool {
        let first = cell.iter().map(|&n| self.value(n)).find(|value| *value != 0.0);
        first.unwrap_or_else(at_centre) < 0.0
    }

    fn between(&self, a: u32, b: u32) -> u32 {
        self.numbers[&[a.min(b), a.max(b)]]
    }

    /// The cells of the part of a crossed cell on one side. Quadrilaterals are cut from their
    /// lowest number, from both sides alike.
    fn part(&self, cell: &[u32], inside: bool) -> Vec<Vec<u32>> {
        let (mut on, mut own, mut other) = (Vec::new(), Vec::new(), Vec::new());
        for &n in cell {
            match self.value(n) {
                0.0 => on.push(n),
                value if (value < 0.0) == inside => own.push(n),
                _ => other.push(n),
            }
        }
        let cut = |a: u32, b: u32| self.between(a, b);
        match (own.as_slice(), other.as_slice(), on.as_slice()) {
            (&[a], others, on) => {
                let mut part = vec![a];
                part.extend(others.iter().map(|&b| cut(a, b)));
                part.extend(on);
                vec![part]
            }
            (&[a, b], &[p], &[]) => triangulated([a, b, cut(b, p), cut(a, p)]),
            (&[a, b], &[p], &[z]) => {
                let base = triangulated([a, b, cut(b, p), cut(a, p)]);
                base.into_iter().map(|triangle| [&triangle[..], &[z]].concat()).collect()
            }
            (&[a, b], &[p, q], &[]) => prism([a, cut(a, p), cut(a, q)], [b, cut(b, p), cut(b, q)]),
            (&[a, b, c], &[p], &[]) => prism([a, b, c], [cut(a, p), cut(b, p), cut(c, p)]),
            _ => Vec::new(),
        }
    }
}

/// Two triangles of a quadrilateral, whose corners are given around it.
fn triangulated(corners: [u32; 4]) -> Vec<Vec<u32>> {
    let lowest = (0..4).min_by_key(|&n| corners[n]).unwrap_or(0);
    let at = |n: usize| corners[(lowest + n) % 4];
    vec![vec![at(0), at(1), at(2)], vec![at(0), at(2), at(3)]]
}

/// Three tetrahedra of a prism between two triangles: its lowest number joined to the sides that
/// it is not on (Dompierre et al. 1999).
fn prism(bottom: [u32; 3], top: [u32; 3]) -> Vec<Vec<u32>> {
    let lowest = |corners: &[u32; 3]| (0..3).min_by_key(|&n| corners[n]).unwrap_or(0);
    let (mut bottom, mut top) = (bottom, top);
    if top[lowest(&top)] < bottom[lowest(&bottom)] {
        (bottom, top) = (top, bottom);
    }
    let n = lowest(&bottom);
    let (b, c) = ((n + 1) % 3, (n + 2) % 3);
    let mut sides = triangulated([bottom[b], bottom[c], top[c], top[b]]);
    sides.push(top.to_vec());
    sides.into_iter().map(|side| [&side[..], &[bottom[n]]].concat()).collect()
}
