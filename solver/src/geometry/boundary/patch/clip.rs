//! The part of a piece of the boundary where a level is not positive.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::boundary::patch::chart::{Chart, Place};

/// What remains of a surface: where `at`, of a position and what finds the outward normal there,
/// is at most 0.
pub struct Level<'a> {
    pub at: &'a (dyn Fn(&Vector3, &dyn Fn() -> Vector3) -> f64 + Sync),
    /// The most that it changes over a length; infinite if that is not known \[–\].
    pub steepness: f64,
}

/// A level that differs by less than this fraction of the size of a triangle from a linear one
/// is linear \[–\].
const LINEAR: f64 = 1e-4;
/// A border that bends by less than this fraction of the height of the corner that it cuts off
/// is straight \[–\].
const STRAIGHT: f64 = 5e-3;
/// A level whose samples have one sign, and are larger than this many times what they differ from
/// linear ones, does not change its sign: that of a kink between them is not \[–\].
const CLEAR: f64 = 2.0;
/// Halvings before something is believed of a level whose steepness is not known.
const LEAST: usize = 3;
/// Steps to where a level changes its sign.
const CROSSING_STEPS: usize = 50;

/// Triangles of places, or intervals of a curve in their first two corners.
pub type Cell = [Place; 3];

pub fn middle(a: Place, b: Place) -> Place {
    weighted(a, b, 0.5)
}

fn weighted(a: Place, b: Place, s: f64) -> Place {
    [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])]
}

/// A place with its position \[m\] and the level there.
#[derive(Clone, Copy)]
struct Sample {
    place: Place,
    X: Vector3,
    value: f64,
}

/// A straight border that parts one corner of a triangle from the others.
struct Border {
    corner: usize,
    keeps_corner: bool,
    /// On the sides to the next corner and to the one after it.
    ends: [Place; 2],
}

/// Cells of a chart as they are cut.
pub struct Clip<'a> {
    pub chart: &'a Chart,
    /// 1, or −1 where the normal of the chart points into the solid.
    pub side: f64,
    pub level: &'a Level<'a>,
    /// Halvings of a cell.
    pub deepest: usize,
    pub kept: Vec<Cell>,
}

