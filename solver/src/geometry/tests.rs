#![allow(non_snake_case)]

use super::*;
use crate::algebra::tensor::Vector3;
use proptest::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;

const PLANE: Dimension = Dimension::PlaneStrain { thickness: 0.5, z: 0.05 };

/// An L of area 0.75 with its notch at the upper right.
fn l_shape() -> Vec<[f64; 2]> {
    vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.5, 0.5], [0.5, 1.0], [0.0, 1.0]]
}

fn cube_mesh(edge: f64) -> (Vec<Vector3>, Vec<[u32; 3]>) {
    let vertices = (0..8_u8)
        .map(|n| Vector3::from_fn(|k, _| if n >> k & 1 == 1 { edge } else { 0.0 }))
        .collect();
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    (vertices, triangles)
}

/// Every single shape with its volume and area [m³, m²] and how exact its
/// panels are; a new shape is covered by its line.
fn solids() -> Vec<(&'static str, Shape, f64, f64, f64)> {
    let axis = Vector3::new(1.0, 2.0, -2.0) / 3.0;
    let (vertices, triangles) = cube_mesh(0.6);
    let surface = Surface::new(vertices, triangles).unwrap();
    let (min, max) = (Vector3::new(-0.2, 0.1, 0.0), Vector3::new(0.8, 0.6, 0.3));
    let base = Vector3::new(0.3, -0.1, 0.2);
    let radii = Vector3::new(0.5, 0.4, 0.3);
    let p = 1.6075_f64;
    let powers = [radii.x * radii.y, radii.y * radii.z, radii.z * radii.x].map(|a| a.powf(p));
    let ellipsoid_area = 4.0 * PI * (powers.iter().sum::<f64>() / 3.0).powf(1.0 / p);
    vec![
        ("box", Shape::Box { min, max }, 0.15, 1.9, 1e-12),
        (
            "cylinder",
            Shape::Cylinder { base, axis, radius: 0.3, height: 0.7 },
            PI * 0.09 * 0.7,
            2.0 * PI * 0.09 + 2.0 * PI * 0.3 * 0.7,
            1e-12,
        ),
        (
            "sphere",
            Shape::Sphere { centre: base, radius: 0.4 },
            4.0 / 3.0 * PI * 0.064,
            4.0 * PI * 0.16,
            1e-12,
        ),
        (
            "ellipsoid",
            Shape::Ellipsoid { centre: base, radii },
            4.0 / 3.0 * PI * radii.product(),
            ellipsoid_area,
            // Thomsen's formula for the area is good to 1.1 %.
            0.012,
        ),
        ("polygon", Shape::Polygon { points: l_shape().into(), z: (-0.1, 0.3) }, 0.3, 3.1, 1e-12),
        ("surface", Shape::Surface(Arc::new(surface)), 0.216, 2.16, 1e-12),
    ]
}

/// Solids that reach z = 0.05 with the area and length of their sections.
fn sections() -> Vec<(&'static str, Shape, f64, f64)> {
    let (vertices, triangles) = cube_mesh(0.6);
    let surface = Surface::new(vertices, triangles).unwrap();
    let (min, max) = (Vector3::new(-0.2, 0.1, 0.0), Vector3::new(0.8, 0.6, 0.3));
    let base = Vector3::new(0.3, -0.1, 0.0);
    let centre = Vector3::new(0.3, -0.1, 0.05 - 0.3);
    vec![
        ("box", Shape::Box { min, max }, 0.5, 3.0),
        (
            "cylinder",
            Shape::Cylinder { base, axis: Vector3::z(), radius: 0.3, height: 0.7 },
            PI * 0.09,
            PI * 0.6,
        ),
        ("sphere", Shape::Sphere { centre, radius: 0.5 }, PI * 0.16, PI * 0.8),
        (
            "ellipsoid",
            Shape::Ellipsoid {
                centre: Vector3::new(0.0, 0.0, 0.05),
                radii: Vector3::new(0.2, 0.1, 0.3),
            },
            PI * 0.02,
            // 4 a E(e), e² = 3/4.
            0.8 * 1.2110560275684594,
        ),
        ("polygon", Shape::Polygon { points: l_shape().into(), z: (-0.1, 0.3) }, 0.75, 4.0),
        ("surface", Shape::Surface(Arc::new(surface)), 0.36, 2.4),
    ]
}

