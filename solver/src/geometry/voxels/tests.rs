#![allow(non_snake_case)]

use super::*;
use crate::algebra::tensor::{Matrix3, Vector3, rotation};
use crate::geometry::{Dimension, GeometryError, Shape};
use std::f64::consts::PI;
use std::sync::Arc;

/// A ball of radius 10 voxels of 1 mm, in an image turned by `turn`.
fn voxel_ball(turn: Matrix3, voxel: Vector3) -> (Shape, Vector3) {
    let size = voxel.map(|h| (2.0 * (10e-3 / h).ceil() + 7.0) as usize);
    let size = [size.x, size.y, size.z];
    let middle = Vector3::from_fn(|k, _| (size[k] as f64 / 2.0 - 0.37) * voxel[k]);
    let mut labels = Vec::new();
    for k in 0..size[2] {
        for j in 0..size[1] {
            for i in 0..size[0] {
                let at = Vector3::new(i as f64, j as f64, k as f64).component_mul(&voxel);
                labels.push(if (at - middle).norm() < 10e-3 { 7 } else { 0 });
            }
        }
    }
    let origin = Vector3::new(0.2, -0.1, 0.05);
    let directions = turn * Matrix3::from_diagonal(&voxel);
    let map = LabelMap::new(size, origin, directions, labels).unwrap();
    let field = LabelField::new(Arc::new(map), &[7], LabelField::SMOOTHING).unwrap();
    (Shape::Labels(Arc::new(field)), origin + turn * middle)
}

fn turn() -> Matrix3 {
    rotation(&Vector3::new(1.0, -2.0, 0.5).normalize(), 0.8)
}

#[test]
fn a_ball_of_voxels_has_the_volume_and_area_of_a_sphere() {
    let area = 4.0 * PI * 1e-4;
    for (turn, voxel) in [
        (Matrix3::identity(), Vector3::repeat(1e-3)),
        (turn(), Vector3::repeat(1e-3)),
        (turn(), Vector3::new(1e-3, 1e-3, 2e-3)),
    ] {
        let (ball, _) = voxel_ball(turn, voxel);
        let panels = ball.boundary_panels(2e-3, &Dimension::Three).unwrap();
        let total: f64 = panels.iter().map(|p| p.area).sum();
        let sum: Vector3 = panels.iter().map(|p| p.area * p.mean_normal()).sum();
        let flux: f64 = panels.iter().map(|p| p.area * p.centre.dot(&p.mean_normal())).sum();
        assert!(sum.norm() < 1e-9 * area);
        let Shape::Labels(field) = &ball else { unreachable!("voxel_ball makes labels") };
        let count = field.map().labels.iter().filter(|label| **label == 7).count();
        let volume = count as f64 * voxel.product();
        assert!((flux / (3.0 * volume) - 1.0).abs() < 0.01, "{}", flux / 3.0 / volume);
        assert!((total / area - 1.0).abs() < 0.02, "{}", total / area);
    }
}

#[test]
fn distances_to_a_voxel_ball_have_no_bias_and_its_normals_are_smooth() {
    for (smoothing, scatter, least) in [(0.7, 0.1e-3, 0.89), (1.4, 0.075e-3, 0.96)] {
        let (ball, centre) = voxel_ball(turn(), Vector3::repeat(1e-3));
        let Shape::Labels(field) = &ball else { unreachable!("voxel_ball makes labels") };
        let field = LabelField::new(field.map().clone(), &[7], smoothing).unwrap();
        let ball = Shape::Labels(Arc::new(field));
        for radius in [8e-3, 10e-3, 12e-3] {
            let (mut mean, mut square) = (0.0, 0.0);
            for n in 0..2000 {
                let (a, b) = (0.17 * n as f64, (n as f64 + 0.5) / 1000.0 - 1.0);
                let around = (1.0 - b * b).sqrt();
                let direction = Vector3::new(a.cos() * around, a.sin() * around, b);
                let X = centre + radius * direction;
                let error = ball.signed_distance(&X) - (radius - 10e-3);
                mean += error / 2000.0;
                square += error * error / 2000.0;
                let cosine = ball.gradient(&X).dot(&direction);
                assert!(cosine > least, "{smoothing}, {radius}: {cosine}");
            }
            assert!(mean.abs() < 0.06e-3, "{smoothing}, {radius}: {mean}");
            assert!(square.sqrt() < scatter, "{smoothing}, {radius}: {}", square.sqrt());
        }
    }
}

