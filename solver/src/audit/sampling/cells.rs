//! The cells, from the coarsest to those in which the signed distance is linear.
#![allow(non_snake_case)]

use super::corner::{Corner, EDGE, Known};
use super::cost::{self, cost, cost_of};
use super::level::level;
use super::sampled::{Cell, Cut, Sampled, Volume};
use super::seams::{is_seam, may_have_seams};
use super::simplex::{Halves, OF_BOX, Tetrahedron, Triangle, vector_area, volume};
use super::surface::Facet;
use crate::algebra::tensor::Vector3;
use crate::error::Error;
use crate::geometry::{Selector, Shape};
use crate::problem::Dimension;
use rayon::prelude::*;

/// Edge of the largest cells over the nodal spacing \[–\]: what is inside them is smaller than
/// anything that supports resolve.
const COARSEST: f64 = 2.0;
/// Edge of the cells in which a boundary that is flat is cut, over the spacing \[–\].
const FLAT_CELL: f64 = 1.0;
/// The same of the cells in which flat faces meet, and distance of places along their edges \[–\].
const CORNER_CELL: f64 = 0.5;
const ALONG_EDGES: f64 = 1.0 / 16.0;
/// The same of the smallest cells, where faces are not flat and at rough boundaries \[–\].
const FINEST: f64 = 1.0 / 32.0;
/// The cells lie so far beside the middle of the body \[their edge\], so that its faces do not lie between
/// cells, and errors of a body with planes of symmetry do not add up.
const ASIDE: [f64; 3] = [0.13, 0.07, 0.19];
/// Edge of the largest cells of which corners and centre alone say that one part owns them,
/// over the spacing, in space and in a plane \[–\]: labels have no distance.
const SAMPLED_CELL: (f64, f64) = (0.5, 0.25);
/// Deviation of the signed distance from a linear function over the edge of the cell \[–\]: with
/// it a ball of radius R is cut in cells of 0.08 R and its volume is right to 0.1 %.
const BEND: f64 = 0.01;
/// The same from the faces that meet in a cell that is not divided further: a chamfer is ten times as far off.
const BEND_OF_LAST: f64 = 0.05;
/// What a border with two sides in a cell may hide there, over its bend \[–\]: a layer as thick as that lies
/// between corners and centre.
const HIDDEN: f64 = 2.0;
/// Distance of a place on the surface from it, over half of the edge of a cell \[–\]: round-off.
const ON_SURFACE: f64 = 1e-9;
/// Tetrahedra that a part without distances passes are halved so often.
const HALVINGS: usize = 3;
/// The nodes of a body from an image may take so many times that: its set-up takes seconds.
const OF_IMAGE: usize = 4;
/// Cells whose parts are kept at a time before they are added.
const CHUNK: usize = 512;
/// Signed distances of a primitive that are spent in all: a few milliseconds, and per node, about
/// as much as a step of the solution costs there.
const BUDGET: (usize, usize) = (60_000, 30);

/// The body, and the parts that its volume is divided into.
pub(crate) struct Divided<'a> {
    /// In a plane the section.
    pub body: &'a Shape,
    pub dimension: &'a Dimension,
    /// The first that contains a point owns it.
    pub parts: Vec<&'a Selector>,
    /// Typical nodal spacing \[m\].
    pub spacing: f64,
    pub nodes: usize,
}

/// What becomes of a cell.
enum Fate {
    Outside,
    Divided,
    Cut(Cut),
}