proptest! {
    #[test]
    fn distance_is_lipschitz_with_constant_one(
        a in prop::array::uniform3(-1.0..1.0f64),
        b in prop::array::uniform3(-1.0..1.0f64),
    ) {
        let (a, b) = (Vector3::from(a), Vector3::from(b));
        for (name, shape, ..) in solids() {
            let change = (shape.signed_distance(&a) - shape.signed_distance(&b)).abs();
            prop_assert!(change <= (a - b).norm() * (1.0 + 1e-9), "{name}: {change}");
        }
    }

    #[test]
    fn a_point_moved_by_its_distance_along_the_gradient_lies_on_the_surface(
        x in prop::array::uniform3(-1.0..1.0f64),
    ) {
        let X = Vector3::from(x);
        for (name, shape, ..) in solids() {
            let (distance, gradient) = (shape.signed_distance(&X), shape.gradient(&X));
            prop_assert!((gradient.norm() - 1.0).abs() < 1e-12, "{name}");
            // Inside, a medial axis may be near.
            if distance > 1e-3 {
                let moved = shape.signed_distance(&(X - distance * gradient));
                prop_assert!(moved.abs() < 1e-5, "{name}: {moved} left of {distance}");
            }
        }
    }

    #[test]
    fn the_gradient_of_the_distance_has_unit_length(
        x in prop::array::uniform3(-0.05..0.05f64),
        n in 0..400usize,
    ) {
        // Near the boundary, off the medial axis.
        for (name, shape, ..) in solids() {
            let panels = shape.boundary_panels(0.1, &Dimension::Three).unwrap();
            let panel = panels[n % panels.len()];
            let X = panel.centre + x[0] * 0.2 * panel.normal;
            let step = 1e-6;
            let slope = (shape.signed_distance(&(X + step * panel.normal))
                - shape.signed_distance(&(X - step * panel.normal))) / (2.0 * step);
            prop_assert!((slope - 1.0).abs() < 1e-6, "{name} at {X:?}: {slope}");
        }
    }
}

#[test]
fn a_distance_to_an_ellipsoid_is_that_to_its_closest_point() {
    let radii = Vector3::new(0.5, 0.4, 0.3);
    let shape = Shape::Ellipsoid { centre: Vector3::zeros(), radii };
    assert!((shape.signed_distance(&Vector3::zeros()) + 0.3).abs() < 1e-10);
    assert!((shape.signed_distance(&Vector3::new(0.0, 0.0, 0.1)) + 0.2).abs() < 1e-10);
    assert!((shape.signed_distance(&Vector3::new(2.0, 0.0, 0.0)) - 1.5).abs() < 1e-10);
    let panels = shape.boundary_panels(0.01, &Dimension::Three).unwrap();
    for X in [Vector3::new(0.1, 0.05, -0.02), Vector3::new(0.6, 0.3, 0.2)] {
        let nearest = panels.iter().map(|p| (p.centre - X).norm()).fold(f64::INFINITY, f64::min);
        assert!((shape.signed_distance(&X).abs() - nearest).abs() < 3e-4);
    }
}

fn check_closed(name: &str, panels: &[Panel], volume: f64, dimension: f64, tolerance: f64) {
    let area: f64 = panels.iter().map(|p| p.area).sum();
    let sum: Vector3 = panels.iter().map(|p| p.area * p.normal).sum();
    let flux: f64 = panels.iter().map(|p| p.area * p.centre.dot(&p.normal)).sum();
    assert!(sum.norm() < 1e-9 * area, "{name}: Σ area normal is {sum:?}");
    let error = (flux / (dimension * volume) - 1.0).abs();
    assert!(error < tolerance, "{name}: the divergence theorem is off by {error}");
    assert!(panels.iter().all(|p| (p.normal.norm() - 1.0).abs() < 1e-9), "{name}");
}

