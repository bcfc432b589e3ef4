#![allow(non_snake_case)]

use super::gauss::gauss_legendre;
use super::*;
use crate::algebra::tensor::{Matrix3, Vector3};
use crate::error::Error;
use crate::geometry::{GeometryError, LabelMap, Selector, Shape};
use crate::material::{ElasticConstants, Law, Material, NeoHookeanLogJ};
use crate::problem::{BackgroundGrid, Dimension, InsideRule, Refinement, Region};
use std::sync::Arc;

fn region(name: &str, part: Selector) -> Region {
    let constants = ElasticConstants::from_young_poisson(1e3, 0.3).unwrap();
    let law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants));
    Region::new(name, part, Material { density: 1e3, law })
}

fn ball() -> Shape {
    Shape::Sphere { centre: Vector3::new(0.3, 0.1, -0.2), radius: 0.04 }
}

#[test]
fn gauss_rules_integrate_the_powers_that_they_should() {
    for n in 1..=5 {
        let rule = gauss_legendre(n);
        assert_eq!(rule.len(), n);
        for power in 0..2 * n {
            let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(power as i32)).sum();
            let exact = match power % 2 {
                0 => 0.5f64.powi(power as i32) / (power + 1) as f64,
                _ => 0.0,
            };
            assert!((sum - exact).abs() < 1e-15, "{n} points, power {power}");
        }
    }
}

#[test]
fn volume_fractions_measure_a_sphere_and_its_centroid() {
    let q = quadrature(
        &ball(),
        &[region("all", Selector::All)],
        &BackgroundGrid::with_cell(0.011),
        &Dimension::Three,
    )
    .unwrap();
    let volume: f64 = q.weights.iter().sum();
    let exact = 4.0 / 3.0 * std::f64::consts::PI * 0.04f64.powi(3);
    assert!((volume / exact - 1.0).abs() < 2e-3, "{}", volume / exact);
    let moment: Vector3 = q.positions.iter().zip(&q.weights).map(|(X, w)| X * *w).sum();
    assert!((moment / volume - Vector3::new(0.3, 0.1, -0.2)).norm() < 1e-5);
}

#[test]
fn points_of_a_box_do_not_hang_on_where_it_lies() {
    let points = |lower: Vector3| {
        let body = Shape::Box { min: lower, max: lower + Vector3::new(0.8, 1.0, 0.61) };
        let all = [region("all", Selector::All)];
        let grid = BackgroundGrid::with_cell(0.17);
        quadrature(&body, &all, &grid, &Dimension::Three).unwrap()
    };
    let home = points(Vector3::zeros());
    for shift in [Vector3::new(3.1, -2.3, 1.7), Vector3::new(-0.77, 5.1, 0.013)] {
        let there = points(shift);
        assert_eq!(home.positions.len(), there.positions.len());
        for (X, Y) in home.positions.iter().zip(&there.positions) {
            // Along the edges two faces are equally near.
            assert!((X + shift - Y).norm() < 1e-12, "{X} {Y}");
        }
    }
}

#[test]
fn volume_fractions_are_exact_for_a_box_off_the_grid() {
    let min = Vector3::new(0.01, 0.02, 0.0);
    let max = Vector3::new(0.113, 0.087, 0.05);
    let body = Shape::Box { min, max };
    let q = quadrature(
        &body,
        &[region("all", Selector::All)],
        &BackgroundGrid::with_cell(0.02),
        &Dimension::Three,
    )
    .unwrap();
    let volume: f64 = q.weights.iter().sum();
    assert!((volume / (max - min).product() - 1.0).abs() < 1e-3);
}

#[test]
fn the_centre_rule_keeps_whole_cells_only() {
    let mut grid = BackgroundGrid::with_cell(0.01);
    grid.inside = InsideRule::Centre;
    let q = quadrature(&ball(), &[region("all", Selector::All)], &grid, &Dimension::Three).unwrap();
    assert!(q.weights.iter().all(|w| (w - 1e-6).abs() < 1e-18));
    assert!(q.positions.iter().all(|X| ball().signed_distance(X) <= 0.0));
}

#[test]
fn cells_are_halved_near_the_boundary_and_in_chosen_parts() {
    let mut grid = BackgroundGrid::with_cell(0.02);
    grid.inside = InsideRule::Centre;
    grid.boundary_cell = Some(0.01);
    let core = Shape::Sphere { centre: Vector3::new(0.3, 0.1, -0.2), radius: 0.012 };
    grid.refinements =
        vec![Refinement { part: Selector::Inside { shape: core, tolerance: 0.0 }, size: 0.005 }];
    let q = quadrature(&ball(), &[region("all", Selector::All)], &grid, &Dimension::Three).unwrap();
    for edge in [0.005f64, 0.01] {
        assert!(q.weights.iter().any(|w| (w / edge.powi(3) - 1.0).abs() < 1e-9), "{edge}");
    }
}

