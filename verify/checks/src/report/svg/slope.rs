//! Slope triangles on log-log axes.

use super::area::Area;
use super::canvas::{Anchor, Canvas, polyline};
use crate::study::Plot;

const BASE: f64 = 62.0;
const CLEAR: f64 = 12.0;

/// One triangle per slope, beside the curve whose own slope is nearest and
/// where it keeps clear of all curves and of the triangles before it.
pub(super) fn triangles(canvas: &mut Canvas, area: &Area, plot: &Plot) {
    let mut curves: Vec<Vec<[f64; 2]>> = plot
        .series
        .iter()
        .map(|series| series.points.iter().filter_map(|&p| area.place(p)).collect())
        .collect();
    let series_count = curves.len();
    for &slope in plot.slopes.iter().filter(|slope| slope.is_finite()) {
        let steepness = pixel_slope(area, slope);
        let Some(index) = nearest(&curves[..series_count], steepness) else { return };
        let places = [0.5, 0.65, 0.35, 0.8, 0.2];
        let sides = places.iter().flat_map(|&part| [(part, true), (part, false)]);
        let candidates = sides.filter_map(|(part, below)| {
            let triangle = Triangle::beside(area, &curves[index], steepness, part, below)?;
            Some((triangle.clearance(&curves).min(CLEAR), triangle))
        });
        // The first of the clearest ones.
        let best = candidates.reduce(|best, next| if next.0 > best.0 { next } else { best });
        if let Some((_, triangle)) = best {
            triangle.draw(canvas, slope);
            curves.push(vec![triangle.corners[0], triangle.corners[1]]);
        }
    }
}

/// Pixels up per pixel to the right of a line y ∝ xˢ.
fn pixel_slope(area: &Area, slope: f64) -> f64 {
    let per_decade = |a: Option<f64>, b: Option<f64>| a.zip(b).map_or(1.0, |(a, b)| b - a);
    let (x, y) = (area.x.value(area.left), area.y.value(area.bottom));
    let run = per_decade(area.x.position(x), area.x.position(10.0 * x));
    let rise = per_decade(area.y.position(10.0 * y), area.y.position(y));
    slope * rise / run
}

fn nearest(curves: &[Vec<[f64; 2]>], steepness: f64) -> Option<usize> {
    let miss = |curve: &Vec<[f64; 2]>| {
        let (a, b) = (curve.first()?, curve.last()?);
        let own = -(b[1] - a[1]) / (b[0] - a[0]);
        own.is_finite().then_some((own - steepness).abs())
    };
    let misses = curves.iter().enumerate().filter_map(|(i, c)| miss(c).map(|m| (i, m)));
    misses.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
}

/// A right-angled triangle; the first two corners are the ends of the slope.
struct Triangle {
    corners: [[f64; 2]; 3],
    /// Whether the upright side, with the label, is on the right.
    right_of: bool,
}

impl Triangle {
    /// `part` is its position along the curve \[–\]. None where it leaves the frame.
    fn beside(
        area: &Area,
        curve: &[[f64; 2]],
        steepness: f64,
        part: f64,
        below: bool,
    ) -> Option<Triangle> {
        let low = curve.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min);
        let high = curve.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        let steep = 0.45 * (area.bottom - area.top) / steepness.abs().max(1e-9);
        let base = BASE.min(0.6 * (high - low)).min(steep);
        let x0 = low + part * (high - low) - 0.5 * base;
        let rise = steepness * base;
        // Where the slope would start if it touched the curve at t.
        let starts = (0..=8).map(|i| f64::from(i) / 8.0).filter_map(|t| {
            let y = height(curve, x0 + t * base)?;
            Some(y + t * rise)
        });
        let y0 = if below {
            starts.fold(f64::NEG_INFINITY, f64::max) + CLEAR
        } else {
            starts.fold(f64::INFINITY, f64::min) - CLEAR
        };
        let (x1, y1) = (x0 + base, y0 - rise);
        let inside = y0.max(y1) < area.bottom - 6.0 && y0.min(y1) > area.top + 6.0;
        if !(inside && base >= 4.0) {
            return None;
        }
        // The right angle lies away from the curve.
        let right_of = below == (rise >= 0.0);
        let corner = if right_of { [x1, y0] } else { [x0, y1] };
        Some(Triangle { corners: [[x0, y0], [x1, y1], corner], right_of })
    }

    /// Smallest vertical gap to the curves over the triangle and its label,
    /// 0 where one of them runs through.
    fn clearance(&self, curves: &[Vec<[f64; 2]>]) -> f64 {
        let xs = self.corners.map(|c| c[0]);
        let ys = self.corners.map(|c| c[1]);
        let top = ys.iter().copied().fold(f64::INFINITY, f64::min);
        let bottom = ys.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (left, right) =
            if self.right_of { (xs[0], xs[1] + 20.0) } else { (xs[0] - 20.0, xs[1]) };
        let [start, end, corner] = self.corners;
        let gap = |x: f64, y: f64| {
            let t = ((x - start[0]) / (end[0] - start[0])).clamp(0.0, 1.0);
            let slanted = start[1] + t * (end[1] - start[1]);
            let beside = x < xs[0] || x > xs[1];
            let (high, low) = if beside {
                let middle = 0.5 * (top + bottom);
                (middle - 7.0, middle + 7.0)
            } else {
                (slanted.min(corner[1]), slanted.max(corner[1]))
            };
            (high - y).max(y - low).max(0.0)
        };
        let samples = (0..=12).map(|i| left + f64::from(i) / 12.0 * (right - left));
        samples
            .flat_map(|x| curves.iter().filter_map(move |c| Some((x, height(c, x)?))))
            .map(|(x, y)| gap(x, y))
            .fold(f64::INFINITY, f64::min)
    }

    fn draw(&self, canvas: &mut Canvas, slope: f64) {
        let [start, end, _] = self.corners;
        canvas.path("slope", &polyline(&self.corners, true), "");
        let (label, middle) = (label(slope), 0.5 * (start[1] + end[1]) + 4.0);
        if self.right_of {
            canvas.text("halo", [end[0] + 5.0, middle], Anchor::Start, &label);
        } else {
            canvas.text("halo", [start[0] - 5.0, middle], Anchor::End, &label);
        }
    }
}

/// Height of a curve over `x` by linear interpolation between its points.
fn height(curve: &[[f64; 2]], x: f64) -> Option<f64> {
    curve.windows(2).find_map(|pair| {
        let t = (x - pair[0][0]) / (pair[1][0] - pair[0][0]);
        (0.0..=1.0).contains(&t).then(|| pair[0][1] + t * (pair[1][1] - pair[0][1]))
    })
}

fn label(slope: f64) -> String {
    let text = format!("{:.2}", slope.abs());
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if slope < 0.0 { format!("−{text}") } else { text.to_string() }
}