#[test]
fn panels_cover_every_solid_and_close() {
    for (name, shape, volume, area, tolerance) in solids() {
        for size in [0.1, 0.037] {
            let panels = shape.boundary_panels(size, &Dimension::Three).unwrap();
            let total: f64 = panels.iter().map(|p| p.area).sum();
            assert!((total / area - 1.0).abs() < tolerance, "{name}: {total} against {area}");
            assert!(panels.iter().all(|p| p.area <= size * size * (1.0 + 1e-9)), "{name}");
            check_closed(name, &panels, volume, 3.0, 1e-9);
        }
    }
}

#[test]
fn panels_cover_every_section_and_close() {
    for (name, shape, area, length) in sections() {
        let panels = shape.boundary_panels(0.02, &PLANE).unwrap();
        let total: f64 = panels.iter().map(|p| p.area).sum();
        assert!((total / (0.5 * length) - 1.0).abs() < 1e-6, "{name}: {total} of {length}");
        assert!(panels.iter().all(|p| p.normal.z == 0.0 && p.centre.z == 0.05), "{name}");
        check_closed(name, &panels, 0.5 * area, 2.0, 1e-9);
    }
}

#[test]
fn the_panels_of_an_ellipsoid_agree_with_those_of_half_the_size() {
    let shape = Shape::Ellipsoid { centre: Vector3::zeros(), radii: Vector3::new(0.5, 0.4, 0.3) };
    let area = |size: f64| -> f64 {
        shape.boundary_panels(size, &Dimension::Three).unwrap().iter().map(|p| p.area).sum()
    };
    assert!((area(0.03) / area(0.005) - 1.0).abs() < 1e-3);
}

#[test]
fn panels_of_composites_have_the_area_of_what_is_left() {
    let cube = |at: f64| Shape::Box {
        min: Vector3::new(at, 0.0, 0.0),
        max: Vector3::new(at + 1.0, 1.0, 1.0),
    };
    let area = |shape: &Shape| -> f64 {
        shape.boundary_panels(0.1, &Dimension::Three).unwrap().iter().map(|p| p.area).sum()
    };
    // Overlapping, glued along a face, and cut in half.
    assert!((area(&Shape::Union(vec![cube(0.0), cube(0.5)])) - 8.0).abs() < 1e-9);
    assert!((area(&Shape::Union(vec![cube(0.0), cube(1.0)])) - 10.0).abs() < 1e-9);
    let half = Shape::Difference(Box::new(cube(0.0)), Box::new(cube(0.5)));
    assert!((area(&half) - 4.0).abs() < 1e-9);
    let plane = Shape::HalfSpace { point: Vector3::new(0.5, 0.5, 0.5), normal: -Vector3::x() };
    let cut = Shape::Difference(Box::new(cube(0.0)), Box::new(plane));
    assert!((area(&cut) - 4.0).abs() < 0.004, "{}", area(&cut));
    let ball = Shape::Sphere { centre: Vector3::zeros(), radius: 0.5 };
    let bitten = Shape::Difference(Box::new(cube(0.0)), Box::new(ball.clone()));
    // Three faces lose a quarter disc, an eighth of the sphere is new.
    let expected = 6.0 - 0.75 * PI * 0.25 + 0.5 * PI * 0.25;
    assert!((area(&bitten) / expected - 1.0).abs() < 2e-3, "{}", area(&bitten));
    // What they have in common: overlapping, in one place, on one side of a plane, an eighth.
    let common = |a: Shape, b: Shape| area(&Shape::Intersection(vec![a, b]));
    assert!((common(cube(0.0), cube(0.5)) - 4.0).abs() < 1e-9);
    assert!((common(cube(0.0), cube(0.0)) - 6.0).abs() < 1e-9);
    let behind = Shape::HalfSpace { point: Vector3::new(0.5, 0.5, 0.5), normal: Vector3::x() };
    assert!((common(cube(0.0), behind) - 4.0).abs() < 0.004);
    let expected = 0.75 * PI * 0.25 + 0.5 * PI * 0.25;
    assert!((common(cube(0.0), ball) / expected - 1.0).abs() < 1e-2);
}

/// Least and greatest distance to the nearest neighbour.
fn neighbour_range(points: &[Vector3]) -> (f64, f64) {
    let nearest = points.iter().enumerate().map(|(n, a)| {
        let others = points.iter().enumerate().filter(|(m, _)| *m != n);
        others.map(|(_, b)| (a - b).norm()).fold(f64::INFINITY, f64::min)
    });
    nearest.fold((f64::INFINITY, 0.0), |(l, u), d| (d.min(l), d.max(u)))
}