/// Divides the bounding box of the body into cells, and these where they are cut.
pub(crate) fn sample(divided: &Divided) -> Result<Sampled, Error> {
    let (lower, upper) = divided.body.finite_bounds(divided.dimension)?;
    let edge = COARSEST * divided.spacing;
    let counts = (upper - lower).map(|length| (length / edge + 0.7).ceil().max(1.0) as usize);
    let middle = 0.5 * (lower + upper) + edge * Vector3::from(ASIDE);
    let start = middle - 0.5 * edge * counts.map(|n| n as f64);
    let flat = matches!(divided.dimension, Dimension::PlaneStrain { .. });
    let count = counts.x * counts.y * if flat { 1 } else { counts.z };
    let mut cells: Vec<Cell> = (0..count).map(|n| divided.cell(n, counts, &start, edge)).collect();
    let times = if !flat && divided.body.has_labels() { OF_IMAGE } else { 1 };
    let mut budget = cost::times(divided.body) * BUDGET.0 + times * BUDGET.1 * divided.nodes;
    let cost = cost(divided.body) + divided.parts.iter().map(|part| cost_of(part)).sum::<usize>();
    let mut sampled =
        Sampled { volumes: vec![Volume::default(); divided.parts.len()], ..Sampled::default() };
    while !cells.is_empty() {
        // Half of the cells lie beside the boundary, and their middle says so.
        let work = |cells: usize| cells * cost * 5;
        budget = budget.saturating_sub(work(cells.len()));
        let finest = cells[0].half.x <= 0.51 * FINEST * divided.spacing;
        let open = divided.cut_all(&cells, finest, &mut sampled);
        if work(open.len() * if flat { 4 } else { 8 }) > budget {
            divided.cut_all(&open, true, &mut sampled);
            break;
        }
        cells = open.iter().flat_map(|cell| cell.children(flat)).collect();
    }
    sampled.volumes.iter_mut().for_each(|part| part.doubt += part.variance.sqrt());
    if may_have_seams(divided.body) {
        sampled.facets.retain(|facet| !is_seam(facet, |X| divided.distance(X)));
    }
    Ok(sampled)
}

