#![allow(non_snake_case)]

use super::creases::creases;
use crate::algebra::random::Random;
use crate::algebra::tensor::Vector3;
use crate::geometry::boundary::{TargetSpacing, boundary_points};
use crate::geometry::{Dimension, Shape, Surface};
use std::f64::consts::TAU;
use std::sync::Arc;

/// The unit ball without what lies below z = −0.7.
fn cut_ball() -> Shape {
    let ball = Shape::Sphere { centre: Vector3::zeros(), radius: 1.0 };
    without(ball, Vector3::new(0.0, 0.0, -0.7), Vector3::z())
}

/// A shape without what lies on the side of a plane that its normal points away from.
fn without(shape: Shape, point: Vector3, normal: Vector3) -> Shape {
    Shape::Difference(Box::new(shape), Box::new(Shape::HalfSpace { point, normal }))
}

/// The least and the largest distance of points to their nearest neighbour.
fn apart(points: &[Vector3]) -> (f64, f64) {
    let nearest = points.iter().map(|X| {
        let others = points.iter().filter(|Y| *Y != X);
        others.map(|Y| (X - Y).norm()).fold(f64::INFINITY, f64::min)
    });
    nearest.fold((f64::INFINITY, 0.0), |(least, most), d| (d.min(least), d.max(most)))
}

#[test]
fn the_rim_of_a_cut_ball_is_divided_evenly() {
    let radius = (1.0_f64 - 0.49).sqrt();
    for spacing in [0.1, 0.137, 0.25, 0.4] {
        let points = cut_ball().boundary_points(spacing, &Dimension::Three).unwrap();
        let on_rim =
            |X: &Vector3| (X.z + 0.7).abs() < 1e-8 && (X.xy().norm() - radius).abs() < 1e-8;
        let rim: Vec<Vector3> = points.into_iter().filter(on_rim).collect();
        let expected = (TAU * radius / spacing).round() as usize;
        assert_eq!(rim.len(), expected, "{spacing}");
        let (least, most) = apart(&rim);
        assert!(least > 0.9 * spacing && most < 1.1 * spacing, "{least} to {most}");
    }
}

#[test]
fn three_members_meet_at_corners() {
    let quarter = without(
        without(cut_ball(), Vector3::zeros(), Vector3::x()),
        Vector3::zeros(),
        Vector3::y(),
    );
    let points = quarter.boundary_points(0.17, &Dimension::Three).unwrap();
    let radius = (1.0_f64 - 0.49).sqrt();
    for corner in [[0.0, 0.0, 1.0], [0.0, 0.0, -0.7], [radius, 0.0, -0.7], [0.0, radius, -0.7]] {
        let corner = Vector3::from(corner);
        let nearest = points.iter().map(|X| (X - corner).norm()).fold(1.0, f64::min);
        assert!(nearest < 1e-7, "{nearest} from {corner}");
    }
    let on_axis = points.iter().filter(|X| X.xy().norm() < 1e-8).count();
    assert_eq!(on_axis, 1 + (1.7_f64 / 0.17).round() as usize);
}

#[test]
fn every_cut_of_a_prism_has_its_corners_whatever_the_spacing() {
    let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.4], [0.4, 0.4], [0.4, 1.0], [0.0, 1.0]];
    let prism = Shape::Polygon { points: outline.to_vec().into(), z: (0.0, 1.0) };
    let mut random = Random(11);
    for _ in 0..12 {
        let height = 0.5 + 0.2 * random.symmetric();
        let normal = Vector3::new(0.1 * random.symmetric(), 0.1 * random.symmetric(), -1.0);
        let spacing = 0.17 + 0.06 * random.symmetric();
        let point = Vector3::new(0.0, 0.0, height);
        let body = without(prism.clone(), point, normal.normalize());
        // The spacing grows from one corner on.
        let at = |X: &Vector3| spacing * (0.7 + 0.3 * X.norm()).min(1.0);
        let target = TargetSpacing { at: &at, smallest: 0.7 * spacing, largest: spacing };
        let points = boundary_points(&body, &target, &Dimension::Three).unwrap().points;
        for [x, y] in outline {
            let z = height + normal.x * x + normal.y * y;
            let corner = Vector3::new(x, y, z);
            let nearest = points.iter().map(|X| (X - corner).norm()).fold(1.0, f64::min);
            assert!(nearest < 1e-8, "{nearest} from {corner} at {spacing}");
        }
    }
}

