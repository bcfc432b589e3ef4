//! Curves over two axes.

use super::area::Area;
use super::axis::{Scale, Tick, Ticks, axis_title};
use super::canvas::{Anchor, COLOURS, Canvas, dash, marker, pointer, polyline, text_width};
use super::legend::Legend;
use super::slope;
use crate::study::{Plot, Series, SeriesStyle};

const TOP: f64 = 10.0;
const RIGHT: f64 = 16.0;

/// How large a plot is, in pixels, and what is around its frame.
pub(super) struct Size {
    pub width: f64,
    /// Height of the frame.
    pub frame: f64,
    /// Whether there are titles of axes and a legend.
    pub labelled: bool,
}

const WHOLE: Size = Size { width: 420.0, frame: 245.0, labelled: true };
/// One of several panels.
pub(super) const SMALL: Size = Size { width: 200.0, frame: 130.0, labelled: false };
/// Height of a row of an axis of names.
const ROW: f64 = 17.0;
/// What is seen of a floor that lies below the frame.
const STRIP: f64 = 7.0;

/// A plot as SVG.
pub(super) fn to_svg(plot: &Plot) -> String {
    let size = match plot.y.names.len() {
        0 => WHOLE,
        rows => Size { width: 520.0, frame: ROW * rows as f64, labelled: true },
    };
    sized(plot, &[plot], &size)
}

/// A plot with scales that cover all of several plots.
pub(super) fn sized(plot: &Plot, covered: &[&Plot], size: &Size) -> String {
    let (area, x_ticks, y_ticks) = area_of(covered, size);
    let mut canvas = Canvas::default();
    let floor = floor_in(plot);
    shade(&mut canvas, &area, floor);
    axes(&mut canvas, plot, &area, (&x_ticks, &y_ticks), size);
    for (index, series) in plot.series.iter().enumerate() {
        curve(&mut canvas, &area, index, series, floor);
    }
    if plot.x.log && plot.y.log {
        slope::triangles(&mut canvas, &area, plot);
    }
    let label = format!("{}: {} over {}", plot.title, plot.y.label, plot.x.label);
    if !size.labelled {
        return canvas.finish(size.width, area.bottom + 24.0, &label);
    }
    let height = legend(&mut canvas, plot, size.width, area.bottom + 48.0);
    canvas.finish(size.width, height, &label)
}

/// The legend of a plot as a picture of its own; None where no curve has a name.
pub(super) fn legend_alone(plot: &Plot, width: f64) -> Option<String> {
    let mut canvas = Canvas::default();
    let height = legend(&mut canvas, plot, width, 4.0);
    (height > 8.0).then(|| canvas.finish(width, height, &format!("Legend: {}", plot.title)))
}

/// Draws the legend from `top` and returns where it ends.
fn legend(canvas: &mut Canvas, plot: &Plot, width: f64, top: f64) -> f64 {
    let entries: Vec<(usize, &Series)> =
        plot.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty()).collect();
    let names: Vec<&str> = entries.iter().map(|(_, series)| series.name.as_str()).collect();
    let (left, width) = (14.0, width - 28.0);
    let legend = Legend::new(&names, width);
    legend.draw(canvas, &names, [left, top], width, |canvas, entry, from, to| {
        let (index, series) = entries[entry];
        swatch(canvas, index, series, from, to);
    });
    top + legend.height() + 4.0
}

/// The largest y of a floor.
fn floor_in(plot: &Plot) -> Option<f64> {
    let floors = plot.series.iter().filter(|series| series.style == SeriesStyle::Floor);
    let heights = floors.flat_map(|series| &series.points).map(|point| point.1);
    heights.filter(|y| y.is_finite()).reduce(f64::max)
}

