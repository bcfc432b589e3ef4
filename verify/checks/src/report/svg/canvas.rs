//! Writes SVG elements; lengths are in CSS pixels of the view box.

use std::fmt::Write;

/// Colours of the palette in the style sheet.
pub(super) const COLOURS: usize = 8;

/// An SVG text that grows.
#[derive(Default)]
pub(super) struct Canvas {
    body: String,
}

/// Which end of a text its position is.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    fn name(self) -> &'static str {
        match self {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        }
    }
}

impl Canvas {
    /// A path with the commands of [`polyline`] or [`marker`].
    pub(crate) fn path(&mut self, class: &str, commands: &str, dash: &str) {
        if commands.is_empty() {
            return;
        }
        let dash =
            if dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dash}\"") };
        let _ = writeln!(self.body, "<path class=\"{class}\" d=\"{commands}\"{dash}/>");
    }

    pub fn line(&mut self, class: &str, from: [f64; 2], to: [f64; 2]) {
        self.path(class, &polyline(&[from, to], false), "");
    }

    pub fn text(&mut self, class: &str, at: [f64; 2], anchor: Anchor, text: &str) {
        let (x, y) = (pixels(at[0]), pixels(at[1]));
        let (anchor, text) = (anchor.name(), escape(text));
        let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
        let _ = writeln!(
            self.body,
            "<text{class} x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\">{text}</text>"
        );
    }

    /// A text that reads upwards, centred at `at`.
    pub(crate) fn upright_text(&mut self, at: [f64; 2], text: &str) {
        let (x, y, text) = (pixels(at[0]), pixels(at[1]), escape(text));
        let _ = writeln!(
            self.body,
            "<text text-anchor=\"middle\" transform=\"translate({x} {y}) rotate(-90)\">{text}</text>"
        );
    }

    /// Another picture of this size, as it is.
    pub(crate) fn picture(&mut self, at: [f64; 2], size: [f64; 2], svg: &str) {
        let [x, y, width, height] = [at[0], at[1], size[0], size[1]].map(pixels);
        let place = format!("<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"");
        let _ = writeln!(self.body, "{place}{}", svg.trim_start_matches("<svg").trim_end());
    }

    /// Closes the picture; `label` is what a screen reader says.
    pub(crate) fn finish(self, width: f64, height: f64, label: &str) -> String {
        format!(
            "<svg class=\"figure\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" \
             role=\"img\" aria-label=\"{}\">\n{}</svg>\n",
            pixels(width),
            pixels(height),
            escape(label),
            self.body
        )
    }
}

/// Path through points; those closer than a third of a pixel are thinned out.
pub(super) fn polyline(points: &[[f64; 2]], closed: bool) -> String {
    let mut commands = String::new();
    let mut last: Option<[f64; 2]> = None;
    for (index, &point) in points.iter().enumerate() {
        let near = last.is_some_and(|l| (point[0] - l[0]).hypot(point[1] - l[1]) < 0.33);
        if near && index + 1 < points.len() {
            continue;
        }
        let command = if last.is_none() { 'M' } else { 'L' };
        let _ = write!(commands, "{command}{} {}", pixels(point[0]), pixels(point[1]));
        last = Some(point);
    }
    if closed && !commands.is_empty() {
        commands.push('Z');
    }
    commands
}

/// One of eight markers that differ in shape, about 8 pixels wide.
pub(super) fn marker(index: usize, at: [f64; 2]) -> String {
    let around = |shape: &[[f64; 2]]| -> String {
        let placed: Vec<[f64; 2]> = shape.iter().map(|d| [at[0] + d[0], at[1] + d[1]]).collect();
        polyline(&placed, true)
    };
    match index % COLOURS {
        0 => dot(at, 3.6),
        1 => around(&[[-3.4, -3.4], [3.4, -3.4], [3.4, 3.4], [-3.4, 3.4]]),
        2 => around(&[[0.0, -4.6], [4.3, 3.2], [-4.3, 3.2]]),
        3 => around(&[[0.0, -4.8], [4.8, 0.0], [0.0, 4.8], [-4.8, 0.0]]),
        4 => around(&[[0.0, 4.6], [4.3, -3.2], [-4.3, -3.2]]),
        5 => around(&[[-3.8, -3.8], [3.8, 3.8]]) + &around(&[[-3.8, 3.8], [3.8, -3.8]]),
        6 => around(&[[-4.8, 0.0], [4.8, 0.0]]) + &around(&[[0.0, -4.8], [0.0, 4.8]]),
        _ => around(&[[-4.0, -4.0], [4.0, -4.0], [-4.0, 4.0], [4.0, 4.0]]),
    }
}

/// An arrow from a bound to the right (1) or to the left (−1).
pub(super) fn pointer([x, y]: [f64; 2], side: f64) -> String {
    let head = [[9.0, -4.0], [16.0, 0.0], [9.0, 4.0]].map(|d| [x + side * d[0], y + d[1]]);
    polyline(&[[x, y - 4.0], [x, y + 4.0]], false)
        + &polyline(&[[x, y], [x + 9.0 * side, y]], false)
        + &polyline(&head, true)
}

/// A disc as a path, so that thousands of them can be one element.
pub(super) fn dot(at: [f64; 2], radius: f64) -> String {
    let (x, y, r, d) =
        (pixels(at[0] - radius), pixels(at[1]), pixels(radius), pixels(2.0 * radius));
    format!("M{x} {y}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0Z")
}

/// Dashes that distinguish lines without colour.
pub(super) fn dash(index: usize) -> &'static str {
    ["", "7 4", "2 4", "9 4 2 4"][index % 4]
}

/// A hundredth of a pixel is enough.
fn pixels(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

/// Guess of the width of a text of the given font size: there is no font to ask.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let width = |c: char| match c {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | ' ' | 't' | 'f' | 'r' => 0.36,
        'm' | 'w' | 'M' | 'W' => 0.86,
        '⁰'..='₉' | '¹' | '²' | '³' => 0.42,
        c if c.is_uppercase() => 0.68,
        _ => 0.57,
    };
    text.chars().map(width).sum::<f64>() * size
}

/// Text inside XML; characters that XML forbids are dropped.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\n' | '\t' => escaped.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => escaped.push(c),
        }
    }
    escaped
}