#[test]
fn faces_that_go_on_in_another_member_have_no_edge_between() {
    let box_from = |x: f64| Shape::Box {
        min: Vector3::new(x, 0.0, 0.0),
        max: Vector3::new(x + 1.0, 1.0, 1.0),
    };
    let body = Shape::Union(vec![box_from(0.0), box_from(1.0), box_from(0.4)]);
    let panels = body.boundary_panels(0.05, &Dimension::Three).unwrap();
    let places: Vec<Vector3> = panels.iter().map(|panel| panel.centre).collect();
    let target = TargetSpacing { at: &|_| 0.15, smallest: 0.15, largest: 0.15 };
    let found = creases(&body, &places, &target, false);
    // Edges of the boxes that are edges of the body are found again; no other curve is.
    let is_edge = |X: &Vector3| {
        let off = [X.x.min(2.0 - X.x), X.y.min(1.0 - X.y), X.z.min(1.0 - X.z)];
        off.iter().filter(|off| off.abs() < 1e-6).count() > 1
    };
    assert!(found.edges.iter().chain(&found.corners).all(is_edge), "{:?}", found.edges);
}

#[test]
fn outlines_that_meet_have_corners() {
    let plane = Dimension::PlaneStrain { thickness: 1.0, z: 0.0 };
    let points = cut_ball_in_plane().boundary_points(0.13, &plane).unwrap();
    for x in [-0.8, 0.8] {
        let corner = Vector3::new(x, -0.6, 0.0);
        assert!(points.iter().any(|X| (X - corner).norm() < 1e-7), "{x}");
    }
}

/// The unit disc without what lies below y = −0.6.
fn cut_ball_in_plane() -> Shape {
    let ball = Shape::Sphere { centre: Vector3::zeros(), radius: 1.0 };
    without(ball, Vector3::new(0.0, -0.6, 0.0), Vector3::y())
}

/// A cylinder of radius and height 1 in triangles about 0.06 wide.
fn faceted_cylinder() -> Shape {
    let count = 100_u32;
    let ring = |z: f64| {
        (0..count).map(move |n| {
            let (sin, cos) = (f64::from(n) * TAU / f64::from(count)).sin_cos();
            Vector3::new(cos, sin, z)
        })
    };
    let mut vertices: Vec<Vector3> = ring(0.0).chain(ring(1.0)).collect();
    vertices.extend([Vector3::zeros(), Vector3::z()]);
    let triangles = (0..count).flat_map(|a| {
        let b = (a + 1) % count;
        let (up, over) = (a + count, b + count);
        [[a, b, over], [a, over, up], [2 * count, b, a], [2 * count + 1, up, over]]
    });
    let triangles = triangles.collect();
    Shape::Surface(Arc::new(Surface::new(vertices, triangles).unwrap()))
}

#[test]
fn sharp_edges_of_small_triangles_are_divided_as_one_curve() {
    for spacing in [0.11, 0.2, 0.31] {
        let points = faceted_cylinder().boundary_points(spacing, &Dimension::Three).unwrap();
        let on_rim = |X: &Vector3| X.z == 0.0 && X.xy().norm() > 0.999;
        let rim: Vec<Vector3> = points.into_iter().filter(on_rim).collect();
        let (least, most) = apart(&rim);
        assert!(least > 0.9 * spacing && most < 1.1 * spacing, "{least} to {most} of {spacing}");
        assert_eq!(rim.len(), (TAU / spacing).round() as usize);
    }
}

#[test]
fn panels_of_a_prism_do_not_hang_on_where_it_lies() {
    let panels = |x: f64, y: f64| {
        let corners = [[0.0, 0.0], [0.7, 0.0], [0.7, 0.35], [0.35, 0.35], [0.35, 0.7], [0.0, 0.7]];
        let points = corners.map(|c| [c[0] + x, c[1] + y]).to_vec();
        let prism = Shape::Polygon { points: points.into(), z: (0.0, 0.7) };
        // Halves of the edges are just as long as this.
        prism.boundary_panels(0.35 / 8.0, &Dimension::Three).unwrap()
    };
    let home = panels(0.0, 0.0);
    for (x, y) in [(2.17, -1.61), (0.3, 0.1), (-1.1, 7.7)] {
        let there = panels(x, y);
        assert_eq!(home.len(), there.len(), "at {x}, {y}");
        for (a, b) in home.iter().zip(&there) {
            assert!((a.centre + Vector3::new(x, y, 0.0) - b.centre).norm() < 1e-12);
        }
    }
}
