//! Shapes in a plane with equal scales and a scale bar.

use super::super::number::four_digits;
use super::axis::nice_step;
use super::canvas::{Anchor, COLOURS, Canvas, dot, polyline};
use super::legend::Legend;
use super::scale::{band_class, bar};
use crate::study::{Drawing, Layer, LayerStyle};

const WIDTH: f64 = 420.0;
const MARGIN: f64 = 14.0;
const TALLEST: f64 = 380.0;

/// Maps the plane onto the page: equal scales, y up.
struct View {
    scale: f64,
    low: [f64; 2],
    left: f64,
    bottom: f64,
}

impl View {
    fn place(&self, point: [f64; 2]) -> [f64; 2] {
        [
            self.left + (point[0] - self.low[0]) * self.scale,
            self.bottom - (point[1] - self.low[1]) * self.scale,
        ]
    }
}

pub(super) fn to_svg(drawing: &Drawing) -> String {
    let view = view_of(drawing);
    let mut canvas = Canvas::default();
    let first_band = drawing.layers.iter().position(|layer| layer.style == LayerStyle::Band);
    let classes: Vec<Vec<String>> = (drawing.layers.iter().enumerate())
        .map(|(index, layer)| classes(drawing, layer, first_band.is_some_and(|b| index > b)))
        .collect();
    for (layer, classes) in drawing.layers.iter().zip(&classes) {
        shapes(&mut canvas, &view, layer, classes);
    }
    let mut below = view.bottom + MARGIN + 6.0;
    scale_bar(&mut canvas, &view, &drawing.unit, below);
    if let Some(scale) = &drawing.scale {
        below = bar(&mut canvas, scale, [0.42 * WIDTH, below - 4.0], WIDTH - MARGIN - 8.0) - 16.0;
    }
    let named = |(layer, _): &(&Layer, &Vec<String>)| !layer.name.is_empty();
    let (shown, classes): (Vec<&Layer>, Vec<&Vec<String>>) =
        drawing.layers.iter().zip(&classes).filter(named).unzip();
    let names: Vec<&str> = shown.iter().map(|layer| layer.name.as_str()).collect();
    let width = WIDTH - 2.0 * MARGIN;
    let legend = Legend::new(&names, width);
    let corner = [MARGIN, below + 24.0];
    legend.draw(&mut canvas, &names, corner, width, |canvas, index, from, to| {
        swatch(canvas, shown[index], classes[index], from, to);
    });
    canvas.finish(WIDTH, corner[1] + legend.height() + 4.0, &drawing.title)
}

fn finite(point: &[f64; 2]) -> bool {
    point[0].is_finite() && point[1].is_finite() && point[0].abs().max(point[1].abs()) < 1e300
}

fn view_of(drawing: &Drawing) -> View {
    let points = drawing.layers.iter().flat_map(|layer| layer.lines.iter().flatten());
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in points.filter(|point| finite(point)) {
        for i in 0..2 {
            (low[i], high[i]) = (low[i].min(point[i]), high[i].max(point[i]));
        }
    }
    if low[0] > high[0] {
        (low, high) = ([0.0; 2], [1.0; 2]);
    }
    let (widest, tallest) = (WIDTH - 2.0 * MARGIN, TALLEST - 2.0 * MARGIN);
    let (width, height) = (high[0] - low[0], high[1] - low[1]);
    let scale = (widest / width).min(tallest / height);
    // A single point has no size: it is drawn in the middle of a unit square.
    let scale = if scale.is_finite() && scale > 0.0 { scale } else { 200.0 };
    let left = 0.5 * (WIDTH - width * scale);
    View { scale, low, left, bottom: MARGIN + (height * scale).max(8.0) }
}