/// Five equal layers of a disc of 8 voxels of 1 mm.
fn slab() -> Arc<LabelMap> {
    let mut labels = Vec::new();
    for n in 0..5 * 21 * 21 {
        let (i, j) = ((n % 21) as f64 - 10.0, (n / 21 % 21) as f64 - 10.0);
        labels.push(if i.hypot(j) < 8.0 { 3 } else { 0 });
    }
    let origin = Vector3::new(-10e-3, -10e-3, 0.0);
    let directions = Matrix3::identity() * 1e-3;
    Arc::new(LabelMap::new([21, 21, 5], origin, directions, labels).unwrap())
}

#[test]
fn the_ends_of_a_slab_are_no_boundary_of_its_section() {
    let field = LabelField::new(slab(), &[3], LabelField::SMOOTHING).unwrap();
    let body = Shape::Labels(Arc::new(field));
    let dimension = Dimension::PlaneStrain { thickness: 1e-3, z: 2e-3 };
    let section = body.section(&dimension).unwrap();
    let middle = Vector3::new(0.0, 0.0, 2e-3);
    assert!((body.signed_distance(&middle) + 2.5e-3).abs() < 0.2e-3);
    // The nearest voxels without the label start at 7.5 mm.
    let inner = section.signed_distance(&middle);
    assert!((inner + 7.65e-3).abs() < 0.2e-3, "{inner}");
    let panels = body.boundary_panels(1e-3, &dimension).unwrap();
    let flux: f64 = panels.iter().map(|p| p.area * p.centre.dot(&p.normal)).sum();
    let voxels = slab().labels.iter().filter(|l| **l == 3).count() as f64 / 5.0;
    assert!((flux / (2.0 * voxels * 1e-9) - 1.0).abs() < 0.01, "{flux} of {voxels}");
    let points = body.boundary_points(2e-3, &dimension).unwrap();
    assert!((23..=27).contains(&points.len()), "{}", points.len());
    let twice = section.section(&dimension).unwrap();
    assert_eq!(twice.signed_distance(&middle), section.signed_distance(&middle));
    let error = body.section(&Dimension::PlaneStrain { thickness: 1.0, z: 0.1 }).unwrap_err();
    assert_eq!(error, GeometryError::SectionEmpty { shape: "label map", z: 0.1 });
}

#[test]
fn a_label_is_that_of_the_voxel_around_a_point() {
    let map = slab();
    assert_eq!(map.label_at(&Vector3::zeros()), 3);
    assert_eq!(map.label_at(&Vector3::new(9e-3, 9e-3, 0.0)), 0);
    assert_eq!(map.label_at(&Vector3::new(0.0, 0.0, 1.0)), 0);
    assert_eq!(map.nearest_label_at(&Vector3::new(8.6e-3, 0.0, 0.0), &[3]), 3);
    assert_eq!(map.nearest_label_at(&Vector3::new(8.6e-3, 0.0, 0.0), &[4]), 0);
}

