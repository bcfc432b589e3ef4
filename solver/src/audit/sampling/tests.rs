use super::surface::Facet;
use super::*;
use crate::algebra::random::Random;
use crate::algebra::tensor::{Matrix3, Vector3};
use crate::geometry::{LabelField, LabelMap, Selector, Shape};
use crate::problem::Dimension;
use std::sync::Arc;

/// An ellipsoid of label 2 in a ball of label 1, voxels of 4 mm.
fn nested() -> (Shape, Selector, f64) {
    let (n, voxel) = (41usize, 4e-3);
    let at = |index: usize| voxel * (index as f64 - 20.0);
    let label = |v: usize| {
        let X = Vector3::new(at(v % n), at(v / n % n), at(v / (n * n)));
        let inner =
            (X - Vector3::new(0.0, 0.0, 5e-3)).component_div(&Vector3::new(12e-3, 30e-3, 10e-3));
        u32::from(X.norm() < 70e-3) + u32::from(inner.norm() < 1.0)
    };
    let labels: Vec<u32> = (0..n * n * n).map(label).collect();
    let volume = labels.iter().filter(|label| **label == 2).count() as f64 * voxel.powi(3);
    let directions = Matrix3::from_diagonal_element(voxel);
    let map = LabelMap::new([n; 3], Vector3::repeat(-20.0 * voxel), directions, labels);
    let map = Arc::new(map.unwrap());
    let field = LabelField::new(map.clone(), &[1, 2], LabelField::SMOOTHING).unwrap();
    (Shape::Labels(Arc::new(field)), Selector::Label { map, label: 2 }, volume)
}

#[test]
fn the_volume_of_a_label_is_known_within_its_doubt() {
    let (body, part, volume) = nested();
    for spacing in [20e-3, 14e-3, 10e-3, 7e-3, 5e-3] {
        let divided = Divided {
            body: &body,
            dimension: &Dimension::Three,
            parts: vec![&part, &Selector::All],
            spacing,
            nodes: 1000,
        };
        let found = sample(&divided).unwrap().volumes[0];
        assert!((found.size - volume).abs() < found.doubt, "{spacing}: {} of {volume}", found.size);
        assert!(found.doubt < 0.4 * volume, "{spacing}: {}", found.doubt);
    }
}

#[test]
fn a_layer_that_lies_between_the_corners_of_cells_is_not_denied() {
    let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(0.1) };
    for thickness in [1e-3, 3e-3, 6e-3] {
        let shape = Shape::Box {
            min: Vector3::new(-1.0, -1.0, 0.0445),
            max: Vector3::new(1.0, 1.0, 0.0445 + thickness),
        };
        let layer = Selector::Inside { shape, tolerance: 0.0 };
        for spacing in [20e-3, 12.5e-3, 6e-3] {
            let divided = Divided {
                body: &body,
                dimension: &Dimension::Three,
                parts: vec![&layer, &Selector::All],
                spacing,
                nodes: 700,
            };
            let found = sample(&divided).unwrap().volumes[0];
            let error = (found.size - 0.01 * thickness).abs();
            assert!(error <= found.doubt + 1e-9, "{thickness} {spacing}: {error} {found:?}");
        }
    }
}

#[test]
fn a_face_in_which_two_members_touch_is_no_boundary() {
    let block = |low: f64, high: f64| Shape::Box {
        min: Vector3::new(low, 0.0, 0.0),
        max: Vector3::new(high, 0.04, 0.04),
    };
    for border in [0.05, 0.043, 0.0712] {
        let body = Shape::Union(vec![block(0.0, border), block(border, 0.1)]);
        for spacing in [10e-3, 8e-3, 5e-3] {
            let divided = Divided {
                body: &body,
                dimension: &Dimension::Three,
                parts: vec![&Selector::All],
                spacing,
                nodes: 300,
            };
            let found = sample(&divided).unwrap();
            let area: f64 = found.facets.iter().map(Facet::area).sum();
            assert!((area - 0.0192).abs() < 0.02 * 0.0192, "{border} {spacing}: {area}");
            let seam = found.facets.iter().filter(|facet| {
                let X = facet.centre();
                (X.x - border).abs() < 1e-6 && X.y.min(X.z) > 0.01 && X.y.max(X.z) < 0.03
            });
            assert_eq!(seam.count(), 0, "{border} {spacing}");
        }
    }
}

