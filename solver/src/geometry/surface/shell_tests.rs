//! Surfaces of several shells.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::{GeometryError, Mended, Surface, SurfaceNote};

/// A box from `from` to `to`, with all its triangles turned inwards or not.
type Part = ([f64; 3], [f64; 3], bool);
type Soup = (Vec<Vector3>, Vec<[u32; 3]>);

fn soup(parts: &[Part]) -> Soup {
    const FACES: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for (from, to, inwards) in parts {
        let base = vertices.len() as u32;
        let corner =
            |n: usize| Vector3::from_fn(|k, _| if n >> k & 1 == 1 { to[k] } else { from[k] });
        vertices.extend((0..8).map(corner));
        for [a, b, c, d] in FACES.map(|face| face.map(|v| base + v)) {
            let halves = [[a, b, c], [a, c, d]];
            triangles.extend(halves.map(|[a, b, c]| if *inwards { [a, c, b] } else { [a, b, c] }));
        }
    }
    (vertices, triangles)
}

fn mended(parts: &[Part]) -> Result<Mended, GeometryError> {
    let (vertices, triangles) = soup(parts);
    Surface::mended(vertices, triangles)
}

fn surface(parts: &[Part]) -> Result<Surface, GeometryError> {
    let (vertices, triangles) = soup(parts);
    Surface::new(vertices, triangles)
}

fn cube(low: f64, high: f64, inwards: bool) -> Part {
    ([low; 3], [high; 3], inwards)
}

/// The volume \[m³\] of parts that need one change, and that change.
fn volume_and_note(parts: &[Part]) -> (f64, SurfaceNote) {
    let Mended { surfaces, mut notes } = mended(parts).unwrap();
    assert_eq!((surfaces.len(), notes.len()), (1, 1), "{notes:?}");
    (surfaces[0].volume(), notes.remove(0))
}

#[test]
fn a_cavity_and_a_body_in_it_count_once() {
    let nested = [cube(0.0, 1.0, false), cube(0.1, 0.9, true), cube(0.2, 0.8, false)];
    let Mended { surfaces, notes } = mended(&nested).unwrap();
    assert!(notes.is_empty(), "{notes:?}");
    let volume = surfaces[0].volume();
    assert!((volume - (1.0 - 0.512 + 0.216)).abs() < 1e-12, "{volume}");
}

#[test]
fn a_shell_in_a_shell_that_faces_the_same_way_is_left_out() {
    for inwards in [false, true] {
        let parts = [cube(0.2, 0.8, inwards), cube(0.0, 1.0, inwards)];
        let Mended { surfaces, notes } = mended(&parts).unwrap();
        assert!((surfaces[0].volume() - 1.0).abs() < 1e-12);
        let expected = SurfaceNote::Inside { inner: 2, outer: 1, count: 2, at: [0.2; 3] };
        assert_eq!(notes.last(), Some(&expected));
        assert_eq!(notes.len(), if inwards { 2 } else { 1 }, "{notes:?}");
    }
}

#[test]
fn a_surface_that_faces_inwards_is_turned_with_its_cavities() {
    let (volume, note) = volume_and_note(&[cube(0.0, 1.0, true), cube(0.2, 0.8, false)]);
    assert!((volume - (1.0 - 0.216)).abs() < 1e-12, "{volume}");
    assert_eq!(note, SurfaceNote::Turned { shell: 1, with: 1, count: 2, at: [0.0; 3] });
}

#[test]
fn a_shell_that_faces_inwards_is_turned_unless_it_is_a_cavity() {
    let (volume, _) = volume_and_note(&[cube(0.0, 1.0, false), cube(2.0, 2.5, true)]);
    assert!((volume - 1.125).abs() < 1e-12, "{volume}");
    let in_a_cavity = [cube(0.0, 1.0, false), cube(0.1, 0.9, true), cube(0.2, 0.8, true)];
    let (volume, _) = volume_and_note(&in_a_cavity);
    assert!((volume - (1.0 - 0.512 + 0.216)).abs() < 1e-12, "{volume}");
}

#[test]
fn repeated_triangles_and_shells_count_once() {
    let (volume, note) = volume_and_note(&[cube(0.0, 1.0, false), cube(0.0, 1.0, false)]);
    assert!((volume - 1.0).abs() < 1e-12, "{volume}");
    assert_eq!(note, SurfaceNote::Repeated { triangles: 12, at: [0.0; 3] });
}

#[test]
fn triangles_that_are_there_in_both_directions_enclose_nothing() {
    let error = surface(&[cube(0.0, 1.0, false), cube(0.0, 1.0, true)]).unwrap_err();
    assert_eq!(error, GeometryError::SurfaceFlat);
}

