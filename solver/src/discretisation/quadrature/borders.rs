//! Cells that borders between regions pass (method book, eq. 7.7).
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::quadrature::cell::Cell;
use crate::discretisation::quadrature::cut::NEARLY_FLAT;
use crate::discretisation::quadrature::simplex::Simplex;
use crate::discretisation::quadrature::voxel_cuts::VoxelBox;
use crate::geometry::{Selector, Shape};
use crate::problem::Region;

/// In the smallest cells levels that differ by less than this are smooth, others have a kink.
const SMOOTH: f64 = 0.1;
/// Less of a cell is round-off \[–\].
const ROUND_OFF: f64 = 1e-9;
/// Tolerances up to this fraction of the largest cells are there for round-off \[–\].
const THIN: f64 = 0.01;

/// The regions of a body, of which each place belongs to the first that holds it.
#[derive(Clone, Copy)]
pub(super) struct Borders<'a> {
    body: &'a Shape,
    regions: &'a [Region],
    /// 2 or 3.
    components: usize,
    /// Tolerances of at most this are there for round-off \[m\].
    thin: f64,
}

/// The region of a place, the first that holds it.
pub(super) fn owner(regions: &[Region], X: &Vector3) -> Option<usize> {
    regions.iter().position(|region| region.part.contains(X))
}

/// A level in a cell: the linear function with its slope and its mean, and the difference.
struct Fit {
    centre: Vector3,
    mean: f64,
    /// Per length \[–\].
    slope: Vector3,
    /// Over the edge \[–\].
    bend: f64,
}

impl Fit {
    fn new(cell: &Cell, components: usize, level: &impl Fn(&Vector3) -> f64) -> Fit {
        let (middle, half) = (level(&cell.centre), 0.5 * cell.edge);
        let corners: Vec<(Vector3, f64)> =
            cell.corners(components).map(|X| (X - cell.centre, level(&X))).collect();
        let count = corners.len() as f64;
        let slope = corners.iter().map(|(x, value)| x * *value).sum::<Vector3>();
        let slope = slope / (count * half * half);
        let off = corners.iter().map(|(x, value)| value - middle - slope.dot(x));
        let bend = off.clone().map(f64::abs).fold(0.0, f64::max) / cell.edge;
        // Of a level that bends, a third of what it rises by at the corners is its mean.
        let mean = middle + off.sum::<f64>() / (3.0 * count);
        Fit { centre: cell.centre, mean, slope, bend }
    }

    fn is_linear(&self) -> bool {
        self.bend <= NEARLY_FLAT
    }

    fn is_smooth(&self) -> bool {
        self.bend <= SMOOTH
    }

    fn at(&self, X: &Vector3) -> f64 {
        self.mean + self.slope.dot(&(X - self.centre))
    }
}

impl<'a> Borders<'a> {
    /// On a grid whose largest cells have an `edge` \[m\].
    pub fn new(body: &'a Shape, regions: &'a [Region], components: usize, edge: f64) -> Self {
        Borders { body, regions, components, thin: THIN * edge }
    }

    /// Whether a border may pass a cell.
    pub fn may_pass(&self, cell: &Cell) -> bool {
        for Region { part, .. } in self.regions {
            let steepness = part.steepness(false);
            if !steepness.is_finite() {
                return self.is_mixed(cell);
            }
            let reach = steepness * cell.half_diagonal(self.components);
            let level = |X: &Vector3| part.level(X, None, self.thin);
            let middle = level(&cell.centre);
            if middle < -reach {
                return false;
            }
            if middle > reach {
                continue;
            }
            let holds = |X: &Vector3| level(X) <= 0.0;
            let held = cell.samples(self.components).filter(holds).count();
            let none = held == 0;
            let all = held == cell.samples(self.components).count();
            if !(none || all) || !Fit::new(cell, self.components, &level).is_linear() {
                return true;
            }
            if all {
                return false;
            }
        }
        false
    }

    /// Whether the sample points of a cell belong to more than one region.
    fn is_mixed(&self, cell: &Cell) -> bool {
        let reach = cell.half_diagonal(self.components);
        let around = |region: &Region| region.part.holds_around(&cell.centre, reach);
        if let Some(Some(true)) =
            self.regions.iter().map(around).find(|holds| *holds != Some(false))
        {
            return false;
        }
        let at_centre = owner(self.regions, &cell.centre);
        cell.samples(self.components).any(|X| owner(self.regions, &X) != at_centre)
    }

    /// The parts of a cell inside the body by region, as far as borders are linear in it; of
    /// the smallest cells as if they were. None where they are not, or not known.
    pub fn split(&self, cell: &Cell, is_cut: bool, smallest: bool) -> Option<Vec<Vec<Simplex>>> {
        if self.regions.iter().any(|region| !region.part.steepness(false).is_finite()) {
            return None;
        }
        let (components, thin) = (self.components, self.thin);
        let cutter = Cutter { cell, components, thin, smallest };
        let mut rest = Simplex::of_cell(cell, self.components);
        let mut parts = vec![Vec::new(); self.regions.len()];
        if is_cut {
            rest = cutter.by_shape(rest, self.body, 0.0)?.low;
        }
        for (region, own) in self.regions.iter().zip(&mut parts) {
            let halves = cutter.by_selection(rest, &region.part)?;
            (*own, rest) = (halves.low, halves.high);
        }
        // What no region holds, but for round-off, is refused where its place is known.
        let left: f64 = rest.iter().map(Simplex::size).sum();
        (left <= ROUND_OFF * cell.edge.powi(components as i32)).then_some(parts)
    }
}