#[test]
fn boundary_points_are_evenly_distributed_on_the_boundary() {
    let spacing = 0.05;
    let solids = solids().into_iter().map(|s| (s.0, s.1, Dimension::Three));
    for (name, shape, dimension) in solids.chain(sections().into_iter().map(|s| (s.0, s.1, PLANE)))
    {
        let points = shape.boundary_points(spacing, &dimension).unwrap();
        let (least, most) = neighbour_range(&points);
        assert!(least > 0.599 * spacing && most < 1.25 * spacing, "{name}: {least} to {most}");
        let section = shape.section(&dimension).unwrap();
        assert!(points.iter().all(|X| section.signed_distance(X).abs() < 1e-8), "{name}");
        for panel in shape.boundary_panels(0.02, &dimension).unwrap() {
            let gap = points.iter().map(|X| (X - panel.centre).norm()).fold(1.0, f64::min);
            assert!(gap < 1.1 * spacing, "{name}: a hole of {gap} at {:?}", panel.centre);
        }
    }
}

#[test]
fn corners_come_first() {
    let shape = Shape::Polygon { points: l_shape().into(), z: (-0.1, 0.3) };
    let points = shape.boundary_points(0.1, &PLANE).unwrap();
    for (point, corner) in points.iter().zip(l_shape()) {
        assert_eq!([point.x, point.y, point.z], [corner[0], corner[1], 0.05]);
    }
    assert_eq!(points.len(), 40);
}

#[test]
fn a_plane_with_a_hole_gets_points_on_both_curves() {
    let plate = Shape::Box { min: Vector3::zeros(), max: Vector3::new(1.0, 1.0, 0.1) };
    let hole =
        Shape::Cylinder { base: Vector3::zeros(), axis: Vector3::z(), radius: 0.5, height: 0.1 };
    let body = Shape::Difference(Box::new(plate), Box::new(hole));
    let points = body.boundary_points(0.05, &PLANE).unwrap();
    let (least, most) = neighbour_range(&points);
    assert!(least > 0.028 && most < 0.065, "{least} to {most}");
    let on_arc = points.iter().filter(|X| (X.xy().norm() - 0.5).abs() < 1e-6).count();
    assert!((14..=18).contains(&on_arc), "{on_arc}");
}

#[test]
fn the_outline_of_a_sphere_is_a_circle() {
    let shape = Shape::Sphere { centre: Vector3::new(0.1, 0.2, 0.0), radius: 0.5 };
    let curves = shape.outline(0.3, 0.01);
    assert_eq!(curves.len(), 1);
    for p in &curves[0] {
        assert!(((p[0] - 0.1).hypot(p[1] - 0.2) - 0.4).abs() < 1e-4);
    }
    let area = polygon::polygon_area(&curves[0]);
    assert!((area / (PI * 0.16) - 1.0).abs() < 1e-3);
    assert!(shape.outline(0.6, 0.01).is_empty());
}

#[test]
fn a_cube_of_triangles_knows_inside_from_outside() {
    let (vertices, triangles) = cube_mesh(2.0);
    let surface = Surface::new(vertices.clone(), triangles.clone()).unwrap();
    assert!((surface.volume() - 8.0).abs() < 1e-12);
    let at = |x, y, z| surface.signed_distance(&Vector3::new(x, y, z));
    assert!((at(1.0, 1.0, 1.7) + 0.3).abs() < 1e-12);
    assert!((at(1.0, 1.0, 2.5) - 0.5).abs() < 1e-12);
    assert!((at(3.0, 3.0, 3.0) - 3_f64.sqrt()).abs() < 1e-12);
    let open = Surface::new(vertices.clone(), triangles[1..].to_vec()).unwrap_err();
    assert!(matches!(open, GeometryError::SurfaceOpen(_)), "{open}");
    let wrong = Surface::new(vertices, vec![[0, 1, 9]]).unwrap_err();
    assert_eq!(wrong, GeometryError::SurfaceVertex { triangle: 0, vertex: 9, count: 8 });
}

