//! Bodies that lose their stability are led to what they bend to.

use crate::common::statics::*;
use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::error::Instability;
use mtled::geometry::Shape;
use mtled::material::{ElasticConstants, Law, StVenantKirchhoff};
use mtled::problem::*;
use std::f64::consts::PI;

/// Displacement \[m\] of the node nearest to a place.
fn moved(solved: &Solved, place: Vector3) -> Vector3 {
    let away = |node: &usize| (solved.model.positions[*node] - place).norm();
    let nodes = 0..solved.model.positions.len();
    let node = nodes.min_by(|a, b| away(a).total_cmp(&away(b))).unwrap();
    solved.state.displacement_of(node, solved.model.components)
}

fn has_left(solved: &Solved) -> bool {
    solved.summary.instability.as_ref().is_some_and(|found: &Instability| found.passed)
}

/// A strip of twenty times its width, clamped at its lower end and pressed along its axis at the
/// other with a part of its Euler load π² E I/(4 L²).
fn pressed(part: f64) -> Problem {
    let (length, modulus) = (20.0 * EDGE, 1e6);
    let constants = ElasticConstants::from_young_poisson(modulus, 0.0).unwrap();
    let law = Law::StVenantKirchhoff(StVenantKirchhoff::new(constants));
    let mut problem = with_law(square(6), law);
    problem.recipe.gradients = Gradients::SecondOrder { tolerance: 1e-3 };
    problem.body = Shape::Box { min: Vector3::zeros(), max: Vector3::new(EDGE, length, EDGE) };
    problem.conditions.push(condition("base", face(1, 0.0), [Some(0.0); 3]));
    let euler = PI.powi(2) * modulus * EDGE.powi(2) / (48.0 * length.powi(2));
    problem.loads.tractions.push(Traction {
        name: "press".into(),
        part: face(1, length),
        traction: (-part * euler * Vector3::y()).into(),
        amplitude: Amplitude::Linear { duration: 1.0 },
    });
    problem
}

/// The end of the elastica at 1.2 and 1.5 of the Euler load over its length, along the force and
/// across: 2 E(k)/K(k) − 1 and 2 k/K(k) with K(k) = π/2 √(P/P_E) (Timoshenko, Gere 1961, section 2.7).
#[test]
fn a_pressed_strip_bends_to_the_elastica() {
    for (part, along, across) in [(1.2, 0.6739, 0.6488), (1.5, 0.3636, 0.7886)] {
        let solved = solve_by(&pressed(part), newton());
        assert!(has_left(&solved), "{:?}", solved.summary.instability);
        let length = 20.0 * EDGE;
        let end = moved(&solved, Vector3::new(0.5 * EDGE, length, 0.0)) / length;
        let place = (1.0 + end.y, end.x.abs());
        assert!((place.0 - along).abs() < 0.02 && (place.1 - across).abs() < 0.02, "{place:?}");
    }
}

#[test]
fn below_the_euler_load_a_strip_stays_straight_and_nothing_is_said() {
    let solved = solve_by(&pressed(0.9), newton());
    assert_eq!(solved.summary.instability, None);
    let end = moved(&solved, Vector3::new(0.5 * EDGE, 20.0 * EDGE, 0.0));
    assert!(end.x.abs() < 1e-6 * EDGE, "{end}");
}

/// A flat arch between two walls under its weight \[m/s²\]; it carries 8 standing.
fn arch(weight: f64) -> Problem {
    let cylinder = |radius: f64| Shape::Cylinder {
        base: Vector3::new(0.0, -0.1, -1.0),
        axis: Vector3::z(),
        radius,
        height: 2.0,
    };
    let between =
        Shape::Box { min: Vector3::new(-0.05, -0.05, -1.0), max: Vector3::new(0.05, 0.1, 1.0) };
    let ring = Shape::Difference(Box::new(cylinder(0.111)), Box::new(cylinder(0.107)));
    let mut problem = with_law(square(100), neo_hookean(1e5, 0.3));
    problem.body = Shape::Intersection(vec![ring, between]);
    for (name, at) in [("left", -0.05), ("right", 0.05)] {
        problem.conditions.push(condition(name, face(0, at), [Some(0.0); 3]));
    }
    gravity(&mut problem, -weight * Vector3::y());
    problem
}

#[test]
fn an_arch_that_snaps_hangs_where_relaxation_leaves_it() {
    for weight in [8.5, 9.0, 10.0, 14.0, 22.0, 30.0] {
        let snapped = solve_by(&arch(weight), newton());
        let relaxed = solve_by(&arch(weight), relaxation(1e-5));
        let error = difference(&snapped.state.displacement, &relaxed.state.displacement);
        assert!(error < 1e-3, "{weight}: {error:e}");
    }
}

#[test]
fn an_arch_that_is_followed_to_where_it_snaps_has_said_so() {
    for weight in [8.5, 9.0, 9.5] {
        let snapped = solve_by(&arch(weight), newton());
        assert!(has_left(&snapped), "{weight}: {:?}", snapped.summary.instability);
    }
}

/// A square column of ten times its width between two clamps, one of which shortens it by 5 %:
/// it buckles at 3.3 % (Euler). A force across it is a part of its Euler load.
fn column(across: f64) -> Problem {
    let length = 10.0 * EDGE;
    let mut problem = with_law(cube(4), neo_hookean(3000.0, 0.3));
    problem.body = Shape::Box { min: Vector3::zeros(), max: Vector3::new(length, EDGE, EDGE) };
    problem.conditions.push(condition("base", face(0, 0.0), [Some(0.0); 3]));
    let shortened = [Some(-0.05 * length), Some(0.0), Some(0.0)];
    problem.conditions.push(condition("top", face(0, length), shortened));
    let euler = 4.0 * PI.powi(2) * 3000.0 * EDGE.powi(4) / (12.0 * length.powi(2));
    gravity(&mut problem, across * euler / (1000.0 * EDGE * EDGE * length) * Vector3::y());
    problem
}

#[test]
fn a_straight_column_bends_as_far_as_one_that_is_pushed_aside() {
    let middle = |across: f64| {
        let solved = solve_by(&column(across), newton());
        moved(&solved, Vector3::new(5.0 * EDGE, 0.5 * EDGE, 0.5 * EDGE))
    };
    let (straight, pushed) = (middle(0.0), middle(1e-4));
    let (straight, pushed) = (straight.yz().norm(), pushed.yz().norm());
    assert!(pushed > 0.5 * EDGE && (straight / pushed - 1.0).abs() < 0.01, "{straight} {pushed}");
}