/// Scales over all data and error bars, with margins for the labels of the ticks.
fn area_of(plots: &[&Plot], size: &Size) -> (Area, Ticks, Ticks) {
    let bottom = TOP + size.frame;
    let (x_log, y_log) = (plots.iter().all(|p| p.x.log), plots.iter().all(|p| p.y.log));
    let shown = |&&(x, y): &&(f64, f64)| {
        let drawn = |v: f64, log: bool| v.is_finite() && (!log || v > 0.0);
        drawn(x, x_log) && drawn(y, y_log)
    };
    let series = || plots.iter().flat_map(|plot| &plot.series);
    let across = |series: &&Series| series.style != SeriesStyle::Floor;
    let points = || series().filter(across).flat_map(|series| &series.points).filter(shown);
    // How far below its floor a plot goes does not matter.
    let decided = |plot: &&Plot| {
        let floor = floor_in(plot).unwrap_or(f64::NEG_INFINITY);
        let points = plot.series.iter().filter(across).flat_map(|series| &series.points);
        points.filter(shown).map(|point| point.1).filter(|y| *y >= floor).collect::<Vec<_>>()
    };
    let bars = series().flat_map(|series| {
        let pairs = series.points.iter().zip(&series.error_bars);
        pairs.flat_map(|(point, bar)| [point.1 - bar, point.1 + bar])
    });
    let heights = plots.iter().flat_map(decided).chain(bars);
    let names = plots.first().map_or(&[][..], |plot| &plot.y.names[..]);
    let y = match names.len() {
        0 => Scale::covering(heights, y_log, bottom, TOP),
        rows => Scale::of_rows(rows, TOP, bottom),
    };
    let y_ticks = if names.is_empty() { y.ticks() } else { Ticks::named(names) };
    let widest = y_ticks.major.iter().map(|t| text_width(&t.label, 12.0)).fold(0.0, f64::max);
    let left = match (size.labelled, names.is_empty()) {
        (true, true) => (widest + 38.0).clamp(52.0, 150.0),
        (true, false) => (widest + 16.0).clamp(52.0, 250.0),
        (false, _) => widest + 12.0,
    };
    let right = size.width - RIGHT;
    let x = Scale::covering(points().map(|point| point.0), x_log, left, right);
    let x_ticks = x.ticks();
    (Area { x, y, left, right, top: TOP, bottom }, x_ticks, y_ticks)
}

/// Shades what is below the floor.
fn shade(canvas: &mut Canvas, area: &Area, floor: Option<f64>) {
    let Some(y) = floor.and_then(|floor| area.y.position(floor)) else { return };
    let y = y.clamp(area.top, area.bottom - STRIP);
    let Area { left, right, bottom, .. } = *area;
    let corners = [[left, y], [right, y], [right, bottom], [left, bottom]];
    canvas.path("floor", &polyline(&corners, true), "");
    canvas.path("slope", &polyline(&corners[..2], false), "3 3");
}

fn axes(
    canvas: &mut Canvas,
    plot: &Plot,
    area: &Area,
    (x_ticks, y_ticks): (&Ticks, &Ticks),
    size: &Size,
) {
    let Area { left, right, top, bottom, .. } = *area;
    for x in x_ticks.minor.iter().filter_map(|&v| area.x.position(v)) {
        canvas.line("minor", [x, bottom], [x, bottom - 3.0]);
    }
    for y in y_ticks.minor.iter().filter_map(|&v| area.y.position(v)) {
        canvas.line("minor", [left, y], [left + 3.0, y]);
    }
    for x in x_ticks.major.iter().filter_map(|tick| area.x.position(tick.value)) {
        canvas.line("grid", [x, top], [x, bottom]);
        canvas.line("minor", [x, bottom], [x, bottom - 6.0]);
    }
    for y in y_ticks.major.iter().filter_map(|tick| area.y.position(tick.value)) {
        canvas.line("grid", [left, y], [right, y]);
        canvas.line("minor", [left, y], [left + 6.0, y]);
    }
    let width = |tick: &Tick| 0.5 * text_width(&tick.label, 12.0) + 3.0;
    for (tick, x) in x_ticks.labelled(|tick| Some((area.x.position(tick.value)?, width(tick)))) {
        canvas.text("tick", [x, bottom + 17.0], Anchor::Middle, &tick.label);
    }
    for (tick, y) in y_ticks.labelled(|tick| Some((area.y.position(tick.value)?, 7.0))) {
        canvas.text("tick", [left - 6.0, y + 4.0], Anchor::End, &tick.label);
    }
    let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
    canvas.path("frame", &polyline(&corners, true), "");
    if !size.labelled {
        return;
    }
    let middle = [0.5 * (left + right), 0.5 * (top + bottom)];
    let title = axis_title(&plot.x, x_ticks);
    canvas.text("", [middle[0], bottom + 37.0], Anchor::Middle, &title);
    if plot.y.names.is_empty() {
        canvas.upright_text([14.0, middle[1]], &axis_title(&plot.y, y_ticks));
    }
}

