//! Figures as small SVG texts whose colours follow the page, light or dark.

mod area;
mod axis;
mod canvas;
mod drawing;
mod legend;
mod panels;
mod plot;
mod scale;
mod slope;

pub use canvas::escape;
pub(crate) use panels::parts;

use crate::study::Figure;

/// Colours and line widths of all figures; a page includes it once. The
/// palette is Okabe and Ito's (2008), shaded for contrast on either ground; bands have viridis.
pub const STYLE: &str = include_str!("figure.css");

/// A figure to be placed inside a page that includes [`STYLE`].
pub fn to_svg(figure: &Figure) -> String {
    match figure {
        Figure::Plot(plot) => plot::to_svg(plot),
        Figure::Drawing(drawing) => drawing::to_svg(drawing),
        Figure::Panels(panels) => panels::to_svg(panels),
    }
}

/// A figure as a file of its own, with its style inside.
pub fn to_svg_file(figure: &Figure) -> String {
    let svg = to_svg(figure);
    let inside = svg.find('>').map_or(0, |end| end + 1);
    format!("{}<style>{STYLE}</style>{}", &svg[..inside], &svg[inside..])
}

#[cfg(test)]
mod tests;
