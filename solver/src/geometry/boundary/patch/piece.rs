//! A panel with its geometry.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::boundary::panel::Panel;
use crate::geometry::boundary::patch::chart::{Chart, Place};
use crate::geometry::boundary::patch::clip::{Cell, Clip, Level};

/// Which places of a chart belong to a panel.
#[derive(Debug, Clone)]
enum Cells {
    Square,
    Triangle,
    Cut(Vec<Cell>),
}

/// A panel and the surface that it stands for.
#[derive(Debug, Clone)]
pub struct Patch {
    /// As a whole solid has it.
    pub panel: Panel,
    chart: Chart,
    cells: Cells,
    /// −1 where the chart is that of a hole.
    side: f64,
}

impl From<Patch> for Panel {
    fn from(patch: Patch) -> Panel {
        patch.panel
    }
}

impl Patch {
    /// All of a chart, or of a curve.
    pub fn square(panel: Panel, chart: Chart) -> Patch {
        Patch { panel, chart, cells: Cells::Square, side: 1.0 }
    }

    /// The half of a flat chart with s + t ≤ 1.
    pub fn triangle(panel: Panel, corner: Vector3, u: Vector3, v: Vector3) -> Patch {
        let chart = Chart::Flat { corner, u, v };
        Patch { panel, chart, cells: Cells::Triangle, side: 1.0 }
    }

    /// Small triangles \[m\] that face about the same way, as one.
    pub fn facets(triangles: &[[Vector3; 3]]) -> Patch {
        let area = |t: &[Vector3; 3]| (t[1] - t[0]).cross(&(t[2] - t[0])).norm();
        let largest = triangles.iter().map(area).fold(f64::MIN_POSITIVE, f64::max);
        // Places as large as the facets are.
        let scales = triangles.iter().map(|t| (area(t) / largest).sqrt());
        let facets = triangles
            .iter()
            .zip(scales.clone())
            .map(|([a, b, c], scale)| [*a, (b - a) / scale, (c - a) / scale]);
        let cells = scales.enumerate().map(|(n, scale)| {
            let s = 2.0 * n as f64;
            [[s, 0.0], [s + scale, 0.0], [s, scale]]
        });
        let (chart, cells) = (Chart::Facets(facets.collect()), Cells::Cut(cells.collect()));
        let panel = Panel::flat(triangles[0][0], 1.0, Vector3::z());
        Patch { panel, chart, cells, side: 1.0 }.integrated()
    }

    /// With the normal on the other side.
    pub fn flipped(self) -> Patch {
        let panel = Panel { normal: -self.panel.normal, ..self.panel };
        Patch { panel, side: -self.side, ..self }
    }

    fn cells(&self) -> Vec<Cell> {
        const O: Place = [0.0, 0.0];
        match &self.cells {
            _ if self.chart.is_curve() && !self.is_cut() => vec![[O, [1.0, 0.0], [1.0, 0.0]]],
            Cells::Square => vec![[O, [1.0, 0.0], [1.0, 1.0]], [O, [1.0, 1.0], [0.0, 1.0]]],
            Cells::Triangle => vec![[O, [1.0, 0.0], [0.0, 1.0]]],
            Cells::Cut(cells) => cells.clone(),
        }
    }

    /// Whether its normal is the same everywhere.
    pub fn is_flat(&self) -> bool {
        self.chart.is_flat()
    }

    fn is_cut(&self) -> bool {
        matches!(self.cells, Cells::Cut(_))
    }

    /// What remains of it by a level, with at most `deepest` halvings, and its fraction of the
    /// places; fractions less than `nothing` off 0 or 1 are 0 or 1.
    pub fn cut(&self, level: &Level, deepest: usize, nothing: f64) -> Option<(Patch, f64)> {
        let value = (level.at)(&self.panel.centre, &|| self.panel.normal);
        if level.steepness.is_finite() && value.abs() > level.steepness * self.reach() {
            return (value <= 0.0).then(|| (self.clone(), 1.0));
        }
        let cells = self.cells();
        let (chart, side) = (&self.chart, self.side);
        let mut clip = Clip { chart, side, level, deepest, kept: Vec::new() };
        cells.iter().for_each(|cell| clip.cut(*cell));
        let sizes = |cells: &[Cell]| cells.iter().map(|cell| self.size(cell)).sum::<f64>();
        let fraction = sizes(&clip.kept) / sizes(&cells);
        if fraction > 1.0 - nothing {
            return Some((self.clone(), 1.0));
        }
        let cells = Cells::Cut(clip.kept);
        let kept = Patch { panel: self.panel, chart: self.chart.clone(), cells, side };
        (fraction > nothing).then(|| (kept.integrated(), fraction))
    }

