#![allow(non_snake_case)]

use super::body::body_mesh;
use super::mesh::Mesh;
use super::regions::into_regions;
use crate::specimens::simple::tissue;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{DistanceFunction, Selector, Shape};
use mtled::problem::{Dimension, Region};
use std::collections::HashMap;
use std::f64::consts::PI;

const PLANE: Dimension = Dimension::PlaneStrain { thickness: 1.0, z: 0.0 };

/// The mesh of a solid with cells of about `edge` \[m\], sound in itself.
fn meshed(shape: &Shape, edge: f64) -> Mesh {
    let mesh = body_mesh(shape, &Dimension::Three, edge).unwrap();
    assert_sound(&mesh);
    mesh
}

/// Every cell has a positive measure, every side is shared by at most two cells, and the boundary
/// is closed.
fn assert_sound(mesh: &Mesh) {
    assert!(!mesh.is_empty() && mesh.regions.len() == mesh.len());
    let smallest = mesh.iter().map(|cell| mesh.measure(cell)).fold(f64::INFINITY, f64::min);
    assert!(smallest > 0.0, "{smallest}");
    let mut sides: HashMap<Vec<u32>, usize> = HashMap::new();
    for cell in mesh.iter() {
        for left_out in 0..cell.len() {
            let mut side: Vec<u32> = cell.to_vec();
            side.remove(left_out);
            side.sort_unstable();
            *sides.entry(side).or_default() += 1;
        }
    }
    assert!(sides.values().all(|&cells| cells <= 2));
    let boundary = mesh.boundary();
    assert_eq!(boundary.len(), sides.values().filter(|&&cells| cells == 1).count());
    // The ridges of the sides of the boundary: each direction as often as its opposite.
    let mut ridges: HashMap<Vec<u32>, i32> = HashMap::new();
    for (side, _) in &boundary {
        match side[..] {
            [a, b] => {
                *ridges.entry(vec![a]).or_default() += 1;
                *ridges.entry(vec![b]).or_default() -= 1;
            }
            _ => (0..3).for_each(|n| {
                let (a, b) = (side[n], side[(n + 1) % 3]);
                *ridges.entry(vec![a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
            }),
        }
    }
    assert!(ridges.values().all(|&sum| sum == 0));
}

/// The volume that the boundary of a mesh encloses, by the divergence theorem \[m³\].
fn enclosed(mesh: &Mesh) -> f64 {
    let volume = |side: &[u32]| {
        let [a, b, c] = [0, 1, 2].map(|n| mesh.vertices[side[n] as usize]);
        a.cross(&b).dot(&c) / 6.0
    };
    mesh.boundary().iter().map(|(side, _)| volume(side)).sum()
}

fn ball() -> Shape {
    Shape::Sphere { centre: Vector3::new(0.1, -0.2, 0.3), radius: 0.5 }
}

fn torus() -> Shape {
    let reach = Vector3::new(1.3, 1.3, 0.3);
    let distance = |X: &Vector3| (X.x.hypot(X.y) - 1.0).hypot(X.z) - 0.3;
    Shape::Function(DistanceFunction::new(-reach, reach, distance))
}

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Shape {
    Shape::Box { min: low.into(), max: high.into() }
}

fn without(shape: Shape, hole: Shape) -> Shape {
    Shape::Difference(Box::new(shape), Box::new(hole))
}

#[test]
fn the_volume_of_a_ball_and_of_a_torus_converges_with_the_square_of_the_cells() {
    let solids = [(ball(), PI / 6.0), (torus(), 2.0 * PI * PI * 0.09)];
    for (shape, exact) in solids {
        let error = |edge: f64| (meshed(&shape, edge).volume() - exact).abs() / exact;
        let (coarse, fine) = (error(0.1), error(0.05));
        assert!(coarse < 0.05 && fine < 0.33 * coarse, "{coarse} {fine}");
    }
}

#[test]
fn boxes_have_exact_faces_edges_and_corners() {
    let mesh = meshed(&cuboid([0.0, 0.1, -0.2], [1.0, 0.9, 0.05]), 0.07);
    assert!((mesh.volume() - 0.2).abs() < 1e-14, "{}", mesh.volume());
    let corner = Vector3::new(1.0, 0.9, 0.05);
    assert!(mesh.vertices.iter().any(|X| (X - corner).norm() < 1e-14));
}

#[test]
fn the_boundary_encloses_the_cells() {
    let hollow = without(ball(), Shape::Sphere { centre: Vector3::zeros(), radius: 0.1 });
    for shape in [ball(), torus(), hollow] {
        let mesh = meshed(&shape, 0.06);
        assert!((enclosed(&mesh) - mesh.volume()).abs() < 1e-12 * mesh.volume());
    }
}

#[test]
fn edges_that_the_lattice_does_not_know_of_stay_sharp() {
    let notched = without(cuboid([0.0; 3], [1.0; 3]), cuboid([0.43, -1.0, 0.57], [2.0, 2.0, 2.0]));
    let mesh = meshed(&notched, 0.1);
    assert!((mesh.volume() - (1.0 - 0.57 * 0.43)).abs() < 1e-3, "{}", mesh.volume());
    let to_edge = |X: &Vector3| (X.x - 0.43).hypot(X.z - 0.57);
    assert!(mesh.vertices.iter().filter(|X| to_edge(X) < 1e-6).count() > 8);
}

#[test]
fn an_upright_cylinder_has_round_ends() {
    let shape =
        Shape::Cylinder { base: Vector3::zeros(), axis: Vector3::z(), radius: 0.4, height: 1.0 };
    let mesh = meshed(&shape, 0.05);
    let exact = 0.16 * PI;
    assert!((mesh.volume() / exact - 1.0).abs() < 0.005, "{}", mesh.volume() / exact);
    // The whole of its end is flat.
    let corners = |side: &Vec<u32>| [0, 1, 2].map(|n| mesh.vertices[side[n] as usize]);
    let ends = mesh.boundary().into_iter().map(|(side, _)| corners(&side));
    let top = ends.filter(|corners| corners.iter().all(|X| X.z > 1.0 - 1e-9));
    let area: f64 = top.map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum();
    assert!((area / exact - 1.0).abs() < 0.005, "{}", area / exact);
}

#[test]
fn the_end_of_a_cylinder_stays_sharp_in_any_direction() {
    let axis = Vector3::new(1.0, 2.0, -0.7).normalize();
    let shape =
        Shape::Cylinder { base: Vector3::new(0.3, 0.0, 0.0), axis, radius: 0.4, height: 1.0 };
    let mesh = meshed(&shape, 0.08);
    let exact = 0.16 * PI;
    assert!((mesh.volume() / exact - 1.0).abs() < 0.01, "{}", mesh.volume() / exact);
}

#[test]
fn a_box_that_is_turned_in_space_keeps_its_edges() {
    let turn = nalgebra::Rotation3::from_scaled_axis(Vector3::new(0.4, 0.5, -0.3));
    let half = Vector3::new(0.5, 0.4, 0.3);
    let distance = move |X: &Vector3| {
        let q = (turn * X).abs() - half;
        q.sup(&Vector3::zeros()).norm() + q.max().min(0.0)
    };
    let reach = Vector3::repeat(0.8);
    let mesh = meshed(&Shape::Function(DistanceFunction::new(-reach, reach, distance)), 0.05);
    assert!((mesh.volume() / 0.48 - 1.0).abs() < 4e-3, "{}", mesh.volume() / 0.48);
}

#[test]
fn triangles_fill_a_polygon_with_a_hole() {
    let points = vec![[0.0, 0.0], [0.048, 0.044], [0.048, 0.06], [0.0, 0.044]];
    let plate = Shape::Polygon { points: points.into(), z: (-1.0, 1.0) };
    let hole = Shape::Ellipsoid {
        centre: Vector3::new(0.02, 0.03, 0.0),
        radii: Vector3::new(0.004, 0.004, f64::INFINITY),
    };
    let body = without(plate.section(&PLANE).unwrap(), hole);
    let mesh = body_mesh(&body, &PLANE, 0.001).unwrap();
    assert_sound(&mesh);
    let exact = 0.048 * (0.044 + 0.016) / 2.0 - PI * 1.6e-5;
    assert_eq!(mesh.corners, 3);
    assert!((mesh.volume() / exact - 1.0).abs() < 2e-3, "{}", mesh.volume() / exact);
}

#[test]
fn a_plate_of_one_cell_and_a_body_of_several_pieces_are_whole() {
    let plate = meshed(&cuboid([0.0; 3], [1.0, 1.0, 0.03]), 0.1);
    assert!((plate.volume() - 0.03).abs() < 1e-14);
    let pieces = vec![cuboid([0.0; 3], [1.0; 3]), cuboid([1.5, 0.0, 0.0], [2.0, 1.0, 1.0])];
    let mesh = meshed(&Shape::Union(pieces), 0.1);
    assert!((mesh.volume() - 1.5).abs() < 1e-3, "{}", mesh.volume());
}

#[test]
fn cells_are_cut_where_regions_meet_and_the_first_region_has_them() {
    let region = |part: Selector| Region::new("part", part, tissue(0.3).unwrap());
    let inside = |shape: Shape| Selector::Inside { shape, tolerance: 0.0 };
    let inclusion = Shape::Sphere { centre: Vector3::repeat(0.5), radius: 0.3 };
    let overlapping = cuboid([0.5, -1.0, -1.0], [2.0; 3]);
    let regions = [region(inside(inclusion)), region(inside(overlapping)), region(Selector::All)];
    let body = cuboid([0.0; 3], [1.0; 3]);
    let mut mesh = meshed(&body, 0.06);
    into_regions(&mut mesh, &regions, &body, &Dimension::Three);
    assert_sound(&mesh);
    let volume = |region: u16| -> f64 {
        let own = mesh.iter().zip(&mesh.regions).filter(|(_, own)| **own == region);
        own.map(|(cell, _)| mesh.measure(cell)).sum()
    };
    let ball = 4.0 / 3.0 * PI * 0.027;
    assert!((mesh.volume() - 1.0).abs() < 1e-12);
    assert!((volume(0) / ball - 1.0).abs() < 0.02, "{}", volume(0) / ball);
    assert!((volume(1) - 0.5 * (1.0 - ball)).abs() < 0.005, "{}", volume(1));
    assert!((volume(2) - volume(1)).abs() < 0.005);
}
