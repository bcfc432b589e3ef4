//! Drawings of a cut through a body of a label map, before and after.

use crate::studies::comparison::cut::{Cut, Plane, Through};
use anyhow::{Context, Result};
use mtled::geometry::{LabelField, Selector, Shape};
use mtled::problem::Dimension;
use mtled_case::scene::Case;
use mtled_checks::study::{ColourScale, Drawing, Figure, Layer, LayerStyle, Panels};
use mtled_run::run::{Solved, StoredField};
use mtled_run::warp::DisplacementField;

type Lines = Vec<Vec<[f64; 2]>>;

/// Colours of the palette.
const BODY: usize = 5;
const PARTS: [usize; 3] = [0, 1, 3];
const SKULL: usize = 6;
const OPENING: usize = 3;
const LEVEL: usize = 2;

/// Bands of displacement, at most.
const BANDS: f64 = 10.0;

/// What all drawings of a case share.
struct Shown<'a> {
    case: &'a Case,
    cut: Cut,
    body: &'a Shape,
    /// The parts of the body that have a label, with their names.
    parts: Vec<(String, Shape)>,
    /// Obstacles and the plane's reason, under and above everything.
    around: Vec<Layer>,
}

/// The cut of a case in space whose body is a label map: labels before and after, and the
/// displacement; None for other cases.
pub(crate) fn cut_panels(case: &Case, solved: &Solved) -> Result<Option<Panels>> {
    let (Shape::Labels(labels), Dimension::Three) = (&case.problem.body, &case.problem.dimension)
    else {
        return Ok(None);
    };
    let Some((plane, through)) = Plane::of(&case.problem) else { return Ok(None) };
    let stored =
        StoredField::new(case, &solved.simulation, &solved.simulation.state.displacement, false);
    let field = DisplacementField::new(&stored, &case.problem, None)?;
    let reach = case.problem.obstacles.first().map_or(field.largest_displacement, |o| o.offset);
    let cut = Cut::new(&field, &case.problem.body, plane, reach, labels.voxel());
    let cut = cut.context("the body has no bounds")?;
    let parts = parts(case, labels.smoothing())?;
    let around = around(case, &cut, &through);
    let shown = Shown { case, cut, body: &case.problem.body, parts, around };
    let (normal, last) = match through {
        Through::Patch(_) => {
            ("the craniotomy", "dashed on it: the craniotomy, where the surface is displaced")
        }
        Through::Level(_) => ("the level of the fluid", "straight: the level of the fluid"),
    };
    Ok(Some(Panels {
        title: format!("{}: label map and displacement", case.title),
        caption: format!(
            "{}, {} nodes: the vertical plane along the normal of {normal}, the right and the front \
             of the head on the right. After: each point of the plane has the label of the place \
             where it came from; dashed: outlines before. Outside: the skull; {last}.",
            case.name,
            solved.simulation.discretisation.cloud.positions.len(),
        ),
        panels: [shown.before(), shown.after(), shown.displacement()].map(Figure::Drawing).to_vec(),
    }))
}

/// The regions that are labels.
fn parts(case: &Case, smoothing: f64) -> Result<Vec<(String, Shape)>> {
    let labelled = case.problem.regions.iter().filter_map(|region| match &region.part {
        Selector::Label { map, label } => Some((region.name.clone(), map.clone(), *label)),
        _ => None,
    });
    let part = |(name, map, label)| {
        let field = LabelField::new(map, &[label], smoothing)?;
        Ok((name, Shape::Labels(field.into())))
    };
    labelled.take(PARTS.len()).map(part).collect()
}

/// Outlines of the obstacles, and what the plane was laid through.
fn around(case: &Case, cut: &Cut, through: &Through) -> Vec<Layer> {
    let mut layers = Vec::new();
    for obstacle in &case.problem.obstacles {
        let lines = cut.before(&obstacle.shape, obstacle.offset);
        match through {
            Through::Patch(patch) => {
                let (open, closed) = split(&lines, |[a, b]| patch.contains(&cut.point(a, b)));
                layers.push(layer(&obstacle.name, LayerStyle::Outline, SKULL, closed));
                layers.push(layer("craniotomy", LayerStyle::Dashed, OPENING, open));
            }
            Through::Level(_) => {
                layers.push(layer(&obstacle.name, LayerStyle::Outline, SKULL, lines));
            }
        }
    }
    if let Through::Level(level) = through {
        let outline = case.problem.obstacles.first();
        let lines = outline.map_or(Vec::new(), |o| cut.before(&o.shape, o.offset));
        layers.push(layer(
            "level of the fluid",
            LayerStyle::Outline,
            LEVEL,
            chord(&lines, cut, level),
        ));
    }
    layers
}

/// Pieces of closed lines inside and outside of a part, NaN between pieces.
fn split(lines: &Lines, inside: impl Fn([f64; 2]) -> bool) -> (Lines, Lines) {
    let of = |wanted: bool| {
        let closed = |line: &Vec<[f64; 2]>| -> Vec<[f64; 2]> {
            let all = line.iter().chain(line.first());
            all.map(|&p| if inside(p) == wanted { p } else { [f64::NAN; 2] }).collect()
        };
        lines.iter().map(closed).collect()
    };
    (of(true), of(false))
}