impl Borders<'_> {
    /// The same of a cell that the boundary cuts and that voxels divide into boxes.
    pub fn split_boxes(
        &self,
        cell: &Cell,
        boxes: &[VoxelBox],
        smallest: bool,
    ) -> Option<Vec<Vec<Simplex>>> {
        let (components, thin) = (self.components, self.thin);
        let cutter = Cutter { cell, components, thin, smallest };
        let mut parts = vec![Vec::new(); self.regions.len()];
        for VoxelBox { centre, edges, .. } in boxes {
            let all = Simplex::of_box(centre, edges, components);
            let inside = cutter.by_shape(all, self.body, 0.0)?.low;
            match owner(self.regions, centre) {
                Some(region) => parts[region].extend(inside),
                // What no region holds is refused where its place is known.
                None if inside.is_empty() => {}
                None => return None,
            }
        }
        Some(parts)
    }
}

/// Parts of a cell where a level is at most 0, and where it is more.
#[derive(Default)]
struct Halves {
    low: Vec<Simplex>,
    high: Vec<Simplex>,
}

impl Halves {
    fn swapped(self) -> Halves {
        Halves { low: self.high, high: self.low }
    }
}

/// Cuts the parts of a cell.
struct Cutter<'a> {
    cell: &'a Cell,
    components: usize,
    thin: f64,
    smallest: bool,
}

impl Cutter<'_> {
    fn by_selection(&self, parts: Vec<Simplex>, selection: &Selector) -> Option<Halves> {
        match selection {
            Selector::All => Some(Halves { low: parts, high: Vec::new() }),
            Selector::Plane { point, normal, tolerance } => {
                let distance = |X: &Vector3| (X - point).dot(normal);
                let tolerance = self.counted(*tolerance);
                self.by_all(parts, &[-1.0, 1.0], |parts, side| {
                    self.by_level(parts, &|X| side * distance(X) - tolerance)
                })
            }
            Selector::Inside { shape, tolerance } => {
                self.by_shape(parts, shape, self.counted(*tolerance))
            }
            Selector::Union(all) => {
                self.by_any(parts, all, |parts, part| self.by_selection(parts, part))
            }
            Selector::Intersection(all) => {
                self.by_all(parts, all, |parts, part| self.by_selection(parts, part))
            }
            Selector::Not(part) => Some(self.by_selection(parts, part)?.swapped()),
            Selector::Label { .. } | Selector::Facing { .. } => None,
        }
    }

    /// A tolerance, unless it is there for round-off \[m\].
    fn counted(&self, tolerance: f64) -> f64 {
        if tolerance > self.thin { tolerance } else { 0.0 }
    }

    fn by_shape(&self, parts: Vec<Simplex>, shape: &Shape, tolerance: f64) -> Option<Halves> {
        match shape {
            Shape::Box { min, max } => {
                let faces: Vec<(usize, f64)> =
                    (0..self.components).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]).collect();
                self.by_all(parts, &faces, |parts, (axis, side)| {
                    let face = if *side > 0.0 { max[*axis] } else { min[*axis] };
                    self.by_level(parts, &|X| side * (X[*axis] - face) - tolerance)
                })
            }
            Shape::Union(all) => {
                self.by_any(parts, all, |parts, part| self.by_shape(parts, part, tolerance))
            }
            Shape::Intersection(all) => {
                self.by_all(parts, all, |parts, part| self.by_shape(parts, part, tolerance))
            }
            Shape::Difference(body, hole) => {
                let members = [(body, tolerance), (hole, -tolerance)];
                self.by_all(parts, &members, |parts, (shape, tolerance)| {
                    let halves = self.by_shape(parts, shape, *tolerance)?;
                    Some(if std::ptr::eq(*shape, hole) { halves.swapped() } else { halves })
                })
            }
            _ => {
                let level = |X: &Vector3| shape.signed_distance(X) - tolerance;
                let reach = shape.steepness() * self.cell.half_diagonal(self.components);
                match level(&self.cell.centre) {
                    far if far > reach => Some(Halves { low: Vec::new(), high: parts }),
                    deep if deep < -reach => Some(Halves { low: parts, high: Vec::new() }),
                    _ => self.by_level(parts, &level),
                }
            }
        }
    }

    /// Where all of some levels are at most 0.
    fn by_all<T>(
        &self,
        parts: Vec<Simplex>,
        all: &[T],
        by: impl Fn(Vec<Simplex>, &T) -> Option<Halves>,
    ) -> Option<Halves> {
        all.iter().try_fold(Halves { low: parts, high: Vec::new() }, |mut halves, one| {
            let next = by(halves.low, one)?;
            halves.high.extend(next.high);
            Some(Halves { low: next.low, high: halves.high })
        })
    }

    /// Where any of some levels is at most 0.
    fn by_any<T>(
        &self,
        parts: Vec<Simplex>,
        all: &[T],
        by: impl Fn(Vec<Simplex>, &T) -> Option<Halves>,
    ) -> Option<Halves> {
        let none = |parts: Vec<Simplex>, one: &T| Some(by(parts, one)?.swapped());
        Some(self.by_all(parts, all, none)?.swapped())
    }

    fn by_level(&self, parts: Vec<Simplex>, level: &impl Fn(&Vector3) -> f64) -> Option<Halves> {
        let fit = Fit::new(self.cell, self.components, level);
        let mut halves = Halves::default();
        for part in parts {
            let Halves { low, high } = &mut halves;
            match fit.is_linear() || self.smallest && fit.is_smooth() {
                true => part.split(&|X: &Vector3| fit.at(X), low, high),
                false if self.smallest => part.split(level, low, high),
                false => return None,
            }
        }
        Some(halves)
    }
}
