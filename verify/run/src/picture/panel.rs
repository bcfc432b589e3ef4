//! The panels of a picture: the body before, after and cut open.
#![allow(non_snake_case)]

use super::body::{Body, Field};
use super::camera::{Camera, Direction};
use super::colours::{Colour, of_region, viridis};
use super::pixels::{Pixels, Window, draw};
use super::scale::Scale;
use super::surface::{Triangle, triangles};
use crate::display::{Mesh, Parents, cut_away};
use anyhow::Result;
use mtled::algebra::tensor::Vector3;
use rayon::prelude::*;

/// Pixels of a panel.
const WIDTH: usize = 480;
const MOST_HEIGHT: f64 = 520.0;
const LEAST_HEIGHT: f64 = 160.0;
/// Part of a panel that stays empty on each side \[–\].
const MARGIN: f64 = 0.03;

/// Colours that are told apart.
const SHADES: usize = 512;

/// What a panel shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// The body before, its regions in their colours.
    Before,
    /// The body after, coloured by the field, with the outline before.
    After,
    /// The body after without the half that stands in front of its middle.
    Cut,
}

impl Shown {
    /// What is shown unless it is chosen: a body in space cut open too.
    pub fn usual(mesh: &Mesh) -> Vec<Shown> {
        let mut shown = vec![Shown::Before, Shown::After];
        shown.extend((mesh.corners == 4).then_some(Shown::Cut));
        shown
    }
}

/// What is drawn, and from where.
#[derive(Debug, Clone)]
pub struct Choice {
    /// Where the viewer stands; the usual place if none is chosen.
    pub direction: Option<Direction>,
    /// The panels, from the left.
    pub shown: Vec<Shown>,
}

/// A picture with its title.
#[derive(Debug, Clone)]
pub struct Panel {
    pub title: String,
    /// Width and height \[pixel\].
    pub size: [usize; 2],
    pub png: Vec<u8>,
    /// Length of a pixel \[m\].
    pub pixel: f64,
}

/// A mesh where it is drawn, with the field.
struct Drawn {
    shown: Shown,
    title: String,
    triangles: Vec<Triangle>,
}

/// The panels of a body with one of its fields, at one scale, and what their colours mean.
pub fn panels(body: &Body, field: &Field, choice: &Choice) -> Result<(Vec<Panel>, Scale)> {
    let plane = body.mesh.corners == 3;
    let usual = if plane { Direction::above() } else { Direction::oblique() };
    let camera = Camera::new(choice.direction.unwrap_or(usual));
    let values = field.scalars();
    let scale = Scale::of(field, &values);
    let (X, u) = (&body.mesh.vertices, body.displacement());
    let moved: Vec<Vector3> = X.iter().zip(&u).map(|(X, u)| X + u).collect();
    let before = triangles(&body.mesh, X, &values);
    let drawn = |&shown: &Shown| match shown {
        // Drawn for the outline in all panels anyhow.
        Shown::Before => Drawn { shown, title: "Before".into(), triangles: Vec::new() },
        Shown::After => Drawn {
            shown,
            title: "After".into(),
            triangles: triangles(&body.mesh, &moved, &values),
        },
        Shown::Cut => cut_open(body, &camera, &moved, &values),
    };
    let drawn: Vec<Drawn> = choice.shown.par_iter().map(drawn).collect();
    let window = window(drawn.iter().map(|drawn| &drawn.triangles).chain([&before]), &camera);
    let regions = body.mesh.regions.iter().max().map_or(1, |last| usize::from(*last) + 1);
    let plain = |_: f64, region: u16| of_region(region, regions);
    let shades: Vec<Colour> = (0..=SHADES).map(|n| viridis(n as f64 / SHADES as f64)).collect();
    let coloured = |value: f64, _: u16| -> Colour {
        shades[(scale.fraction(value).clamp(0.0, 1.0) * SHADES as f64) as usize]
    };
    let outline = draw(&before, &camera, &window, plain);
    let panel = |drawn: &Drawn| -> Result<Panel> {
        let pixels: Pixels = match drawn.shown {
            Shown::Before => outline.clone(),
            Shown::After | Shown::Cut => {
                let mut pixels = draw(&drawn.triangles, &camera, &window, coloured);
                pixels.outline(&outline);
                pixels
            }
        };
        let (title, size) = (drawn.title.clone(), window.size);
        Ok(Panel { title, size, png: pixels.png()?, pixel: window.pixel })
    };
    let panels: Result<Vec<Panel>> = drawn.par_iter().map(panel).collect();
    Ok((panels?, scale))
}

/// The part of a body behind its middle, cut where it was before, drawn where it is now.
fn cut_open(body: &Body, camera: &Camera, moved: &[Vector3], values: &[f64]) -> Drawn {
    let axis = camera.towards.iamax();
    let front = camera.towards[axis].signum();
    let all = body.mesh.vertices.iter().map(|X| X[axis]);
    let (low, high) =
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    // Beside the middle, where vertices may lie in the plane.
    let middle = low + 0.5003 * (high - low);
    let level = |X: &Vector3| front * (X[axis] - middle);
    let levels: Vec<f64> = body.mesh.vertices.iter().map(level).collect();
    let (cut, parents): (Mesh, Vec<Parents>) = cut_away(&body.mesh, &levels, &level);
    let places: Vec<Vector3> = (parents.iter())
        .map(|p| {
            let [a, b] = [p.from, p.to].map(|n| moved[n as usize]);
            a + (b - a) * p.t
        })
        .collect();
    let values: Vec<f64> = (parents.iter())
        .map(|p| {
            let [a, b] = [p.from, p.to].map(|n| values[n as usize]);
            a + (b - a) * p.t
        })
        .collect();
    let name = ["x", "y", "z"][axis];
    let title = format!("After, cut at {name} = {} m", short(middle, high - low));
    Drawn { shown: Shown::Cut, title, triangles: triangles(&cut, &places, &values) }
}

/// To about a hundredth of an extent.
fn short(value: f64, extent: f64) -> String {
    let digits = (2.0 - extent.max(1e-300).log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{:.digits$}", value.abs());
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text.as_str()
    };
    if value < 0.0 && text != "0" { format!("−{text}") } else { text.to_string() }
}

/// The window that all of it is seen in.
fn window<'a>(parts: impl Iterator<Item = &'a Vec<Triangle>>, camera: &Camera) -> Window {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for corner in parts.flatten().flat_map(|triangle| &triangle.corners) {
        let seen = camera.seen(&corner.at);
        for k in 0..2 {
            (low[k], high[k]) = (low[k].min(seen[k]), high[k].max(seen[k]));
        }
    }
    if !(low[0] <= high[0] && low[1] <= high[1]) {
        (low, high) = ([0.0; 2], [1.0; 2]);
    }
    let usable = 1.0 - 2.0 * MARGIN;
    let extent = [high[0] - low[0], high[1] - low[1]];
    let pixel = (extent[0] / (usable * WIDTH as f64)).max(extent[1] / (usable * MOST_HEIGHT));
    let pixel = if pixel > 0.0 && pixel.is_finite() { pixel } else { 1.0 };
    let height = (extent[1] / pixel / usable).clamp(LEAST_HEIGHT, MOST_HEIGHT).ceil() as usize;
    let middle = [0, 1].map(|k| 0.5 * (low[k] + high[k]));
    Window { middle, pixel, size: [WIDTH, height] }
}
