//! The colours of bands of values, and the bar that explains them.

use super::super::number::four_digits;
use super::canvas::{Anchor, Canvas, polyline};
use crate::study::ColourScale;

/// Colours in the style sheet, from the smallest values.
const BANDS: usize = 10;
const BAR: f64 = 12.0;

/// The class of a band of a scale, of which there are `edges` less one.
pub(super) fn band_class(band: usize, edges: usize) -> String {
    let last = edges.saturating_sub(2).max(1);
    format!("b{}", (band.min(last) * (BANDS - 1) + last / 2) / last)
}

/// A bar of all bands between two pixels, with their ends below; returns where it ends.
pub(super) fn bar(canvas: &mut Canvas, scale: &ColourScale, from: [f64; 2], right: f64) -> f64 {
    let count = scale.edges.len();
    let [left, top] = from;
    let x = |edge: usize| left + (right - left) * edge as f64 / (count.max(2) - 1) as f64;
    for band in 0..count.saturating_sub(1) {
        let (a, b) = (x(band), x(band + 1));
        let corners = [[a, top], [b, top], [b, top + BAR], [a, top + BAR]];
        canvas.path(&band_class(band, count), &polyline(&corners, true), "");
    }
    let every = count.div_ceil(7).max(1);
    for (edge, value) in scale.edges.iter().enumerate().filter(|(edge, _)| edge % every == 0) {
        canvas.line("minor", [x(edge), top], [x(edge), top + BAR + 3.0]);
        canvas.text("tick", [x(edge), top + BAR + 15.0], Anchor::Middle, &short(*value));
    }
    let unit = if scale.unit.is_empty() { String::new() } else { format!(" [{}]", scale.unit) };
    let title = format!("{}{unit}", scale.label);
    canvas.text("", [0.5 * (left + right), top + BAR + 32.0], Anchor::Middle, &title);
    top + BAR + 36.0
}

/// Without zeros after the decimal point.
fn short(value: f64) -> String {
    let text = four_digits(value);
    if text.contains('.') && !text.contains('×') {
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    } else {
        text
    }
}