#[test]
fn boxes_that_share_an_edge_or_a_face_are_closed() {
    let at_an_edge = ([1.0, 1.0, 0.0], [2.0, 2.0, 1.0], false);
    let at_a_corner = ([1.0; 3], [2.0; 3], false);
    let at_a_face = ([1.0, 0.0, 0.0], [2.0, 1.0, 1.0], false);
    for second in [at_an_edge, at_a_corner, at_a_face] {
        let surface = surface(&[cube(0.0, 1.0, false), second]).unwrap();
        assert!((surface.volume() - 2.0).abs() < 1e-12);
        for (X, expected) in [([0.5; 3], -0.5), ([0.9, 0.5, 0.5], -0.1), ([0.5, 1.2, 0.5], 0.2)] {
            let found = surface.signed_distance(&Vector3::from(X));
            let merged = second == at_a_face && X[0] == 0.9;
            assert!((found - if merged { -0.5 } else { expected }).abs() < 1e-12, "{X:?} {found}");
        }
    }
}

#[test]
fn shells_that_cross_are_several_solids_of_a_union() {
    let corners = [cube(0.0, 1.0, false), cube(0.5, 1.5, false)];
    let shifted = [cube(0.0, 1.0, false), ([0.5, 0.0, 0.0], [1.5, 1.0, 1.0], false)];
    let bars =
        [([0.0, 0.4, 0.4], [1.0, 0.6, 0.6], false), ([0.3, 0.0, 0.45], [0.6, 1.0, 0.5], false)];
    let sticks =
        [([0.0, 0.4, 0.4], [1.0, 0.6, 0.6], false), ([0.3, 0.0, 0.3], [0.6, 0.5, 0.5], false)];
    for parts in [corners, shifted, bars, sticks] {
        let Mended { surfaces, notes } = mended(&parts).unwrap();
        assert_eq!(surfaces.len(), 2);
        assert!(
            matches!(notes[..], [SurfaceNote::United { first: 1, second: 2, .. }]),
            "{notes:?}"
        );
        let error = surface(&parts).unwrap_err();
        assert!(matches!(error, GeometryError::ShellsCross { .. }), "{error}");
    }
}

#[test]
fn a_cavity_goes_with_the_body_around_it_where_that_crosses_another() {
    let parts = [cube(0.0, 1.0, false), cube(0.1, 0.4, true), cube(0.5, 1.5, false)];
    let Mended { surfaces, .. } = mended(&parts).unwrap();
    let volumes: Vec<f64> = surfaces.iter().map(Surface::volume).collect();
    assert!((volumes[0] - 0.973).abs() < 1e-12 && (volumes[1] - 1.0).abs() < 1e-12, "{volumes:?}");
}

#[test]
fn a_shell_that_faces_inwards_and_crosses_one_that_does_not_is_refused() {
    let error = surface(&[cube(0.0, 1.0, false), cube(0.5, 1.5, true)]).unwrap_err();
    assert!(
        matches!(error, GeometryError::CavityCrosses { first: 1, second: 2, count: 2, .. }),
        "{error}"
    );
}

#[test]
fn shells_that_touch_are_no_overlap() {
    let on_top = ([0.3, 0.2, 1.0], [0.6, 0.7, 1.5], false);
    let flush = ([1.0, 0.0, 0.0], [1.5, 0.5, 0.5], false);
    let at_a_corner = ([1.0; 3], [1.5; 3], false);
    for second in [on_top, flush, at_a_corner] {
        let expected = 1.0 + (0..3).map(|k| second.1[k] - second.0[k]).product::<f64>();
        let volume = surface(&[cube(0.0, 1.0, false), second]).unwrap().volume();
        assert!((volume - expected).abs() < 1e-12, "{volume} {expected}");
    }
}

/// What a message says of a cube whose triangles were changed.
fn refused(change: impl Fn(&mut Soup)) -> String {
    let mut cube = soup(&[cube(0.0, 1.0, false)]);
    change(&mut cube);
    Surface::new(cube.0, cube.1).unwrap_err().to_string()
}

#[test]
fn holes_turned_triangles_and_inner_walls_are_told_apart() {
    let hole = refused(|(_, triangles)| triangles.truncate(triangles.len() - 1));
    assert!(hole.contains("3 edges have one triangle only"), "{hole}");
    let turned = refused(|(_, triangles)| triangles[0].swap(0, 1));
    assert!(turned.contains("3 edges lie between triangles of which one faces"), "{turned}");
    let wall = refused(|(vertices, triangles)| {
        vertices.push(Vector3::repeat(0.5));
        triangles.push([triangles[0][0], triangles[0][1], 8]);
    });
    assert!(wall.contains("2 edges have one triangle only"), "{wall}");
    assert!(wall.contains("1 edges have three or more triangles"), "{wall}");
}
