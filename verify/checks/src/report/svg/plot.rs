//! Curves over two axes.

use super::area::Area;
use super::axis::{Scale, Tick, Ticks, axis_title};
use super::canvas::{Anchor, COLOURS, Canvas, dash, marker, polyline, text_width};
use super::legend::Legend;
use super::slope;
use crate::study::{Plot, Series, SeriesStyle};

const WIDTH: f64 = 420.0;
const BOX_HEIGHT: f64 = 245.0;
const TOP: f64 = 10.0;
const RIGHT: f64 = 16.0;

/// A plot as SVG.
pub(super) fn to_svg(plot: &Plot) -> String {
    let (area, x_ticks, y_ticks) = area_of(plot);
    let mut canvas = Canvas::default();
    axes(&mut canvas, plot, &area, &x_ticks, &y_ticks);
    for (index, series) in plot.series.iter().enumerate() {
        curve(&mut canvas, &area, index, series);
    }
    if plot.x.log && plot.y.log {
        slope::triangles(&mut canvas, &area, plot);
    }
    let names: Vec<&str> = plot.series.iter().map(|series| series.name.as_str()).collect();
    let named: &[&str] = if names.iter().all(|name| name.is_empty()) { &[] } else { &names };
    let (left, width) = (14.0, WIDTH - 28.0);
    let legend = Legend::new(named, width);
    let corner = [left, area.bottom + 48.0];
    legend.draw(&mut canvas, named, corner, width, |canvas, index, from, to| {
        swatch(canvas, index, &plot.series[index], from, to);
    });
    let label = format!("{}: {} over {}", plot.title, plot.y.label, plot.x.label);
    canvas.finish(WIDTH, corner[1] + legend.height() + 4.0, &label)
}

/// Scales over all data and error bars, with margins for the labels of the ticks.
fn area_of(plot: &Plot) -> (Area, Ticks, Ticks) {
    let bottom = TOP + BOX_HEIGHT;
    let shown = |&&(x, y): &&(f64, f64)| {
        let drawn = |v: f64, log: bool| v.is_finite() && (!log || v > 0.0);
        drawn(x, plot.x.log) && drawn(y, plot.y.log)
    };
    let points = || plot.series.iter().flat_map(|series| &series.points).filter(shown);
    let bars = plot.series.iter().flat_map(|series| {
        let pairs = series.points.iter().zip(&series.error_bars);
        pairs.flat_map(|(point, bar)| [point.1 - bar, point.1 + bar])
    });
    let heights = points().map(|point| point.1).chain(bars);
    let y = Scale::covering(heights, plot.y.log, bottom, TOP);
    let y_ticks = y.ticks();
    let widest = y_ticks.major.iter().map(|t| text_width(&t.label, 12.0)).fold(0.0, f64::max);
    let left = (widest + 38.0).clamp(52.0, 150.0);
    let right = WIDTH - RIGHT;
    let x = Scale::covering(points().map(|point| point.0), plot.x.log, left, right);
    let x_ticks = x.ticks();
    (Area { x, y, left, right, top: TOP, bottom }, x_ticks, y_ticks)
}

fn axes(canvas: &mut Canvas, plot: &Plot, area: &Area, x_ticks: &Ticks, y_ticks: &Ticks) {
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
    let middle = [0.5 * (left + right), 0.5 * (top + bottom)];
    let title = axis_title(&plot.x, x_ticks);
    canvas.text("", [middle[0], bottom + 37.0], Anchor::Middle, &title);
    canvas.upright_text([14.0, middle[1]], &axis_title(&plot.y, y_ticks));
}

fn curve(canvas: &mut Canvas, area: &Area, index: usize, series: &Series) {
    let colour = index % COLOURS;
    error_bars(canvas, area, colour, series);
    if series.style != SeriesStyle::Points {
        // A point that cannot be drawn interrupts the line.
        let mut commands = String::new();
        for run in series.points.split(|&point| area.place(point).is_none()) {
            let run: Vec<[f64; 2]> = run.iter().filter_map(|&point| area.place(point)).collect();
            commands += &polyline(&run, false);
        }
        canvas.path(&format!("line s{colour}"), &commands, line_dash(index, series));
    }
    if series.style != SeriesStyle::Line {
        let marks: String = series
            .points
            .iter()
            .filter_map(|&point| area.place(point))
            .map(|at| marker(index, at))
            .collect();
        canvas.path(&format!("mark s{colour}"), &marks, "");
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
    let colour = index % COLOURS;
    if series.style != SeriesStyle::Points {
        let class = format!("line s{colour}");
        canvas.path(&class, &polyline(&[from, to], false), line_dash(index, series));
    }
    if series.style != SeriesStyle::Line {
        let middle = [0.5 * (from[0] + to[0]), from[1]];
        canvas.path(&format!("mark s{colour}"), &marker(index, middle), "");
    }
}