#[test]
fn a_soup_of_triangles_is_merged() {
    let (vertices, triangles) = cube_mesh(1.0);
    let soup: Vec<Vector3> = triangles.iter().flatten().map(|&v| vertices[v as usize]).collect();
    let triangles = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    assert!((Surface::new(soup, triangles).unwrap().volume() - 1.0).abs() < 1e-12);
}

#[test]
fn vertices_that_differ_by_round_off_are_one() {
    let (vertices, triangles) = cube_mesh(1.0);
    let soup = |difference: f64| -> Vec<Vector3> {
        let shifted = |(n, &v): (usize, &u32)| {
            vertices[v as usize] - Vector3::repeat(if n == 4 { difference } else { 0.0 })
        };
        triangles.iter().flatten().enumerate().map(shifted).collect()
    };
    let numbers: Vec<[u32; 3]> = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    for difference in [1e-22, 1e-12, 9e-10] {
        let surface = Surface::new(soup(difference), numbers.clone()).unwrap();
        assert!((surface.volume() - 1.0).abs() < 1e-8);
    }
    let error = Surface::new(soup(2e-9), numbers).unwrap_err();
    assert!(matches!(error, GeometryError::SurfaceOpen(_)), "{error}");
}

#[test]
fn invalid_shapes_are_refused() {
    let origin = Vector3::zeros();
    let refused = |shape: Shape| shape.validate_body().unwrap_err();
    assert!(matches!(
        refused(Shape::Sphere { centre: origin, radius: -1.0 }),
        GeometryError::NotPositive { value: -1.0, .. }
    ));
    assert!(matches!(
        refused(Shape::Box { min: origin, max: Vector3::new(1.0, 0.0, 1.0) }),
        GeometryError::EmptyBox { axis: 1, .. }
    ));
    let polygon =
        |points: Vec<[f64; 2]>| refused(Shape::Polygon { points: points.into(), z: (0.0, 1.0) });
    assert_eq!(polygon(vec![[0.0, 0.0], [1.0, 0.0]]), GeometryError::TooFewPoints { count: 2 });
    assert_eq!(
        polygon(vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]),
        GeometryError::PolygonCrosses { first: 0, second: 2 }
    );
    let normal = Vector3::zeros();
    let half_space = Shape::HalfSpace { point: origin, normal };
    assert!(matches!(refused(half_space), GeometryError::NotUnit { .. }));
    let half_space = Shape::HalfSpace { point: origin, normal: Vector3::x() };
    assert!(half_space.validate().is_ok());
    assert!(matches!(refused(half_space), GeometryError::Unbounded { .. }));
    let nothing = |shape| GeometryError::NoMembers { shape };
    assert_eq!(refused(Shape::Union(vec![])), nothing("union"));
    assert_eq!(refused(Shape::Intersection(vec![])), nothing("intersection"));
    let ball = |x| Shape::Sphere { centre: Vector3::new(x, 0.0, 0.0), radius: 1.0 };
    let apart = Shape::Intersection(vec![ball(0.0), ball(2.1)]);
    assert_eq!(refused(apart), GeometryError::NothingInCommon);
}

#[test]
fn a_tilted_cylinder_has_no_section_and_a_low_one_no_point_there() {
    let axis = Vector3::new(0.6, 0.0, 0.8);
    let tilted = Shape::Cylinder { base: Vector3::zeros(), axis, radius: 1.0, height: 1.0 };
    let error = tilted.boundary_panels(0.1, &PLANE).unwrap_err();
    assert!(matches!(error, GeometryError::SectionUnsupported { .. }));
    let low = Shape::Sphere { centre: Vector3::zeros(), radius: 0.01 };
    let error = low.boundary_points(0.1, &PLANE).unwrap_err();
    assert_eq!(error, GeometryError::SectionEmpty { shape: "sphere", z: 0.05 });
}

#[test]
fn too_many_panels_are_refused_before_they_are_made() {
    let shape = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(0.1) };
    for dimension in [Dimension::Three, PLANE] {
        let error = shape.boundary_panels(1e-12, &dimension).unwrap_err();
        assert!(matches!(error, GeometryError::TooMany { what: "boundary panels", .. }), "{error}");
    }
}
