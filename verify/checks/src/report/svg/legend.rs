//! Legends below a figure, in as many rows as they need.

use super::canvas::{Anchor, Canvas, text_width};

const ROW: f64 = 20.0;
const SWATCH: f64 = 26.0;
const GAP: f64 = 18.0;

/// Where each entry of a legend goes.
pub(super) struct Legend {
    /// Left end and row of each entry.
    places: Vec<(f64, usize)>,
    rows: usize,
}

impl Legend {
    /// Flows `names` into rows of `width`; a name that is too long has a row
    /// of its own and is cut.
    pub(crate) fn new(names: &[&str], width: f64) -> Legend {
        let (mut x, mut row) = (0.0, 0);
        let mut places = Vec::new();
        for name in names {
            let needed = SWATCH + 6.0 + text_width(name, 13.0);
            if x > 0.0 && x + needed > width {
                (x, row) = (0.0, row + 1);
            }
            places.push((x, row));
            x += needed + GAP;
        }
        let rows = if names.is_empty() { 0 } else { row + 1 };
        Legend { places, rows }
    }

    pub(crate) fn height(&self) -> f64 {
        self.rows as f64 * ROW
    }

    /// Draws all entries; `swatch` draws the sample of one entry, by its index,
    /// between two points.
    pub(crate) fn draw(
        &self,
        canvas: &mut Canvas,
        names: &[&str],
        corner: [f64; 2],
        width: f64,
        swatch: impl Fn(&mut Canvas, usize, [f64; 2], [f64; 2]),
    ) {
        for (index, (name, &(x, row))) in names.iter().zip(&self.places).enumerate() {
            let left = corner[0] + x;
            let y = corner[1] + (row as f64 + 0.5) * ROW;
            swatch(canvas, index, [left, y], [left + SWATCH, y]);
            let available = width - x - SWATCH - 6.0;
            let at = [left + SWATCH + 6.0, y + 4.5];
            canvas.text("", at, Anchor::Start, &cut(name, available));
        }
    }
}

/// Shortens a name to a width in pixels.
fn cut(name: &str, width: f64) -> String {
    if text_width(name, 13.0) <= width {
        return name.to_string();
    }
    let mut short: String = name.to_string();
    while short.pop().is_some() && text_width(&short, 13.0) + 13.0 > width {}
    short + "…"
}
