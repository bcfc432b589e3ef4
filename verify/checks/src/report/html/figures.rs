//! Figures as values of a template.

use super::super::svg;
use crate::study::{Figure, Report};
use minijinja::{Value, context};

/// The figures that lead the page, in the order of their studies.
pub(super) fn leading_figures(report: &Report) -> impl Iterator<Item = &Figure> {
    report.studies.iter().flat_map(|study| study.figures.iter().take(study.leading))
}

/// A figure with its heading and its picture, or with the pictures of its panels.
pub(super) fn figure_value(figure: &Figure) -> Value {
    let picture = |svg: String| Value::from_safe_string(svg);
    let (mut svg, mut panels, mut legend, mut kind) = (None, Vec::new(), None, "drawings");
    if let Figure::Panels(shown) = figure {
        let parts = svg::parts(shown);
        if parts.plots {
            kind = "plots";
        }
        legend = parts.legend.map(picture);
        panels = (parts.panels.into_iter())
            .map(|(title, svg)| context! { title, svg => picture(svg) })
            .collect();
    } else {
        svg = Some(picture(svg::to_svg(figure)));
    }
    context! { title => figure.title(), caption => figure.caption(), svg, panels, legend, kind }
}