fn sampled(body: &Shape, spacing: f64) -> Sampled {
    let dimension = &Dimension::Three;
    let parts = vec![&Selector::All];
    let nodes = (1e-3 / spacing.powi(3)) as usize;
    sample(&Divided { body, dimension, parts, spacing, nodes }).unwrap()
}

#[test]
fn where_flat_faces_meet_the_boundary_is_closed_and_its_area_is_that_of_the_faces() {
    let mut random = Random(5);
    for n in 0..24 {
        let mut within =
            |low: f64, high: f64| low + (high - low) * 0.5 * (1.0 + random.symmetric());
        let size = Vector3::from_fn(|_, _| within(0.05, 0.15));
        let block = Shape::Box { min: Vector3::zeros(), max: size };
        // A wedge is cut off, or a notch into an edge.
        let normal = Vector3::from_fn(|_, _| within(-1.0, 1.0)).normalize();
        let place = size.map(|length| length * within(0.4, 0.6));
        let notch = Shape::Box { min: place, max: 2.0 * size };
        let body = match n % 2 {
            0 => Shape::Intersection(vec![block, Shape::HalfSpace { point: place, normal }]),
            _ => Shape::Difference(Box::new(block), Box::new(notch)),
        };
        let found = sampled(&body, within(0.01, 0.02));
        let areas = found.facets.iter().map(|facet| facet.area() * facet.normal());
        let (all, sizes) = areas
            .clone()
            .fold((Vector3::zeros(), 0.0), |(sum, size), area| (sum + area, size + area.norm()));
        // Where an edge passes by a cell at a hundredth of its own, the cell does not see it.
        assert!(all.norm() < 5e-3 * sizes, "{n}: {} of {sizes}", all.norm());
        let flux: f64 =
            found.facets.iter().zip(areas).map(|(facet, area)| facet.centre().dot(&area)).sum();
        let volume = found.volume();
        assert!((flux / 3.0 - volume).abs() < 5e-3 * volume, "{n}: {flux} {volume}");
        assert!(found.volumes[0].doubt < 5e-3 * volume, "{n}: {:?}", found.volumes[0]);
        if n % 2 == 1 {
            // A notch takes as much off three faces as it adds.
            let faces = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
            let rest = size - place;
            assert!((sizes - faces).abs() < 5e-3 * faces, "{n}: {sizes} {faces}");
            let exact = size.product() - rest.product();
            assert!((volume - exact).abs() < 1e-3 * exact, "{n}: {volume} {exact}");
        }
    }
}

#[test]
fn the_rim_of_a_cylinder_is_cut_as_sharply_as_its_side() {
    let (radius, height) = (0.05, 0.1);
    let body = Shape::Cylinder { base: Vector3::zeros(), axis: Vector3::z(), radius, height };
    for spacing in [0.01, 0.007, 0.004] {
        let found = sampled(&body, spacing);
        let area: f64 = found.facets.iter().map(Facet::area).sum();
        let exact = 2.0 * std::f64::consts::PI * radius * (radius + height);
        assert!((area / exact - 1.0).abs() < 0.015, "{spacing}: {area} {exact}");
        let volume = std::f64::consts::PI * radius * radius * height;
        assert!((found.volume() / volume - 1.0).abs() < 1e-3, "{spacing}: {}", found.volume());
        let chamfers: f64 = found.facets.iter().filter(|f| f.edge).map(Facet::area).sum();
        assert!(chamfers < 0.01 * exact, "{spacing}: {chamfers} of {exact}");
    }
}

#[test]
fn every_face_of_a_box_has_its_area_though_it_is_no_wider_than_a_spacing() {
    let mut random = Random(3);
    for n in 0..40 {
        let mut within =
            |low: f64, high: f64| low + (high - low) * 0.5 * (1.0 + random.symmetric());
        let size = Vector3::from_fn(|_, _| within(0.02, 0.1));
        let body = Shape::Box { min: Vector3::zeros(), max: size };
        let found = sampled(&body, size.min() * within(0.2, 1.0));
        for axis in 0..3 {
            let exact = size.product() / size[axis];
            for side in [-1.0, 1.0] {
                let own = found.facets.iter().filter(|f| f.normal()[axis] * side > 0.99);
                let area: f64 = own.map(Facet::area).sum();
                assert!((area / exact - 1.0).abs() < 0.01, "{n}: {axis} {side} {area} {exact}");
            }
        }
    }
}

