//! Small figures side by side.

use super::canvas::{Anchor, Canvas};
use super::{drawing, plot};
use crate::study::{Figure, Panels, Plot};

/// Panels in a row of a picture of its own.
const COLUMNS: usize = 4;
const GAP: f64 = 14.0;
const TITLE: f64 = 20.0;

/// The pictures that panels consist of.
pub(crate) struct PanelParts {
    /// Whether they are plots, which are smaller than drawings.
    pub plots: bool,
    /// Of all panels, where they share one.
    pub legend: Option<String>,
    /// Title and picture of each panel.
    pub panels: Vec<(String, String)>,
}

/// The pictures of panels, to be arranged by a page.
pub(crate) fn parts(panels: &Panels) -> PanelParts {
    let plots: Vec<&Plot> = panels.panels.iter().filter_map(plot_of).collect();
    let picture = |figure: &Figure| match figure {
        Figure::Plot(plot) => plot::sized(plot, &plots, &plot::SMALL),
        Figure::Drawing(drawing) => drawing::to_svg(drawing),
        Figure::Panels(nested) => to_svg(nested),
    };
    let panel = |figure: &Figure| (figure.title().to_string(), picture(figure));
    PanelParts {
        plots: plots.len() == panels.panels.len(),
        legend: plots.first().and_then(|plot| plot::legend_alone(plot, 620.0)),
        panels: panels.panels.iter().map(panel).collect(),
    }
}

fn plot_of(figure: &Figure) -> Option<&Plot> {
    match figure {
        Figure::Plot(plot) => Some(plot),
        _ => None,
    }
}

/// All panels and their legend in one picture.
pub(super) fn to_svg(panels: &Panels) -> String {
    let parts = parts(panels);
    let mut canvas = Canvas::default();
    let columns = COLUMNS.min(parts.panels.len()).max(1);
    let (mut width, mut y) = (0.0f64, 0.0);
    for row in parts.panels.chunks(columns) {
        let (mut x, mut tallest) = (0.0, 0.0f64);
        for (title, picture) in row {
            let size = size_of(picture);
            canvas.text("", [x + 4.0, y + 14.0], Anchor::Start, title);
            canvas.picture([x, y + TITLE], size, picture);
            x += size[0] + GAP;
            tallest = tallest.max(size[1]);
        }
        width = width.max(x - GAP);
        y += TITLE + tallest + GAP;
    }
    if let Some(legend) = &parts.legend {
        let size = size_of(legend);
        canvas.picture([0.0, y], size, legend);
        (width, y) = (width.max(size[0]), y + size[1]);
    }
    canvas.finish(width, y, &panels.title)
}

/// Width and height of the view box of a picture.
fn size_of(svg: &str) -> [f64; 2] {
    let numbers = svg.split_once("viewBox=\"0 0 ").and_then(|(_, rest)| rest.split_once('"'));
    let mut numbers = numbers.map_or("", |(numbers, _)| numbers).split(' ').map(str::parse);
    [(); 2].map(|()| numbers.next().and_then(Result::ok).unwrap_or(0.0))
}