fn shapes(canvas: &mut Canvas, view: &View, layer: &Layer, classes: &[String]) {
    let mut commands = String::new();
    for line in &layer.lines {
        let runs = line.split(|point| !finite(point));
        for run in runs.filter(|run| !run.is_empty()) {
            let placed: Vec<[f64; 2]> = run.iter().map(|&point| view.place(point)).collect();
            if layer.style == LayerStyle::Dots {
                commands.extend(placed.iter().map(|&at| dot(at, radius(layer))));
            } else {
                let filled = matches!(layer.style, LayerStyle::Filled | LayerStyle::Band);
                let closed = layer.closed || filled;
                // An interrupted line is not closed.
                commands += &polyline(&placed, closed && run.len() == line.len());
            }
        }
    }
    let dash = if layer.style == LayerStyle::Dashed { "6 4" } else { "" };
    classes.iter().for_each(|class| canvas.path(class, &commands, dash));
}

/// Clouds of many points have small dots.
fn radius(layer: &Layer) -> f64 {
    match layer.lines.iter().map(Vec::len).sum::<usize>() {
        0..=200 => 2.4,
        201..=1500 => 1.7,
        _ => 1.1,
    }
}

/// The classes that a layer is drawn with, one above the other; lines above bands of colour are
/// white with dark edges, which all colours let through.
fn classes(drawing: &Drawing, layer: &Layer, above_bands: bool) -> Vec<String> {
    let colour = layer.colour % COLOURS;
    vec![match layer.style {
        LayerStyle::Outline | LayerStyle::Dashed if above_bands => {
            return vec!["casing".into(), "above".into()];
        }
        LayerStyle::Outline | LayerStyle::Dashed => format!("line s{colour}"),
        LayerStyle::Filled => format!("area s{colour} f{colour}"),
        LayerStyle::Dots => format!("f{colour}"),
        LayerStyle::Band => {
            band_class(layer.colour, drawing.scale.as_ref().map_or(0, |scale| scale.edges.len()))
        }
    }]
}

fn swatch(canvas: &mut Canvas, layer: &Layer, classes: &[String], from: [f64; 2], to: [f64; 2]) {
    let (left, right, y) = (from[0], to[0], from[1]);
    let (commands, dash) = match layer.style {
        LayerStyle::Outline => (polyline(&[from, to], false), ""),
        LayerStyle::Dashed => (polyline(&[from, to], false), "6 4"),
        LayerStyle::Filled | LayerStyle::Band => {
            let (top, bottom) = (y - 6.0, y + 6.0);
            (polyline(&[[left, top], [right, top], [right, bottom], [left, bottom]], true), "")
        }
        LayerStyle::Dots => {
            let at = [0.2, 0.5, 0.8].map(|t| [left + t * (right - left), y]);
            (at.map(|at| dot(at, radius(layer).max(1.7))).concat(), "")
        }
    };
    classes.iter().for_each(|class| canvas.path(class, &commands, dash));
}

/// A bar of a round length, about a fifth of the picture.
fn scale_bar(canvas: &mut Canvas, view: &View, unit: &str, y: f64) {
    let length = nice_step(0.12 * (WIDTH - 2.0 * MARGIN) / view.scale);
    let (left, right) = (MARGIN, MARGIN + length * view.scale);
    if !(right.is_finite() && right < WIDTH) {
        return;
    }
    canvas.line("bar", [left, y], [right, y]);
    canvas.line("bar", [left, y - 4.0], [left, y + 4.0]);
    canvas.line("bar", [right, y - 4.0], [right, y + 4.0]);
    canvas.text("tick", [right + 8.0, y + 4.0], Anchor::Start, &length_text(length, unit));
}

/// Metres below ten centimetres are written in millimetres.
fn length_text(length: f64, unit: &str) -> String {
    let trimmed = |value: f64| {
        let text = four_digits(value);
        let plain = text.contains('.') && !text.contains('×');
        if plain { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
    };
    match unit {
        "m" if length < 0.1 && length > 1e-6 => format!("{} mm", trimmed(length * 1e3)),
        "" | "1" => trimmed(length),
        unit => format!("{} {unit}", trimmed(length)),
    }
}