    /// Largest distance of a place from the centre \[m\], a little more on a curve.
    fn reach(&self) -> f64 {
        let cells = self.cells();
        let corners = cells.iter().flatten();
        let way = |place: &Place| (self.chart.at(*place) - self.panel.centre).norm();
        1.05 * corners.map(way).fold(0.0, f64::max)
    }

    /// With a panel of the true area whose normal and centre give ∫ N dA and ∫ X·N dA of the
    /// surface (method book, eq. 4.5).
    fn integrated(mut self) -> Patch {
        let origin = self.panel.centre;
        let (mut area, mut total, mut first, mut trace) =
            (0.0, Vector3::zeros(), Vector3::zeros(), 0.0);
        self.for_each_point(|X, a| {
            let x = X - origin;
            area += a.norm();
            total += a;
            first += a.norm() * x;
            trace += x.dot(&a);
        });
        let (mean, length) = (first / area, total.norm());
        let normal = total / length;
        let rise = (trace - mean.dot(&total)) / length;
        let centre = origin + mean + rise * normal;
        let flatness = if self.chart.is_flat() { 1.0 } else { length / area };
        self.panel = Panel { centre, area, normal, flatness };
        self
    }

    /// With [`Self::integrated`] where that differs from the panel of the whole solid.
    pub fn exact(self) -> Patch {
        if self.is_cut() || self.chart.is_flat() { self } else { self.integrated() }
    }

    /// Area of a triangle of places; of an interval its length.
    fn size(&self, [a, b, c]: &Cell) -> f64 {
        let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
        if self.chart.is_curve() { u[0].abs() } else { 0.5 * (u[0] * v[1] - u[1] * v[0]).abs() }
    }

    /// Points of the surface and their vector areas \[m\], \[m²\].
    fn for_each_point(&self, mut visit: impl FnMut(Vector3, Vector3)) {
        let rule: &[([f64; 3], f64)] = match self.chart {
            Chart::Line { .. } | Chart::Arc { .. } => &ON_INTERVALS,
            Chart::Flat { .. } | Chart::Facets(_) => &[([1.0 / 3.0; 3], 1.0)],
            _ => &ON_TRIANGLES,
        };
        for cell in self.cells() {
            let size = self.size(&cell);
            for (shares, weight) in rule {
                let at = |k: usize| (0..3).map(|c| shares[c] * cell[c][k]).sum();
                let place = [at(0), at(1)];
                let a = self.side * weight * size * self.chart.area_vector(place);
                visit(self.chart.at(place), a);
            }
        }
    }
}

const NEAR: f64 = 0.445_948_490_915_965;
const FAR: f64 = 0.091_576_213_509_771;
const NEAR_WEIGHT: f64 = 0.223_381_589_678_011;
const FAR_WEIGHT: f64 = 0.109_951_743_655_322;
const NEAR_REST: f64 = 1.0 - 2.0 * NEAR;
const FAR_REST: f64 = 1.0 - 2.0 * FAR;

/// Shares of the corners and weights, of degree 4 (Dunavant 1985).
const ON_TRIANGLES: [([f64; 3], f64); 6] = [
    ([NEAR_REST, NEAR, NEAR], NEAR_WEIGHT),
    ([NEAR, NEAR_REST, NEAR], NEAR_WEIGHT),
    ([NEAR, NEAR, NEAR_REST], NEAR_WEIGHT),
    ([FAR_REST, FAR, FAR], FAR_WEIGHT),
    ([FAR, FAR_REST, FAR], FAR_WEIGHT),
    ([FAR, FAR, FAR_REST], FAR_WEIGHT),
];

/// Gauss–Legendre points of degree 5 between the first two corners.
const ON_INTERVALS: [([f64; 3], f64); 3] = [
    ([0.887_298_334_620_741_7, 0.112_701_665_379_258_3, 0.0], 5.0 / 18.0),
    ([0.5, 0.5, 0.0], 4.0 / 9.0),
    ([0.112_701_665_379_258_3, 0.887_298_334_620_741_7, 0.0], 5.0 / 18.0),
];