#[test]
fn invalid_label_maps_are_refused() {
    let unit = Matrix3::identity();
    let origin = Vector3::zeros();
    let short = LabelMap::new([2, 2, 2], origin, unit, vec![1; 7]).unwrap_err();
    assert!(matches!(short, GeometryError::LabelCount { expected: 8, count: 7, .. }));
    let mut flat = unit;
    flat[(2, 2)] = 0.0;
    let singular = LabelMap::new([1, 1, 1], origin, flat, vec![1]).unwrap_err();
    assert_eq!(singular, GeometryError::VoxelEdge { axis: 2, edge: 0.0 });
    let mut thin = unit;
    thin[(2, 2)] = 1e-12;
    let thin = LabelMap::new([1, 1, 1], origin, thin, vec![1]).unwrap_err();
    assert_eq!(thin, GeometryError::VoxelEdge { axis: 2, edge: 1e-12 });
    let twice = Matrix3::new(1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    let singular = LabelMap::new([1, 1, 1], origin, twice, vec![1]).unwrap_err();
    assert_eq!(singular, GeometryError::SingularDirections { determinant: 0.0 });
    let far = LabelMap::new([1, 1, 1], Vector3::repeat(1e300), unit, vec![1]).unwrap_err();
    assert!(matches!(far, GeometryError::FarOrigin { .. }), "{far}");
    let skew = Matrix3::new(1.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    let skew = LabelMap::new([1, 1, 1], origin, skew, vec![1]).unwrap_err();
    assert!(matches!(skew, GeometryError::SkewDirections { first: 0, second: 1, .. }));
    let missing = LabelField::new(slab(), &[3, 4], LabelField::SMOOTHING).unwrap_err();
    assert_eq!(missing, GeometryError::NoSuchLabel { label: 4 });
}

#[test]
fn distances_far_from_the_level_are_those_to_its_nearest_point() {
    // A ball of 6 voxels: up to 30 voxels away outside, beyond the band of exact distances.
    let (n, radius) = (61usize, 6.0f64);
    let at = |index: usize| index as f64 - 30.0;
    let from_middle = |v: usize| Vector3::new(at(v % n), at(v / n % n), at(v / (n * n))).norm();
    let labels = (0..n * n * n).map(|v| u32::from(from_middle(v) < radius)).collect();
    let map = LabelMap::new([n; 3], Vector3::zeros(), Matrix3::identity(), labels).unwrap();
    let ball = LabelField::new(Arc::new(map), &[1], LabelField::SMOOTHING).unwrap();
    let (mut sum, mut most) = (0.0, 0.0f64);
    for v in 0..n * n * n {
        let X = Vector3::new((v % n) as f64, (v / n % n) as f64, (v / (n * n)) as f64);
        let error = ball.signed_distance(&X) - (from_middle(v) - radius);
        sum += error;
        most = most.max(error.abs());
    }
    // The voxels are a ball only to about half a voxel.
    let mean = sum / (n * n * n) as f64;
    assert!(mean.abs() < 0.15 && most < 0.6, "{mean}, {most}");
}

#[test]
fn the_labels_about_a_place_lie_in_the_range_that_its_blocks_give() {
    let size = [13, 9, 11];
    let labels = (0..size.iter().product::<usize>()).map(|n| [0, 0, 3, 3, 3, 8, 1][n / 37 % 7]);
    let directions = turn() * Matrix3::from_diagonal(&Vector3::new(1e-3, 2e-3, 1.5e-3));
    let map = LabelMap::new(size, Vector3::new(0.1, 0.2, -0.3), directions, labels.collect());
    let map = map.unwrap();
    let mut narrow = 0;
    for n in 0..400 {
        let along = |step: f64| (n as f64 * step).fract() * 1.4 - 0.2;
        let size = Vector3::new(13.0, 9.0, 11.0);
        let index = Vector3::new(along(0.137), along(0.291), along(0.511)).component_mul(&size);
        let X = map.origin + map.directions * index;
        let reach = 1e-3 * (n % 5) as f64;
        let (low, high) = map.range_around(&X, reach);
        for m in 0..125 {
            let way = [m % 5, m / 5 % 5, m / 25].map(|c| 0.5 * (c as f64 - 2.0));
            let aside = Vector3::from(way);
            let aside = aside * (reach / aside.norm().max(1.0));
            let label = map.label_at(&(X + aside));
            assert!(low <= label && label <= high, "{label} is not in {low}..={high}");
        }
        narrow += (low == high) as usize;
    }
    assert!(narrow > 50, "{narrow}");
}

#[test]
fn a_value_and_its_slope_are_those_of_seven_samples() {
    let size = [6, 5, 7];
    let values = indices(size).map(|[i, j, k]| ((7 * i + 3 * j * j + 5 * k) as f64).sin());
    let step = Vector3::new(1.0, 0.5, 2.0);
    let grid = ScalarGrid { size, step, values: values.collect() };
    for n in 0..300 {
        let along = |step: f64| (n as f64 * step).fract() * 1.2 - 0.1;
        let extent = Vector3::new(5.0, 2.0, 12.0);
        let x = Vector3::new(along(0.137), along(0.291), along(0.511)).component_mul(&extent);
        let (value, slope) = grid.value_and_slope(&x);
        assert!((value - grid.sample(&x)).abs() < 1e-14);
        for axis in 0..3 {
            let aside = Vector3::ith(axis, 0.25 * step[axis]);
            let rise = grid.sample(&(x + aside)) - grid.sample(&(x - aside));
            assert!((slope[axis] - rise / (0.5 * step[axis])).abs() < 1e-13);
        }
    }
}

#[test]
fn the_part_of_an_image_about_a_label_holds_it_at_the_same_place() {
    let size = [13, 9, 11];
    let labels: Vec<u32> = (0..size.iter().product::<usize>())
        .map(|n| if (5..7).contains(&(n % 13)) && n / 117 == 4 { 3 } else { 1 })
        .collect();
    let directions = turn() * Matrix3::from_diagonal(&Vector3::new(1e-3, 2e-3, 1.5e-3));
    let map = LabelMap::new(size, Vector3::new(0.1, 0.2, -0.3), directions, labels).unwrap();
    let near = map.about(&[3], 2);
    assert_eq!(near.size, [6, 9, 5]);
    for [i, j, k] in indices(near.size) {
        let X = near.centre(i, j, k);
        assert_eq!(near.label_at(&X), map.label_at(&X));
    }
    let all = |map: &LabelMap| map.labels.iter().filter(|label| **label == 3).count();
    assert_eq!((all(&near), all(&map)), (18, 18));
    assert_eq!(map.about(&[7], 2).size, size);
}

#[test]
fn voxels_beside_a_body_have_the_label_of_its_nearest_voxel_and_no_others_change() {
    let size = [4, 3, 1];
    // The body reaches the edge of the image in the last row.
    let labels = vec![5, 0, 0, 0, 0, 1, 2, 0, 5, 1, 2, 2];
    let map = LabelMap::new(size, Vector3::zeros(), Matrix3::identity(), labels).unwrap();
    let filled = map.filled(&[1, 2]);
    assert_eq!(filled.size, [6, 5, 3]);
    let at = |i: f64, j: f64, k: f64| filled.label_at(&Vector3::new(i, j, k));
    for (i, j, k, label) in [
        (1.0, 1.0, 0.0, 1),
        (2.0, 2.0, 0.0, 2),
        (0.6, 0.6, 0.0, 1),
        (0.0, 1.0, 0.0, 1),
        // Of a voxel of 1 and one of 2 across an edge each the smaller label.
        (1.0, 0.0, 0.0, 1),
        (2.0, 0.0, 0.0, 2),
        (3.0, 1.0, 0.0, 2),
        (3.0, 0.0, 0.0, 2),
        (0.0, 0.0, 0.0, 1),
        // Not of the body, though labelled.
        (0.0, 2.0, 0.0, 1),
        (4.4, 2.0, 0.0, 2),
        (1.0, 1.0, -1.0, 1),
        (-1.4, -1.4, 0.0, 0),
    ] {
        assert_eq!(at(i, j, k), label, "{i} {j} {k}");
    }
    let within = LabelMap::new([3, 3, 3], Vector3::zeros(), Matrix3::identity(), {
        let mut labels = vec![0; 27];
        labels[13] = 7;
        labels
    });
    let filled = within.unwrap().filled(&[7]);
    assert_eq!((filled.size, filled.labels), ([3, 3, 3], vec![7; 27]));
}
