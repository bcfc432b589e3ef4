#![allow(non_snake_case)]

use super::*;
use crate::algebra::tensor::Vector3;
use crate::geometry::Selector;
use crate::problem::Refinement;

const PLANE: Dimension = Dimension::PlaneStrain { thickness: 0.5, z: 0.05 };

fn brick() -> Shape {
    Shape::Box { min: Vector3::zeros(), max: Vector3::new(1.0, 0.5, 0.25) }
}

fn ball() -> Shape {
    Shape::Sphere { centre: Vector3::new(0.1, 0.0, 0.05), radius: 0.5 }
}

fn l_shape() -> Shape {
    let points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.5, 0.5], [0.5, 1.0], [0.0, 1.0]];
    Shape::Polygon { points: points.into(), z: (0.0, 0.3) }
}

fn bodies() -> Vec<(&'static str, Shape, Dimension)> {
    vec![
        ("brick", brick(), Dimension::Three),
        ("rectangle", brick(), PLANE),
        ("ball", ball(), Dimension::Three),
        ("disc", ball(), PLANE),
        ("prism", l_shape(), Dimension::Three),
        ("L", l_shape(), PLANE),
    ]
}

/// Distance to the nearest other node over the node's spacing.
fn nearest(cloud: &NodeCloud) -> Vec<f64> {
    let positions = &cloud.positions;
    let distance = |n: usize, m: usize| (positions[n] - positions[m]).norm();
    (0..positions.len())
        .map(|n| {
            let others = (0..positions.len()).filter(|&m| m != n);
            others.map(|m| distance(n, m)).fold(f64::INFINITY, f64::min) / cloud.spacing[n]
        })
        .collect()
}

/// Largest distance from a point of the body to a node, over the spacing.
fn largest_hole(body: &Shape, cloud: &NodeCloud, dimension: &Dimension) -> f64 {
    let section = body.section(dimension).unwrap();
    let (lower, upper) = section.finite_bounds(dimension).unwrap();
    let mut worst = 0.0_f64;
    let layers = if *dimension == Dimension::Three { 20 } else { 0 };
    for n in 0..=40 * 40 * (layers + 1) {
        let ijk = [n % 41, n / 41 % 41, n / (41 * 41)];
        let most = [40, 40, layers.max(1)];
        let X = Vector3::from_fn(|k, _| {
            lower[k] + (upper[k] - lower[k]) * ijk[k].min(most[k]) as f64 / most[k] as f64
        });
        if section.signed_distance(&X) <= 0.0 {
            let scaled = cloud.positions.iter().zip(&cloud.spacing);
            worst =
                worst.max(scaled.map(|(p, h)| (p - X).norm() / h).fold(f64::INFINITY, f64::min));
        }
    }
    worst
}

#[test]
fn a_regular_cloud_in_a_box_includes_its_faces() {
    let cloud = node_cloud(&brick(), &Cloud::Regular { spacing: 0.1 }, &Dimension::Three).unwrap();
    // 0.25/0.1 rounds to 3 cells (half away from zero).
    assert_eq!(cloud.positions.len(), 11 * 6 * 4);
    assert_eq!(cloud.on_boundary.iter().filter(|b| !**b).count(), 9 * 4 * 2);
    for (X, on_boundary) in cloud.positions.iter().zip(&cloud.on_boundary) {
        assert_eq!(*on_boundary, brick().signed_distance(X) == 0.0);
    }
    let plane = node_cloud(&brick(), &Cloud::Regular { spacing: 0.1 }, &PLANE).unwrap();
    assert_eq!(plane.positions.len(), 11 * 6);
    assert_eq!(plane.on_boundary.iter().filter(|b| !**b).count(), 9 * 4);
    assert!(plane.positions.iter().all(|X| X.z == 0.05));
    assert_eq!(plane.spacing[0], 0.1);
}

#[test]
fn nodes_keep_their_distance_and_leave_no_holes() {
    for (name, body, dimension) in bodies() {
        for (kind, cloud, least, hole) in [
            ("regular", Cloud::Regular { spacing: 0.06 }, 0.49, 1.1),
            ("jittered", Cloud::Jittered { spacing: 0.06, jitter: 0.2, seed: 5 }, 0.2, 1.3),
            (
                "graded",
                Cloud::Graded { spacing: 0.06, refinements: vec![], growth: 0.5, seed: 0 },
                0.5,
                1.2,
            ),
            (
                "graded, moved",
                Cloud::Graded { spacing: 0.06, refinements: vec![], growth: 0.5, seed: 7 },
                0.5,
                1.2,
            ),
        ] {
            let nodes = node_cloud(&body, &cloud, &dimension).unwrap();
            let closest = nearest(&nodes).into_iter().fold(f64::INFINITY, f64::min);
            let widest = largest_hole(&body, &nodes, &dimension);
            assert!(closest > least, "{kind} {name}: nodes {closest} spacings apart");
            assert!(widest < hole, "{kind} {name}: a hole of {widest} spacings");
        }
    }
}