#[test]
fn a_ball_has_no_edges() {
    for (radius, spacing) in [(0.05, 0.01), (0.05, 0.02), (0.05, 0.004)] {
        let body = Shape::Sphere { centre: Vector3::new(0.01, 0.02, -0.01), radius };
        let found = sampled(&body, spacing);
        assert!(found.edges.is_empty(), "{spacing}: {}", found.edges.len());
        let volume = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
        assert!((found.volume() / volume - 1.0).abs() < 5e-3, "{spacing}: {}", found.volume());
    }
}

#[test]
fn what_is_selected_of_a_face_is_all_of_it_whatever_the_cells() {
    let mut random = Random(7);
    for n in 0..120 {
        let mut within =
            |low: f64, high: f64| low + (high - low) * 0.5 * (1.0 + random.symmetric());
        let size = Vector3::from_fn(|_, _| within(0.02, 0.12));
        let (body, spacing) =
            (Shape::Box { min: Vector3::zeros(), max: size }, within(0.008, 0.02));
        let (dimension, parts) = (&Dimension::Three, vec![&Selector::All]);
        let nodes = (size.product() / spacing.powi(3)) as usize;
        let found = sample(&Divided { body: &body, dimension, parts, spacing, nodes }).unwrap();
        for axis in 0..3 {
            let exact = size.product() / size[axis];
            for point in [Vector3::zeros(), size] {
                let normal = Vector3::ith(axis, 1.0);
                let face = Selector::Plane { point, normal, tolerance: 1e-3 * spacing };
                let area = part_of_surface(&found.facets, &face, dimension, spacing).area;
                assert!((area / exact - 1.0).abs() < 0.02, "{n}: {axis} {area} {exact}");
            }
        }
    }
}

#[test]
fn the_inside_of_a_tube_is_selected_by_a_cylinder_of_its_radius() {
    let cylinder = |radius: f64| Shape::Cylinder {
        base: Vector3::zeros(),
        axis: Vector3::z(),
        radius,
        height: 0.05,
    };
    let (inner, outer) = (0.02, 0.04);
    let hole = Shape::Cylinder {
        base: Vector3::new(0.0, 0.0, -1.0),
        axis: Vector3::z(),
        radius: inner,
        height: 2.0,
    };
    let body = Shape::Difference(Box::new(cylinder(outer)), Box::new(hole.clone()));
    for spacing in [0.01, 0.007, 0.005] {
        let found = sampled(&body, spacing);
        let part = Selector::Inside { shape: hole.clone(), tolerance: 1e-3 * spacing };
        let area = part_of_surface(&found.facets, &part, &Dimension::Three, spacing).area;
        let exact = 2.0 * std::f64::consts::PI * inner * 0.05;
        assert!((area / exact - 1.0).abs() < 0.02, "{spacing}: {area} {exact}");
    }
}

/// A box of twelve triangles, turned.
fn turned_box(size: &Vector3, axis: &Vector3, angle: f64) -> Shape {
    let turn = nalgebra::Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(*axis), angle);
    let corner = |n: usize| Vector3::from_fn(|k, _| if n >> k & 1 == 1 { size[k] } else { 0.0 });
    let vertices = (0..8).map(|n| turn * corner(n)).collect();
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    let triangles = faces.into_iter().flat_map(halves).collect();
    Shape::Surface(Arc::new(crate::geometry::Surface::new(vertices, triangles).unwrap()))
}

#[test]
fn a_box_of_triangles_has_its_volume_however_it_is_turned() {
    let mut random = Random(11);
    for n in 0..30 {
        let mut within =
            |low: f64, high: f64| low + (high - low) * 0.5 * (1.0 + random.symmetric());
        let size = Vector3::from_fn(|_, _| within(0.05, 0.12));
        let axis = Vector3::from_fn(|_, _| within(-1.0, 1.0));
        let body = turned_box(&size, &axis, within(0.0, 3.0));
        let spacing = within(0.01, 0.02);
        let (dimension, parts) = (&Dimension::Three, vec![&Selector::All]);
        let nodes = (size.product() / spacing.powi(3)) as usize;
        let found = sample(&Divided { body: &body, dimension, parts, spacing, nodes }).unwrap();
        let (volume, exact) = (found.volume(), size.product());
        let off = (volume - exact).abs();
        assert!(off < found.volumes[0].doubt + 0.01 * exact, "{n}: {volume} {exact}");
    }
}