impl Clip<'_> {
    /// Adds what remains of a cell.
    pub fn cut(&mut self, cell: Cell) {
        let corners = cell.map(|place| self.sample(place));
        if self.chart.is_curve() {
            self.interval([corners[0], corners[1]], 0);
        } else {
            self.triangle(corners, 0);
        }
    }

    fn sample(&self, place: Place) -> Sample {
        let X = self.chart.at(place);
        let value = (self.level.at)(&X, &|| self.side * self.chart.normal(place));
        Sample { place, X, value }
    }

    fn value(&self, place: Place) -> f64 {
        self.sample(place).value
    }

    /// Largest distance of the corners of a cell from a place \[m\], a little more on a curve.
    fn reach(&self, corners: &[Sample], from: &Sample) -> f64 {
        let most = corners.iter().map(|c| (c.X - from.X).norm()).fold(0.0, f64::max);
        if self.chart.is_flat() { most } else { 1.05 * most }
    }

    fn interval(&mut self, ends: [Sample; 2], depth: usize) {
        let places = ends.map(|end| end.place);
        let half = self.sample(middle(places[0], places[1]));
        let (value, reach) = (half.value, self.reach(&ends, &half));
        if value.abs() > self.level.steepness * reach {
            if value <= 0.0 {
                self.kept.push([places[0], places[1], places[1]]);
            }
            return;
        }
        let values = ends.map(|end| end.value);
        let bend = (value - 0.5 * (values[0] + values[1])).abs();
        let linear = depth >= self.least() && bend <= LINEAR * reach;
        if !linear && depth < self.deepest {
            self.interval([ends[0], half], depth + 1);
            self.interval([half, ends[1]], depth + 1);
            return;
        }
        let [mut from, mut to] = places;
        match values.map(|value| value <= 0.0) {
            [false, false] => return,
            [true, true] => {}
            [true, false] => to = self.crossing(places, values),
            [false, true] => from = self.crossing(places, values),
        }
        self.kept.push([from, to, to]);
    }

    fn least(&self) -> usize {
        // Facets are small.
        let is_fine = matches!(self.chart, Chart::Facets(_));
        if is_fine || self.level.steepness.is_finite() { 0 } else { LEAST }
    }

    fn triangle(&mut self, corners: [Sample; 3], depth: usize) {
        let cell = corners.map(|corner| corner.place);
        let third = |k: usize| (cell[0][k] + cell[1][k] + cell[2][k]) / 3.0;
        let centre = self.sample([third(0), third(1)]);
        let (value, reach) = (centre.value, self.reach(&corners, &centre));
        if value.abs() > self.level.steepness * reach {
            if value <= 0.0 {
                self.kept.push(cell);
            }
            return;
        }
        let middles = [0, 1, 2].map(|k| self.sample(middle(cell[k], cell[(k + 1) % 3])));
        if depth >= self.least() {
            let (values, halves) = (corners.map(|c| c.value), middles.map(|c| c.value));
            let off = |k: usize| halves[k] - 0.5 * (values[k] + values[(k + 1) % 3]);
            let bend = (value - values.iter().sum::<f64>() / 3.0).abs();
            let bend = (0..3).map(|k| off(k).abs()).fold(bend, f64::max);
            let mut others = values.iter().chain(&halves);
            let is_clear = |other: &f64| other * value > 0.0 && other.abs() > CLEAR * bend;
            let one_side = value.abs() > CLEAR * bend && others.all(is_clear);
            if one_side || bend <= LINEAR * reach || depth >= self.deepest {
                let border = self.border(cell, values);
                self.split(cell, border, value);
                return;
            }
            let border = self.straight_border(cell, values, halves);
            if border.is_some() {
                self.split(cell, border, value);
                return;
            }
        }
        for k in 0..3 {
            let before = (k + 2) % 3;
            self.triangle([corners[k], middles[k], middles[before]], depth + 1);
        }
        self.triangle(middles, depth + 1);
    }

    /// The corner on one side of the border, if the others are on the other.
    fn apart(values: [f64; 3]) -> Option<usize> {
        let keeps = values.map(|value| value <= 0.0);
        let apart = |k: &usize| {
            let (b, c) = ((k + 1) % 3, (k + 2) % 3);
            keeps[*k] != keeps[b] && keeps[b] == keeps[c]
        };
        (0..3).find(apart)
    }

    /// Where a border passes a triangle, if one corner lies on one side of it.
    fn border(&self, cell: Cell, values: [f64; 3]) -> Option<Border> {
        let corner = Self::apart(values)?;
        let from = |k: usize| self.crossing([cell[corner], cell[k]], [values[corner], values[k]]);
        let ends = [from((corner + 1) % 3), from((corner + 2) % 3)];
        Some(Border { corner, keeps_corner: values[corner] <= 0.0, ends })
    }

    /// The same if the border is straight, by values at the middles of the sides too.
    fn straight_border(&self, cell: Cell, values: [f64; 3], halves: [f64; 3]) -> Option<Border> {
        let keeps = |value: f64| value <= 0.0;
        let k = Self::apart(values)?;
        let (b, apex) = ((k + 1) % 3, cell[k]);
        if keeps(halves[b]) != keeps(values[b]) {
            return None;
        }
        let border = self.border(cell, values)?;
        let [P, Q] = border.ends;
        let straight = [0.25, 0.5, 0.75].into_iter().all(|s| {
            let on = weighted(P, Q, s);
            let at = |e: f64| self.value(weighted(apex, on, 1.0 + e));
            keeps(at(-STRAIGHT)) == keeps(values[k]) && keeps(at(STRAIGHT)) == keeps(values[b])
        });
        straight.then_some(border)
    }

    /// Adds what remains of a triangle, with a value in its middle, that a straight border passes.
    fn split(&mut self, cell: Cell, border: Option<Border>, middle: f64) {
        let Some(Border { corner, keeps_corner, ends: [P, Q] }) = border else {
            // Corners may lie on edges, of either side.
            if middle <= 0.0 {
                self.kept.push(cell);
            }
            return;
        };
        let (b, c) = ((corner + 1) % 3, (corner + 2) % 3);
        if keeps_corner {
            self.kept.push([cell[corner], P, Q]);
        } else {
            self.kept.push([P, cell[b], cell[c]]);
            self.kept.push([P, cell[c], Q]);
        }
    }

    /// Where the level changes its sign between two places, by false position with halved
    /// ends (Dowell & Jarratt 1971).
    fn crossing(&self, ends: [Place; 2], values: [f64; 2]) -> Place {
        let ([mut from, mut to], [mut low, mut high]) = ([0.0, 1.0], values);
        let (keeps, nothing) = (low <= 0.0, 1e-9 * (low.abs() + high.abs()));
        for _ in 0..CROSSING_STEPS {
            let s = match low - high {
                0.0 => 0.5 * (from + to),
                rise => (from + (to - from) * low / rise).clamp(from, to),
            };
            let value = self.value(weighted(ends[0], ends[1], s));
            if value.abs() <= nothing || to - from < 1e-10 {
                return weighted(ends[0], ends[1], s);
            }
            if (value <= 0.0) == keeps {
                (from, low, high) = (s, value, 0.5 * high);
            } else {
                (to, high, low) = (s, value, 0.5 * low);
            }
        }
        weighted(ends[0], ends[1], 0.5 * (from + to))
    }
}