#[test]
fn jitter_moves_nodes_as_the_seed_says_and_keeps_corners_and_boundary() {
    for (name, body, dimension) in bodies() {
        let cloud = |seed: u64| {
            let cloud = Cloud::Jittered { spacing: 0.1, jitter: 0.3, seed };
            node_cloud(&body, &cloud, &dimension).unwrap()
        };
        let (first, again, other) = (cloud(1), cloud(1), cloud(2));
        assert_eq!(first, again, "{name}");
        assert_ne!(first, other, "{name}");
        let still = node_cloud(&body, &Cloud::Regular { spacing: 0.1 }, &dimension).unwrap();
        let section = body.section(&dimension).unwrap();
        let mut moved = 0;
        for n in 0..first.positions.len() {
            let distance = section.signed_distance(&first.positions[n]);
            assert_eq!(first.on_boundary[n], distance.abs() < 1e-8, "{name}: {distance}");
            assert!(distance < 1e-8, "{name}: {distance}");
            moved += usize::from(first.positions[n] != still.positions[n]);
        }
        assert!(2 * moved > first.positions.len(), "{name}: {moved} moved");
        if let Shape::Polygon { .. } | Shape::Box { .. } = body {
            let corner = Vector3::new(1.0, 0.5, still.positions[0].z);
            assert!(first.positions.iter().any(|X| (X - corner).norm() < 1e-12), "{name}");
        }
    }
}

#[test]
fn a_graded_cloud_follows_the_target_size() {
    let part = Selector::Inside {
        shape: Shape::Sphere { centre: Vector3::new(0.0, 0.0, 0.05), radius: 0.2 },
        tolerance: 0.0,
    };
    let refinements = vec![Refinement { part, size: 0.03 }];
    let graded = Cloud::Graded { spacing: 0.1, refinements, growth: 0.3, seed: 0 };
    for dimension in [PLANE, Dimension::Three] {
        let cloud = node_cloud(&l_shape(), &graded, &dimension).unwrap();
        for (X, spacing) in cloud.positions.iter().zip(&cloud.spacing) {
            let away = ((X - Vector3::new(0.0, 0.0, 0.05)).norm() - 0.2).max(0.0);
            let target = (0.03 + 0.3 * away).min(0.1);
            assert!((spacing - target).abs() < 0.012, "{spacing} instead of {target} at {X:?}");
        }
        let near = nearest(&cloud);
        let mean = near.iter().sum::<f64>() / near.len() as f64;
        assert!((0.75..1.15).contains(&mean), "{mean}");
        assert!(near.iter().all(|d| (0.5..1.6).contains(d)));
        assert!(largest_hole(&l_shape(), &cloud, &dimension) < 1.35);
    }
}

#[test]
fn given_nodes_keep_their_positions() {
    let lattice =
        node_cloud(&brick(), &Cloud::Regular { spacing: 0.125 }, &Dimension::Three).unwrap();
    let given =
        |nodes: Vec<Vector3>| node_cloud(&brick(), &Cloud::Given { nodes }, &Dimension::Three);
    let cloud = given(lattice.positions.clone()).unwrap();
    assert_eq!(cloud.positions, lattice.positions);
    assert_eq!(cloud.on_boundary, lattice.on_boundary);
    let middle = cloud.on_boundary.iter().position(|b| !b).unwrap();
    assert!((cloud.spacing[middle] - 0.125).abs() < 1e-12);

    let mut outside = lattice.positions.clone();
    outside[17] = Vector3::new(2.0, 0.0, 0.0);
    outside.push(Vector3::new(3.0, 0.0, 0.0));
    let error = given(outside).unwrap_err();
    assert!(!matches!(error, GeometryError::DuplicateNodes { .. }), "{error}");
    let mut outside = lattice.positions.clone();
    outside[17].z = -0.4;
    assert!(matches!(given(outside), Ok(_) | Err(GeometryError::NodeOutside { node: 17, .. })));
    let mut double = lattice.positions.clone();
    double[9] = double[4];
    let error = given(double).unwrap_err();
    assert_eq!(error, GeometryError::DuplicateNodes { first: 4, second: 9, distance: 0.0 });
    assert_eq!(given(vec![]).unwrap_err(), GeometryError::NoNodes);
    let error = given(vec![Vector3::zeros()]).unwrap_err();
    assert_eq!(error, GeometryError::TooFewNodes { count: 1, needed: 4 });
}