fn curve(canvas: &mut Canvas, area: &Area, index: usize, series: &Series, floor: Option<f64>) {
    if series.style == SeriesStyle::Floor {
        return;
    }
    let index = series.colour.unwrap_or(index);
    let colour = index % COLOURS;
    error_bars(canvas, area, colour, series);
    // What is below a floor that is below the frame is on its edge.
    let lowest = if floor.is_some() { area.bottom - 0.5 * STRIP } else { f64::INFINITY };
    let inside = |[x, y]: [f64; 2]| [x, y.min(lowest)];
    if has_line(series.style) {
        // A point that cannot be drawn interrupts the line.
        let mut commands = String::new();
        for run in series.points.split(|&point| area.place(point).is_none()) {
            let run: Vec<[f64; 2]> =
                run.iter().filter_map(|&point| area.place(point)).map(inside).collect();
            commands += &polyline(&run, false);
        }
        canvas.path(&format!("line s{colour}"), &commands, line_dash(index, series));
    }
    if series.style != SeriesStyle::Line {
        let below = |point: &&(f64, f64)| floor.is_some_and(|floor| point.1 < floor);
        let (faint, clear): (Vec<_>, Vec<_>) = series.points.iter().partition(below);
        for (class, points) in [("mark faint", faint), ("mark", clear)] {
            let places = points.iter().filter_map(|&point| area.place(point)).map(inside);
            let marks: String = places.map(|at| mark(index, series.style, at)).collect();
            canvas.path(&format!("{class} s{colour}"), &marks, "");
        }
    }
}

fn has_line(style: SeriesStyle) -> bool {
    matches!(style, SeriesStyle::Line | SeriesStyle::LineAndPoints)
}

fn mark(index: usize, style: SeriesStyle, at: [f64; 2]) -> String {
    match style {
        SeriesStyle::AtMost => pointer(at, -1.0),
        SeriesStyle::AtLeast => pointer(at, 1.0),
        _ => marker(index, at),
    }
}

fn error_bars(canvas: &mut Canvas, area: &Area, colour: usize, series: &Series) {
    let mut commands = String::new();
    for (&(x, y), bar) in series.points.iter().zip(&series.error_bars) {
        let Some([x, _]) = area.place((x, y)) else { continue };
        let Some(high) = area.y.position(y + bar) else { continue };
        // On a log axis a bar may reach below zero: it then leaves the frame.
        let low = area.y.position(y - bar).unwrap_or(area.bottom);
        commands += &polyline(&[[x, high], [x, low]], false);
        commands += &polyline(&[[x - 3.5, high], [x + 3.5, high]], false);
        commands += &polyline(&[[x - 3.5, low], [x + 3.5, low]], false);
    }
    canvas.path(&format!("line s{colour}"), &commands, "");
}

/// Lines without markers differ in their dashes.
fn line_dash(index: usize, series: &Series) -> &'static str {
    if series.style == SeriesStyle::Line { dash(index) } else { "" }
}

fn swatch(canvas: &mut Canvas, index: usize, series: &Series, from: [f64; 2], to: [f64; 2]) {
    let index = series.colour.unwrap_or(index);
    let colour = index % COLOURS;
    if series.style == SeriesStyle::Floor {
        let (top, bottom) = (from[1] - 6.0, from[1] + 6.0);
        let corners = [[from[0], top], [to[0], top], [to[0], bottom], [from[0], bottom]];
        canvas.path("floor", &polyline(&corners, true), "");
        canvas.path("slope", &polyline(&corners[..2], false), "3 3");
        return;
    }
    if has_line(series.style) {
        let class = format!("line s{colour}");
        canvas.path(&class, &polyline(&[from, to], false), line_dash(index, series));
    }
    if series.style != SeriesStyle::Line {
        let middle = [0.5 * (from[0] + to[0]), from[1]];
        canvas.path(&format!("mark s{colour}"), &mark(index, series.style, middle), "");
    }
}
