#![allow(non_snake_case)]

use super::camera::{Camera, Direction};
use super::scale::Scale;
use super::{Body, Choice, Field, Shown, panels, picture_svg};
use crate::display::Mesh;
use mtled::algebra::tensor::Vector3;

/// A tetrahedron that has moved to the right by a length \[m\].
fn moved(by: f64) -> Body {
    let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mesh = Mesh {
        corners: 4,
        vertices: vertices.map(Vector3::from).to_vec(),
        cells: vec![0, 1, 2, 3],
        regions: vec![0],
    };
    let displacement =
        Field { name: "displacement".into(), components: 3, values: [by, 0.0, 0.0].repeat(4) };
    Body { mesh, fields: vec![displacement] }
}

fn choice(shown: &[Shown]) -> Choice {
    Choice { direction: None, shown: shown.to_vec() }
}

#[test]
fn a_picture_has_its_panels_their_titles_and_a_bar_with_its_unit() {
    let body = moved(2e-3);
    let shown = choice(&[Shown::Before, Shown::After, Shown::Cut]);
    let (parts, scale) = panels(&body, &body.fields[0], &shown).unwrap();
    let svg = picture_svg(&parts, &scale, "a body");
    assert_eq!(svg.matches("<image ").count(), 3);
    for text in ["Before", "After", "After, cut at y =", "displacement [mm]"] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(parts.iter().all(|panel| panel.png.starts_with(b"\x89PNG")));
    assert_eq!(svg, {
        let (parts, scale) = panels(&body, &body.fields[0], &shown).unwrap();
        picture_svg(&parts, &scale, "a body")
    });
}

#[test]
fn what_is_nearer_hides_what_is_behind() {
    use super::pixels::{Window, draw};
    use super::surface::triangles;
    let corners = |z: f64| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]].map(Vector3::from);
    let vertices = [corners(1.0), corners(0.0)].concat();
    let mesh = Mesh {
        corners: 3,
        vertices: vertices.clone(),
        cells: (0..6).collect(),
        regions: vec![0; 2],
    };
    let values = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
    let drawn = triangles(&mesh, &vertices, &values);
    let window = Window { middle: [0.5, 0.5], pixel: 0.1, size: [10, 10] };
    let camera = Camera::new(Direction::above());
    let pixels = draw(&drawn, &camera, &window, |value, _| [value, 0.0, 1.0 - value]);
    let at = |column: usize, row: usize| &pixels.bytes[4 * (10 * row + column)..][..4];
    // Lower left is inside, upper right outside of both triangles.
    assert!(at(1, 8)[0] > 100 && at(1, 8)[2] == 0 && at(1, 8)[3] == 255, "{:?}", at(1, 8));
    assert_eq!(at(8, 1)[3], 0);
}

#[test]
fn a_scale_has_round_ticks_between_its_ends_in_a_unit_with_a_prefix() {
    let field = |name: &str| Field { name: name.into(), components: 1, values: Vec::new() };
    let scale = Scale::of(&field("displacement"), &[0.0, 0.0042]);
    assert_eq!((scale.unit.as_str(), scale.low, scale.high), ("mm", 0.0, 0.0042));
    assert_eq!(scale.ticks(), [0.0, 1.0, 2.0, 3.0, 4.0]);
    let scale = Scale::of(&field("pressure"), &[-2500.0, 1200.0]);
    assert_eq!((scale.unit.as_str(), scale.factor), ("kPa", 1e-3));
    assert!(scale.ticks().iter().all(|tick| (-2.5..=1.2).contains(tick)));
    for values in [&[][..], &[0.0], &[1.0, 1.0], &[f64::NAN]] {
        let scale = Scale::of(&field("J"), values);
        assert!(scale.high > scale.low && !scale.ticks().is_empty(), "{values:?}");
    }
}
