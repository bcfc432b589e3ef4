//! Pictures as SVG with their pixels inside.

use super::colours::{hexadecimal, viridis};
use super::panel::Panel;
use super::scale::Scale;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mtled_checks::report::four_digits;
use mtled_checks::report::svg::{STYLE, escape};
use std::fmt::Write;

/// Colours of a bar between which others are mixed.
const STOPS: usize = 18;
const BAR: [f64; 2] = [380.0, 14.0];
/// Left of a bar, and its whole picture \[pixel\].
const LEFT: f64 = 20.0;
const BAR_PICTURE: [f64; 2] = [420.0, 62.0];
/// Above a panel for its title, and between panels \[pixel\].
const TITLE: f64 = 26.0;
const GAP: f64 = 24.0;

fn svg(size: [f64; 2], label: &str, body: &str) -> String {
    format!(
        "<svg class=\"figure\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\" \
         aria-label=\"{}\">\n{body}</svg>\n",
        size[0],
        size[1],
        escape(label)
    )
}

fn image(panel: &Panel, [x, y]: [f64; 2]) -> String {
    let data = STANDARD.encode(&panel.png);
    let [width, height] = panel.size;
    let mut text = format!(
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
         href=\"data:image/png;base64,{data}\"/>\n"
    );
    let (length, label) = round_length(0.22 * width as f64 * panel.pixel);
    let (left, bottom) = (x + 6.0, y + height as f64 - 8.0);
    let right = left + length / panel.pixel;
    let _ = writeln!(
        text,
        "<path class=\"bar\" d=\"M{left} {bottom}H{right:.1}M{left} {a}V{b}M{right:.1} {a}V{b}\"/>\n\
         <text class=\"tick\" style=\"font-size:17px\" x=\"{:.1}\" y=\"{}\">{label}</text>",
        right + 7.0,
        bottom + 6.0,
        a = bottom - 4.0,
        b = bottom + 4.0,
    );
    text
}

/// The largest round length below one \[m\], and how it is written.
fn round_length(most: f64) -> (f64, String) {
    let power = 10f64.powf(most.log10().floor());
    let length =
        [5.0, 2.0, 1.0].map(|n| n * power).into_iter().find(|l| *l <= most).unwrap_or(power);
    let units = [(1.0, "m"), (1e3, "mm"), (1e6, "µm"), (1e9, "nm")];
    let unit = units.iter().find(|(factor, _)| length * factor >= 0.999);
    let (factor, name) = unit.copied().unwrap_or(units[3]);
    (length, format!("{} {name}", trimmed(length * factor)))
}

/// A panel as a picture of its own, without its title.
pub(crate) fn panel_svg(panel: &Panel) -> String {
    svg(panel.size.map(|n| n as f64), &panel.title, &image(panel, [0.0, 0.0]))
}

/// The bar that explains the colours.
pub(crate) fn bar_svg(scale: &Scale) -> String {
    svg(BAR_PICTURE, &title(scale), &bar(scale, [LEFT, 4.0]))
}

fn title(scale: &Scale) -> String {
    match scale.unit.as_str() {
        "" => scale.label.clone(),
        unit => format!("{} [{unit}]", scale.label),
    }
}

fn bar(scale: &Scale, [left, top]: [f64; 2]) -> String {
    let mut text = String::new();
    let [width, height] = BAR;
    let stop = |n: usize| {
        let part = n as f64 / STOPS as f64;
        format!("<stop offset=\"{part:.3}\" stop-color=\"{}\"/>", hexadecimal(viridis(part)))
    };
    let stops: String = (0..=STOPS).map(stop).collect();
    let _ = writeln!(
        text,
        "<linearGradient id=\"colours\">{stops}</linearGradient>\n<rect x=\"{left}\" y=\"{top}\" \
         width=\"{width}\" height=\"{height}\" fill=\"url(#colours)\"/>"
    );
    for tick in scale.ticks() {
        let x = left + width * scale.fraction(tick / scale.factor);
        let _ = writeln!(
            text,
            "<path class=\"minor\" d=\"M{x:.1} {}V{}\"/>\n\
             <text class=\"tick\" x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            top + height,
            top + height + 4.0,
            top + height + 17.0,
            trimmed(tick)
        );
    }
    let beyond = if scale.cut { "; values beyond the ends have their colours" } else { "" };
    let _ = writeln!(
        text,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}{beyond}</text>",
        left + 0.5 * width,
        top + height + 36.0,
        escape(&title(scale))
    );
    text
}

/// Four digits without zeros at their end.
fn trimmed(value: f64) -> String {
    let text = four_digits(value);
    if text.contains('.') && !text.contains('×') {
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    } else {
        text
    }
}

/// Panels side by side with the bar of their colours, as a file of its own.
pub fn picture_svg(panels: &[Panel], scale: &Scale, label: &str) -> String {
    let mut body = format!("<style>{STYLE}</style>\n");
    let (mut x, mut tallest) = (GAP, 0.0f64);
    for panel in panels {
        let [width, height] = panel.size.map(|n| n as f64);
        let _ = writeln!(body, "<text x=\"{}\" y=\"18\">{}</text>", x + 6.0, escape(&panel.title));
        body += &image(panel, [x, TITLE]);
        x += width + GAP;
        tallest = tallest.max(height);
    }
    let left = (0.5 * (x - BAR[0])).max(LEFT);
    body += &bar(scale, [left, TITLE + tallest + 16.0]);
    svg([x.max(BAR_PICTURE[0]), TITLE + tallest + 16.0 + BAR_PICTURE[1]], label, &body)
}