/// Where closed lines cross a level, joined.
fn chord(lines: &Lines, cut: &Cut, level: &Shape) -> Lines {
    let height = |p: &[f64; 2]| level.signed_distance(&cut.point(p[0], p[1]));
    let mut ends = Vec::new();
    for line in lines {
        for (p, q) in line.iter().zip(line.iter().cycle().skip(1)) {
            let (a, b) = (height(p), height(q));
            if (a < 0.0) != (b < 0.0) {
                let t = a / (a - b);
                ends.push([0, 1].map(|k| p[k] + t * (q[k] - p[k])));
            }
        }
    }
    ends.sort_by(|p, q| p[0].total_cmp(&q[0]));
    vec![ends]
}

/// A layer of lines \[m\].
fn layer(name: &str, style: LayerStyle, colour: usize, lines: Lines) -> Layer {
    let millimetres = |line: Vec<[f64; 2]>| line.iter().map(|p| p.map(|x| 1e3 * x)).collect();
    Layer {
        name: name.into(),
        style,
        colour,
        closed: matches!(style, LayerStyle::Filled | LayerStyle::Band),
        lines: lines.into_iter().map(millimetres).collect(),
    }
}

/// Closed lines as they are drawn.
fn closed(layer: Layer) -> Layer {
    Layer { closed: true, ..layer }
}

impl Shown<'_> {
    fn drawing(&self, title: &str, mut layers: Vec<Layer>, scale: Option<ColourScale>) -> Drawing {
        // What is around comes first, so that lines above bands are those of the body.
        let around = self.around.iter().cloned();
        layers.splice(0..0, around);
        Drawing {
            title: title.into(),
            caption: format!("{}: {title}", self.case.title),
            unit: "mm".into(),
            layers,
            scale,
        }
    }

    fn before(&self) -> Drawing {
        self.labels("Before", |shape| self.cut.before(shape, 0.0))
    }

    fn after(&self) -> Drawing {
        let mut drawing = self.labels("After", |shape| self.cut.after(shape));
        let shapes = [self.body].into_iter().chain(self.parts.iter().map(|(_, shape)| shape));
        let before = shapes.flat_map(|shape| self.cut.before(shape, 0.0)).collect();
        drawing.layers.push(closed(layer("before", LayerStyle::Dashed, SKULL, before)));
        drawing
    }

    /// The body and its parts, filled.
    fn labels(&self, title: &str, outlines: impl Fn(&Shape) -> Lines) -> Drawing {
        let all = self.case.problem.regions.iter().find(|r| matches!(r.part, Selector::All));
        let name = all.map_or("body", |region| region.name.as_str());
        let mut layers = vec![layer(name, LayerStyle::Filled, BODY, outlines(self.body))];
        for ((name, shape), colour) in self.parts.iter().zip(PARTS) {
            layers.push(layer(name, LayerStyle::Filled, colour, outlines(shape)));
        }
        self.drawing(title, layers, None)
    }

    fn displacement(&self) -> Drawing {
        let edges = bands(1e3 * self.cut.largest_displacement(self.body));
        let lower: Vec<f64> = edges[..edges.len() - 1].iter().map(|edge| 1e-3 * edge).collect();
        let outlines = self.cut.moved(self.body, &lower);
        let mut layers: Vec<Layer> = (outlines.into_iter().enumerate())
            .map(|(band, lines)| layer("", LayerStyle::Band, band, lines))
            .collect();
        let parts = self.parts.iter().flat_map(|(_, shape)| self.cut.after(shape)).collect();
        let names: Vec<&str> = self.parts.iter().map(|(name, _)| name.as_str()).collect();
        layers.push(closed(layer(&names.join(", "), LayerStyle::Outline, SKULL, parts)));
        let scale = ColourScale { label: "displacement".into(), unit: "mm".into(), edges };
        self.drawing("After: displacement", layers, Some(scale))
    }
}

/// Round ends of at most [`BANDS`] bands from 0 to `largest`.
fn bands(largest: f64) -> Vec<f64> {
    let rough = (largest / BANDS).max(f64::MIN_POSITIVE);
    let power = 10f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 2.5, 5.0, 10.0].map(|factor| factor * power);
    let step = steps.into_iter().find(|step| *step >= rough).unwrap_or(rough);
    let count = (largest / step).ceil().clamp(1.0, BANDS) as usize;
    (0..=count).map(|n| n as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_of_displacement_are_round_and_at_most_ten() {
        assert_eq!(bands(9.7), (0..=10).map(f64::from).collect::<Vec<_>>());
        assert_eq!(bands(10.0).len(), 11);
        let edges = bands(3.1);
        assert!(edges.len() <= 11 && edges[1] == 0.5 && *edges.last().unwrap() >= 3.1);
        assert_eq!(bands(0.0).len(), 2);
    }

    #[test]
    fn a_closed_line_is_split_where_it_leaves_a_part() {
        let square = vec![vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];
        let (right, left) = split(&square, |[a, _]| a > 0.5);
        let drawn = |lines: &Lines| lines[0].iter().filter(|p| p[0].is_finite()).count();
        assert_eq!((drawn(&right), drawn(&left)), (2, 3));
    }
}
