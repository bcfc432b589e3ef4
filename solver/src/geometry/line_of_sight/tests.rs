#![allow(non_snake_case)]

use super::*;
use crate::algebra::random::Random;

fn block(min: [f64; 3], max: [f64; 3]) -> Shape {
    Shape::Box { min: Vector3::from(min), max: Vector3::from(max) }
}

/// Two blocks of 4 × 4 × 2 with a gap between z = 0 and a height.
fn two_blocks(gap: f64) -> Shape {
    let lower = block([-2.0, -2.0, -2.0], [2.0, 2.0, 0.0]);
    Shape::Union(vec![lower, block([-2.0, -2.0, gap], [2.0, 2.0, 2.0 + gap])])
}

fn is_parted(body: &Shape, a: [f64; 3], b: [f64; 3]) -> bool {
    let (a, b) = (body.place(&Vector3::from(a)), body.place(&Vector3::from(b)));
    let (there, back) = (body.parts(&a, &b, 1.0), body.parts(&b, &a, 1.0));
    assert_eq!(there, back, "{a:?} {b:?}");
    there
}

#[test]
fn a_gap_parts_what_is_above_from_what_is_below_however_narrow_it_is() {
    for gap in [1e-3, 0.003, 0.01, 0.04, 0.3, 1.0] {
        let body = two_blocks(gap);
        for below in [-0.5, -0.21, -0.05, 0.0] {
            for above in [0.0, 0.003, 0.17, 0.4] {
                for aside in [0.0, 0.05, 0.31, 0.9] {
                    let (a, b) = ([0.1, 0.0, below], [0.1 + aside, 0.02, gap + above]);
                    assert!(is_parted(&body, a, b), "gap {gap}: {a:?} to {b:?}");
                }
            }
        }
    }
}

#[test]
fn a_narrow_gap_parts_places_on_one_outer_face_or_edge() {
    for gap in [1e-3, 0.003, 0.01, 0.04, 0.3] {
        let body = two_blocks(gap);
        for y in [0.0, 0.7, 2.0] {
            for (below, above) in [(-0.5, 0.4), (-1.0, 1.0), (-0.03, 0.9), (0.0, 0.6)] {
                for aside in [0.0, -0.3, -0.9] {
                    let (a, b) = ([2.0, y, below], [2.0, y + aside, gap + above]);
                    assert!(is_parted(&body, a, b), "gap {gap}: {a:?} to {b:?}");
                }
            }
        }
    }
}

#[test]
fn places_on_a_common_face_of_blocks_that_touch_see_each_other() {
    for gap in [0.0, -1e-3, -0.3] {
        let body = two_blocks(gap);
        for y in [0.0, 2.0] {
            for aside in [0.0, -0.3] {
                let (a, b) = ([2.0, y, -0.5], [2.0, y + aside, 0.45]);
                assert!(!is_parted(&body, a, b), "gap {gap}: {a:?} to {b:?}");
            }
        }
    }
}

#[test]
fn blocks_that_touch_or_overlap_are_one() {
    for gap in [0.0, -1e-3, -0.3] {
        let body = two_blocks(gap);
        for below in [-0.5, -0.21, -0.004, 0.0] {
            for aside in [0.0, 0.3, 0.9] {
                let (a, b) = ([0.1, 0.0, below], [0.1 + aside, 0.02, 0.35]);
                assert!(!is_parted(&body, a, b), "gap {gap}: {a:?} to {b:?}");
            }
        }
    }
}

#[test]
fn ways_along_faces_and_edges_of_a_body_with_a_notch_are_clear() {
    let notch = block([0.0, -9.0, 0.0], [9.0, 9.0, 9.0]);
    let body = Shape::Difference(Box::new(block([-2.0; 3], [2.0; 3])), Box::new(notch));
    for (a, b) in [
        ([-1.0, 0.0, 2.0], [0.0, 0.5, 2.0]),
        ([0.0, -1.0, 0.0], [0.0, 0.8, 0.0]),
        ([0.0, 0.0, 0.3], [0.0, 0.7, 1.2]),
        ([2.0, 2.0, 0.0], [0.6, 2.0, 0.0]),
    ] {
        assert!(!is_parted(&body, a, b), "{a:?} to {b:?}");
    }
    assert!(is_parted(&body, [0.0, 0.0, 0.7], [0.7, 0.0, 0.0]), "across the notch");
}

#[test]
fn nodes_around_a_hole_as_wide_as_four_spacings_see_their_neighbours() {
    let hole = Shape::Cylinder {
        base: Vector3::new(0.0, 0.0, -9.0),
        axis: Vector3::z(),
        radius: 2.0,
        height: 18.0,
    };
    let body = Shape::Difference(Box::new(block([-6.0; 3], [6.0; 3])), Box::new(hole));
    let on_rim = |angle: f64| [2.0 * angle.cos(), 2.0 * angle.sin(), 0.0];
    // Along the wall it is 4 % farther.
    assert!(!is_parted(&body, on_rim(0.2), on_rim(1.2)), "a sag of a quarter of a spacing");
    assert!(is_parted(&body, on_rim(0.2), on_rim(1.6)), "walls that turn by 80°");
}

#[test]
fn places_count_as_across_a_gap_where_faces_face_each_other() {
    let body = two_blocks(0.1);
    let across =
        |a: [f64; 3], b: [f64; 3]| body.has_gap_between(&Vector3::from(a), &Vector3::from(b));
    assert!(across([0.0, 0.0, 0.0], [0.0, 0.0, 0.1]));
    assert!(across([0.0, 0.0, 0.0], [0.4, 0.0, 0.1]));
    assert!(across([2.0, 2.0, 0.0], [2.0, 2.0, 0.1]), "corners");
    assert!(!across([0.0, 0.0, 0.0], [0.4, 0.0, 0.0]));
    assert!(!across([2.0, 0.0, -0.2], [1.8, 0.0, 0.0]));
}

#[test]
fn there_and_back_are_one_way() {
    let cylinder =
        |axis: Vector3| Shape::Cylinder { base: -9.0 * axis, axis, radius: 2.0, height: 18.0 };
    let bored =
        Shape::Difference(Box::new(block([-6.0; 3], [6.0; 3])), Box::new(cylinder(Vector3::z())));
    let ball = |x: f64| Shape::Sphere { centre: Vector3::new(x, 0.0, 0.0), radius: 3.0 };
    let two_balls = Shape::Union(vec![ball(-2.9), ball(2.9)]);
    let mut random = Random(7);
    for body in [bored, two_balls] {
        let mut place = || loop {
            let X = 6.0 * random.vector(3);
            if body.signed_distance(&X) <= 0.0 {
                return body.place(&X);
            }
        };
        for _ in 0..2000 {
            let (a, b) = (place(), place());
            assert_eq!(body.parts(&a, &b, 1.0), body.parts(&b, &a, 1.0), "{a:?} {b:?}");
        }
    }
}