#[test]
fn a_cell_on_a_border_is_divided_among_its_regions() {
    let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(0.1) };
    let left = Shape::HalfSpace { point: Vector3::new(0.033, 0.0, 0.0), normal: Vector3::x() };
    let regions = [
        region("left", Selector::Inside { shape: left, tolerance: 0.0 }),
        region("right", Selector::All),
    ];
    let q =
        quadrature(&body, &regions, &BackgroundGrid::with_cell(0.02), &Dimension::Three).unwrap();
    let volume: f64 =
        q.weights.iter().zip(&q.regions).filter(|(_, r)| **r == 0).map(|(w, _)| w).sum();
    assert!((volume / (0.033 * 0.01) - 1.0).abs() < 0.02, "{volume}");
}

/// A label map over a unit cube whose voxels between two heights along z are 2, the others 1.
fn voxels_between(low: f64, high: f64, count: usize) -> Selector {
    let voxel = 1.0 / count as f64;
    let height = |n: usize| voxel * ((n / (count * count)) as f64 + 0.5);
    let label = |n: usize| 1 + u32::from(height(n) > low && height(n) < high);
    let labels = (0..count.pow(3)).map(label).collect();
    let (origin, directions) = (Vector3::repeat(0.5 * voxel), Matrix3::identity() * voxel);
    let map = LabelMap::new([count; 3], origin, directions, labels).unwrap();
    Selector::Label { map: Arc::new(map), label: 2 }
}

#[test]
fn layers_have_their_volume_and_every_point_lies_in_its_region_however_thin_they_are() {
    let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(1.0) };
    let between = |low: f64, high: f64| {
        let point = Vector3::new(0.5, 0.5, 0.5 * (low + high));
        Selector::Plane { point, normal: Vector3::z(), tolerance: 0.5 * (high - low) }
    };
    for (low, thickness) in [(0.5, 0.2), (0.46, 0.08), (0.48, 0.02), (0.3, 0.04), (0.02, 0.06)] {
        let high = low + thickness;
        for part in [between(low, high), voxels_between(low, high, 50)] {
            let regions = [region("layer", part), region("rest", Selector::All)];
            let grid = BackgroundGrid::with_cell(0.13);
            let q = quadrature(&body, &regions, &grid, &Dimension::Three).unwrap();
            let own = q.regions.iter().zip(&q.weights).filter(|(region, _)| **region == 0);
            let volume: f64 = own.map(|(_, weight)| weight).sum();
            assert!((volume - thickness).abs() < 1e-6, "{low} {high}: {volume}");
            for (X, &region) in q.positions.iter().zip(&q.regions) {
                let found = super::borders::owner(&regions, X);
                assert_eq!(found, Some(usize::from(region)), "{low} {high}: {X}");
            }
        }
    }
}

#[test]
fn a_plane_slice_has_the_volume_of_its_slab() {
    let body =
        Shape::Cylinder { base: Vector3::zeros(), axis: Vector3::z(), radius: 0.05, height: 0.02 };
    let plane = Dimension::PlaneStrain { thickness: 0.005, z: 0.01 };
    let q = quadrature(
        &body,
        &[region("all", Selector::All)],
        &BackgroundGrid::with_cell(0.011),
        &plane,
    )
    .unwrap();
    let volume: f64 = q.weights.iter().sum();
    let exact = std::f64::consts::PI * 0.05f64.powi(2) * 0.005;
    assert!((volume / exact - 1.0).abs() < 2e-3, "{}", volume / exact);
    // A centroid is a weighted mean: round-off of the last digits.
    assert!(q.positions.iter().all(|X| (X.z - 0.01).abs() < 1e-16));
}