#[test]
fn invalid_clouds_are_refused() {
    let refused = |cloud: Cloud| node_cloud(&ball(), &cloud, &Dimension::Three).unwrap_err();
    for spacing in [0.0, -1.0, f64::NAN] {
        let error = refused(Cloud::Regular { spacing });
        assert!(matches!(error, GeometryError::NotPositive { .. }));
    }
    let error = refused(Cloud::Jittered { spacing: 0.1, jitter: 0.5, seed: 0 });
    assert_eq!(error, GeometryError::Jitter { jitter: 0.5 });
    let error = refused(Cloud::Regular { spacing: 1e-4 });
    assert!(matches!(error, GeometryError::TooMany { what: "nodes", .. }), "{error}");
    let nowhere = Selector::Inside {
        shape: Shape::Sphere { centre: Vector3::new(9.0, 0.0, 0.0), radius: 0.1 },
        tolerance: 0.0,
    };
    let refinements = vec![Refinement { part: nowhere, size: 0.05 }];
    let error = refused(Cloud::Graded { spacing: 0.1, refinements, growth: 0.2, seed: 0 });
    assert_eq!(error, GeometryError::RefinementEmpty { refinement: 0, size: 0.05 });
}

#[test]
fn a_node_far_outside_is_named_before_its_neighbours_are_searched() {
    let cloud = Cloud::Regular { spacing: 0.125 };
    let nodes = node_cloud(&brick(), &cloud, &Dimension::Three).unwrap().positions;
    for far in [7.0, 1e160, 1e308] {
        let mut nodes = nodes.clone();
        nodes[5].y = -far;
        let error = node_cloud(&brick(), &Cloud::Given { nodes }, &Dimension::Three).unwrap_err();
        assert!(matches!(error, GeometryError::NodeFarOutside { node: 5, .. }), "{error}");
    }
}

#[test]
fn a_graded_cloud_has_no_other_nodes_where_round_off_makes_the_body_larger() {
    let cloud = |size: f64| {
        let body = Shape::Box { min: Vector3::zeros(), max: Vector3::new(1.0, 0.6, 0.8) * size };
        let refinements = Vec::new();
        let graded = Cloud::Graded { spacing: 0.2 * size, refinements, growth: 0.25, seed: 0 };
        node_cloud(&body, &graded, &Dimension::Three).unwrap()
    };
    let home = cloud(1.0);
    for size in [1.0 + 1e-13, 1.0 - 1e-13, 0.7, 1.3] {
        assert_eq!(home.positions.len(), cloud(size).positions.len(), "{size}");
    }
}

#[test]
fn lattice_nodes_half_a_spacing_from_the_boundary_do_not_hang_on_round_off() {
    let cloud = |size: f64| {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.5, 0.5], [0.5, 1.0], [0.0, 1.0]];
        let points = corners.map(|c| c.map(|c| size * c)).to_vec();
        let body = Shape::Polygon { points: points.into(), z: (0.0, 0.6 * size) };
        node_cloud(&body, &Cloud::Regular { spacing: 0.2 * size }, &Dimension::Three).unwrap()
    };
    let home = cloud(1.0);
    for size in [1.0 + 1e-13, 1.0 - 1e-13, 0.7, 1.3, 0.01, 0.3] {
        assert_eq!(home.positions.len(), cloud(size).positions.len(), "{size}");
    }
}

#[test]
fn edges_of_whole_and_a_half_spacings_are_divided_alike_wherever_the_body_lies() {
    let cloud = |at: Vector3| {
        let block = Shape::Box { min: at, max: at + Vector3::new(0.1, 0.05, 0.05) };
        let ball = Shape::Sphere { centre: at + Vector3::new(0.1, 0.02, 0.02), radius: 0.04 };
        let body = Shape::Union(vec![block, ball]);
        node_cloud(&body, &Cloud::Regular { spacing: 0.02 / 3.0 }, &Dimension::Three).unwrap()
    };
    let home = cloud(Vector3::zeros());
    for at in [[0.1, 0.2, 0.3], [-0.0137, 0.0211, 0.5], [-7.3, 6.9, 5.2], [1000.0, -1000.0, 500.0]]
    {
        assert_eq!(home.positions.len(), cloud(at.into()).positions.len(), "{at:?}");
    }
}