impl Divided<'_> {
    fn cell(&self, n: usize, counts: nalgebra::Vector3<usize>, start: &Vector3, edge: f64) -> Cell {
        let index = [n % counts.x, n / counts.x % counts.y, n / (counts.x * counts.y)];
        let mut centre = start + edge * Vector3::from_fn(|k, _| index[k] as f64 + 0.5);
        let mut half = Vector3::repeat(0.5 * edge);
        if let Dimension::PlaneStrain { thickness, z } = self.dimension {
            (centre.z, half.z) = (*z, 0.5 * thickness);
        }
        Cell { centre, half }
    }

    /// The place at which functions are asked: in a plane nothing depends on z.
    fn at(&self, mut X: Vector3) -> Vector3 {
        if let Dimension::PlaneStrain { z, .. } = self.dimension {
            X.z = *z;
        }
        X
    }

    fn distance(&self, X: &Vector3) -> f64 {
        self.body.signed_distance(&self.at(*X))
    }

    fn owner(&self, X: &Vector3) -> Option<usize> {
        let X = self.at(*X);
        self.parts.iter().position(|part| level(part, &X, None).selects())
    }

    /// The part that owns all of a cell; `None` where several may.
    fn only_owner(&self, cell: &Cell, reach: f64) -> Option<usize> {
        if self.parts.len() == 1 {
            return Some(0);
        }
        let X = self.at(cell.centre);
        let (solid, flat) = SAMPLED_CELL;
        let largest = if self.dimension.components() == 2 { flat } else { solid };
        let is_small = cell.half.x <= 0.501 * largest * self.spacing;
        let mut signs_only = false;
        for (index, part) in self.parts.iter().enumerate() {
            let level = level(part, &X, None);
            if level.metric && !level.is_uniform(reach) {
                return None;
            }
            signs_only |= !level.metric;
            if level.selects() {
                let alike = || (0..8).all(|n| self.owner(&cell.corner(n)) == Some(index));
                return (!signs_only || (is_small && alike())).then_some(index);
            }
        }
        None
    }

    /// Adds what lies in cells, and returns those that are to be divided; none if they are the `last`.
    fn cut_all(&self, cells: &[Cell], last: bool, sampled: &mut Sampled) -> Vec<Cell> {
        let mut open = Vec::new();
        for part in cells.chunks(CHUNK) {
            let fates: Vec<Fate> = part.par_iter().map(|cell| self.fate(cell, last)).collect();
            for (cell, fate) in part.iter().zip(fates) {
                match fate {
                    Fate::Outside => {}
                    Fate::Divided => open.push(*cell),
                    Fate::Cut(cut) => sampled.add(cell, cut),
                }
            }
        }
        open
    }

    fn fate(&self, cell: &Cell, last: bool) -> Fate {
        let edge = 2.0 * cell.half.x;
        let components = self.dimension.components();
        let reach = cell.half.x * (components as f64).sqrt();
        let distance = self.distance(&cell.centre);
        if distance > reach {
            return Fate::Outside;
        }
        let owner = self.only_owner(cell, reach);
        if let (true, Some(owner)) = (distance < -reach, owner) {
            let pieces = vec![(cell.centre, cell.volume(), owner)];
            return Fate::Cut(Cut { pieces, ..Cut::default() });
        }
        let mut values = [0.0; 8];
        for n in 0..8 {
            // In a plane the upper corners are as the lower ones.
            let known = components == 2 && n >= 4;
            values[n] = if known { values[n - 4] } else { self.distance(&cell.corner(n)) };
        }
        let bend = bend(&values, distance);
        let flat = bend <= BEND * edge && edge <= 1.01 * FLAT_CELL * self.spacing;
        let is_small = edge <= 1.01 * CORNER_CELL * self.spacing;
        let corner = (!flat && (is_small || last))
            .then(|| self.corner(cell, &values, distance, last))
            .flatten();
        let is_flat =
            (flat || corner.is_some()) && (owner.is_some() || self.has_flat_borders(cell));
        if !(last || is_flat) {
            return Fate::Divided;
        }
        self.cut(cell, (&values, bend), owner, corner)
    }

    /// The flat faces that meet in a cell.
    fn corner(&self, cell: &Cell, values: &[f64; 8], distance: f64, last: bool) -> Option<Corner> {
        let count = if self.dimension.components() == 2 { 4 } else { 8 };
        let corners = (0..count).map(|n| (self.at(cell.corner(n)), values[n]));
        let between = (0..count).map(|n| self.at(0.5 * (cell.centre + cell.corner(n))));
        let between = between.map(|X| (X, self.distance(&X)));
        let known: Vec<Known> =
            corners.chain([(self.at(cell.centre), distance)]).chain(between).collect();
        let bend = if last { BEND_OF_LAST } else { BEND };
        Corner::find(self.body, &known, bend * 2.0 * cell.half.x)
    }

    /// Tetrahedra of a cell inside the body, by part, and the boundary between.
    fn cut(
        &self,
        cell: &Cell,
        (values, bend): (&[f64; 8], f64),
        owner: Option<usize>,
        corner: Option<Corner>,
    ) -> Fate {
        let (halves, edges) = match &corner {
            Some(corner) => self.cut_at_edges(cell, corner),
            None => {
                let mut halves = Halves::of(OF_BOX.len());
                for tetrahedron in OF_BOX {
                    halves.cut(tetrahedron.map(|n| (cell.corner(n), values[n])));
                }
                (halves, Vec::new())
            }
        };
        let is_edge = corner.is_none() && bend > BEND * 2.0 * cell.half.x;
        let bend = corner.map_or(bend, |corner| corner.misfit);
        let on_surface = |corners: &Triangle| {
            if is_edge { *corners } else { self.on_surface(corners, cell.half.x) }
        };
        let corners = halves.border.iter().map(on_surface);
        let mut facets = Vec::with_capacity(halves.border.len());
        facets.extend(
            corners
                .filter(|corners| vector_area(corners).norm() > 0.0)
                .map(|corners| Facet { corners, edge: is_edge }),
        );
        let mut volumes = vec![(Vector3::zeros(), 0.0); self.parts.len()];
        let mut add = |tetrahedra: &[Tetrahedron], part: usize| {
            for tetrahedron in tetrahedra {
                let size = volume(tetrahedron);
                volumes[part].0 += size * tetrahedron.iter().sum::<Vector3>() / 4.0;
                volumes[part].1 += size;
            }
        };
        let by_places = match owner {
            Some(owner) => {
                add(&halves.inside, owner);
                false
            }
            None => self.divide(halves.inside, &mut add),
        };
        let filled = volumes.into_iter().enumerate().filter(|(_, (_, size))| *size > 0.0);
        let pieces = filled.map(|(part, (first, size))| (first / size, size, part)).collect();
        let edge = is_edge && !halves.border.is_empty();
        let border_bends = if owner.is_none() { self.border_bends(cell) } else { Vec::new() };
        Fate::Cut(Cut { pieces, facets, bend, edge, edges, by_places, border_bends })
    }

    /// A triangle with its corners on the surface, beside which linear functions have put them: a
    /// selection may be of the surface alone. Beside an edge another face may be nearer.
    fn on_surface(&self, corners: &Triangle, half: f64) -> Triangle {
        let distances = corners.map(|X| self.distance(&X));
        let is_there = |distance: &f64| distance.abs() <= ON_SURFACE * half;
        if self.body.has_labels() || distances.iter().all(is_there) {
            return *corners;
        }
        let gradient = |X: &Vector3| self.dimension.in_plane(self.body.gradient(&self.at(*X)));
        let middle = corners.iter().sum::<Vector3>() / 3.0;
        let (normal, distance) = (gradient(&middle), self.distance(&middle));
        [0, 1, 2].map(|n| {
            let X = corners[n];
            let own = gradient(&X);
            if own.dot(&normal) > EDGE {
                X - distances[n] * own
            } else {
                X - (normal.dot(&(X - middle)) + distance) * normal
            }
        })
    }

    /// What faces that are flat leave of a cell, and places along their edges.
    fn cut_at_edges(&self, cell: &Cell, corner: &Corner) -> (Halves, Vec<Vector3>) {
        // In a plane an edge is a place.
        let step = match self.dimension.components() {
            2 => f64::INFINITY,
            _ => ALONG_EDGES * self.spacing,
        };
        let edges = corner.edges(&self.at(cell.centre), &cell.half, step);
        (corner.cut(&OF_BOX.map(|tetrahedron| tetrahedron.map(|n| cell.corner(n)))), edges)
    }

    /// Whether the borders of all parts are planes in a cell.
    fn has_flat_borders(&self, cell: &Cell) -> bool {
        let has_distance = |part: &&Selector| level(part, &self.at(cell.centre), None).metric;
        self.parts.iter().all(has_distance)
            && self
                .border_bends(cell)
                .iter()
                .all(|(_, bend)| *bend <= HIDDEN * BEND * 2.0 * cell.half.x)
    }

    /// How far the borders of parts are from where a linear function has them: part, \[m\]. A layer
    /// that lies between the corners of a cell has all of itself there.
    fn border_bends(&self, cell: &Cell) -> Vec<(usize, f64)> {
        let reach = cell.half.x * (self.dimension.components() as f64).sqrt();
        let of = |(index, part): (usize, &&Selector)| {
            let at = |X: &Vector3| level(part, &self.at(*X), None);
            let (corners, middle) =
                ([0, 1, 2, 3, 4, 5, 6, 7].map(|n| at(&cell.corner(n))), at(&cell.centre));
            let is_known = middle.metric && middle.value.is_finite() && !middle.is_uniform(reach);
            is_known.then(|| {
                let bend = bend(&corners.map(|corner| corner.value), middle.value);
                (index, HIDDEN * bend)
            })
        };
        self.parts.iter().enumerate().filter_map(of).collect()
    }

    /// Divides tetrahedra among the parts, along planes where the level is a distance; whether it
    /// is not.
    fn divide(
        &self,
        mut rest: Vec<Tetrahedron>,
        add: &mut impl FnMut(&[Tetrahedron], usize),
    ) -> bool {
        let mut by_places = false;
        for (index, part) in self.parts.iter().enumerate() {
            let at = |X: &Vector3| level(part, &self.at(*X), None);
            let mut halves = Halves::default();
            for tetrahedron in std::mem::take(&mut rest) {
                let middle = at(&(tetrahedron.iter().sum::<Vector3>() / 4.0));
                by_places |= !middle.metric;
                match middle.metric && middle.value.is_infinite() {
                    true if middle.selects() => halves.inside.push(tetrahedron),
                    true => halves.outside.push(tetrahedron),
                    false if middle.metric => {
                        halves.cut(tetrahedron.map(|X| (X, at(&X).value)));
                    }
                    false => halves.sort(tetrahedron, &|X| at(X).selects(), HALVINGS),
                }
            }
            add(&halves.inside, index);
            rest = halves.outside;
        }
        by_places
    }
}

/// Largest deviation from a linear function, from the values at corners and in the middle.
fn bend(values: &[f64; 8], middle: f64) -> f64 {
    let slope: [f64; 3] = [0, 1, 2].map(|axis| {
        let side = |n: usize| if n >> axis & 1 == 1 { 1.0 } else { -1.0 };
        (0..8).map(|n| side(n) * values[n]).sum::<f64>() / 8.0
    });
    let linear = |n: usize| {
        middle + (0..3).map(|k| if n >> k & 1 == 1 { slope[k] } else { -slope[k] }).sum::<f64>()
    };
    (0..8).map(|n| (values[n] - linear(n)).abs()).fold(0.0, f64::max)
}