/// Why a grid over the ball is refused.
fn refusal(grid: &BackgroundGrid) -> GeometryError {
    let region = region("all", Selector::All);
    match quadrature(&ball(), &[region], grid, &Dimension::Three) {
        Err(Error::Geometry(error)) => error,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_grid_of_too_many_cells_is_refused_before_any_is_made() {
    for cell in [1e-5, 1e-150, 1e-300] {
        let error = refusal(&BackgroundGrid::with_cell(cell));
        assert!(
            matches!(error, GeometryError::TooMany { what: "background cells", .. }),
            "{error}"
        );
    }
    let error = refusal(&BackgroundGrid { gauss_points: 5, ..BackgroundGrid::with_cell(2e-4) });
    assert!(matches!(error, GeometryError::TooMany { what: "quadrature points", .. }), "{error}");
}

#[test]
fn a_small_part_of_tiny_cells_is_refused_before_any_is_made() {
    let part = |radius: f64| Selector::Inside {
        shape: Shape::Sphere { centre: Vector3::new(0.301, 0.102, -0.203), radius },
        tolerance: 0.0,
    };
    let with = |radius: f64, size: f64| BackgroundGrid {
        refinements: vec![Refinement { part: part(radius), size }],
        ..BackgroundGrid::with_cell(0.005)
    };
    for size in [1e-7, 1e-300] {
        let error = refusal(&with(0.003, size));
        let GeometryError::TooMany { what: "quadrature points", count, .. } = error else {
            panic!("{error}")
        };
        assert!(count > 1e11, "{count:e}");
    }
    let boundary = BackgroundGrid { boundary_cell: Some(1e-8), ..BackgroundGrid::with_cell(0.01) };
    let error = refusal(&boundary);
    assert!(matches!(error, GeometryError::TooMany { what: "quadrature points", .. }), "{error}");
    let region = [region("all", Selector::All)];
    assert!(quadrature(&ball(), &region, &with(0.003, 0.002), &Dimension::Three).is_ok());
}

#[test]
fn sizes_of_cells_that_are_no_lengths_are_refused() {
    for size in [0.0, -1.0, f64::NAN] {
        let refinements = vec![Refinement { part: Selector::All, size }];
        let plain = BackgroundGrid::with_cell(0.01);
        for grid in [
            BackgroundGrid::with_cell(size),
            BackgroundGrid { boundary_cell: Some(size), ..plain.clone() },
            BackgroundGrid { refinements, ..plain },
        ] {
            let error = refusal(&grid);
            assert!(matches!(error, GeometryError::NotPositive { .. }), "{error}");
        }
    }
    for gauss_points in [0, 6] {
        let grid = BackgroundGrid { gauss_points, ..BackgroundGrid::with_cell(0.01) };
        assert_eq!(refusal(&grid), GeometryError::GaussPoints { count: gauss_points });
    }
}

/// ∫ |X − centre|² dV of a rule.
fn second_moment(q: &Quadrature, centre: &Vector3) -> f64 {
    q.positions.iter().zip(&q.weights).map(|(X, w)| w * (X - centre).norm_squared()).sum()
}

#[test]
fn moved_points_integrate_functions_of_second_order() {
    let grid = BackgroundGrid::with_cell(0.0113);
    let mut refined = grid.clone();
    let part = Selector::Inside { shape: ball(), tolerance: 0.0 };
    refined.refinements = vec![Refinement { part, size: 0.006 }];
    let (min, max) = (Vector3::new(0.24, 0.05, -0.25), Vector3::new(0.36, 0.13, -0.15));
    let edges = max - min;
    let block = edges.product() * edges.norm_squared() / 12.0;
    let sphere = 0.8 * std::f64::consts::PI * 0.04f64.powi(5);
    for (body, grid, middle, exact, bound) in [
        (Shape::Box { min, max }, &grid, 0.5 * (min + max), block, 0.05),
        (Shape::Box { min, max }, &refined, 0.5 * (min + max), block, 0.1),
        (ball(), &grid, Vector3::new(0.3, 0.1, -0.2), sphere, 0.25),
    ] {
        let regions = [region("all", Selector::All)];
        let unknown = NodalSpacing {
            within: &|_, _| f64::INFINITY,
            largest: f64::INFINITY,
            beside_gap: &|_| false,
        };
        let error = |moves: Option<&Moves>| {
            let q = quadrature_following(&body, &regions, grid, &unknown, &Dimension::Three, moves);
            second_moment(&q.unwrap(), &middle) / exact - 1.0
        };
        let (at_centroids, moved) = (error(None), error(Some(&Moves { stays: &|_| false })));
        assert!(moved.abs() < bound * at_centroids.abs(), "{moved} after {at_centroids}");
        assert_eq!(error(Some(&Moves { stays: &|_| true })), at_centroids);
    }
}

#[test]
fn moved_points_stay_in_the_plane_and_in_their_regions() {
    let dimension = Dimension::PlaneStrain { thickness: 0.1, z: 0.0 };
    let body = Shape::Ellipsoid {
        centre: Vector3::new(0.3, 0.1, 0.0),
        radii: Vector3::new(0.05, 0.03, f64::INFINITY),
    };
    let grid = BackgroundGrid::with_cell(0.007);
    let unknown = NodalSpacing {
        within: &|_, _| f64::INFINITY,
        largest: f64::INFINITY,
        beside_gap: &|_| false,
    };
    for step in 0..14 {
        // Across a cell, so that the pieces on either side become thin.
        let point = Vector3::new(0.3 + 5e-4 * f64::from(step), 0.0, 0.0);
        let left = Shape::HalfSpace { point, normal: Vector3::x() };
        let part = Selector::Inside { shape: left.clone(), tolerance: 0.0 };
        let regions = [region("left", part), region("rest", Selector::All)];
        let rule = |moves: Option<&Moves>| {
            quadrature_following(&body, &regions, &grid, &unknown, &dimension, moves).unwrap()
        };
        let (before, after) = (rule(None), rule(Some(&Moves { stays: &|_| false })));
        assert!(before.positions != after.positions);
        assert_eq!((&before.weights, &before.regions), (&after.weights, &after.regions));
        for (X, region) in after.positions.iter().zip(&after.regions) {
            assert!(X.z == 0.0 && body.signed_distance(X) <= 0.0, "{X}");
            assert_eq!(left.signed_distance(X) <= 0.0, *region == 0, "{point}: {X}");
        }
    }
}
