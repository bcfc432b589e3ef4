use super::surface::Facet;
use super::*;
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
