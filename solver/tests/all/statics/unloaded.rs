//! Configurations without loads of bodies whose shape under loads is known.
#![allow(non_snake_case)]

use crate::common::pipe::{nearly_incompressible, pressure_to_widen, quarter_pipe};
use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::error::Error;
use mtled::geometry::Shape;
use mtled::motion::observe::Unobserved;
use mtled::problem::*;
use mtled::unloaded::{Unloading, unload};

fn tight() -> Unloading {
    Unloading { tolerance: 1e-5, ..Unloading::default() }
}

fn newton() -> Motion {
    Motion::Newton(Newton { tolerance: 1e-7, ..Newton::default() })
}

/// A quarter of a pipe in plane strain that has radii 1.5 and √(4 + 1.25) under the pressure of an
/// incompressible pipe of radii 1 and 2.
#[test]
fn a_pipe_that_was_widened_by_half_gets_its_radii_back() {
    let (a, b, mu): (f64, f64, f64) = (1.0, 2.0, 1000.0);
    let c = (1.5f64 * a).powi(2) - a * a;
    let pressure = pressure_to_widen((a, b), mu, c);
    let radii = (1.5 * a, (b * b + c).sqrt());
    let (mut problem, part) = quarter_pipe(radii, (0.1, 0.01), nearly_incompressible(mu));
    let amplitude = Amplitude::Constant;
    problem.loads.pressures = vec![Pressure { name: "p".into(), part, pressure, amplitude }];
    problem.motion = newton();
    let found = unload(&problem, tight(), &mut Unobserved).unwrap();
    assert!(found.found, "{:?}", found.distances);
    let radii = found.model.positions.iter().map(|X| X.norm());
    let (least, most) = radii.fold((f64::MAX, 0.0f64), |(l, m), r| (l.min(r), m.max(r)));
    approx::assert_relative_eq!(least, a, max_relative = 0.01);
    approx::assert_relative_eq!(most, b, max_relative = 0.01);
}

/// Loaded, and its nodes taken as those of another body of the same shape functions.
#[test]
fn a_block_under_its_weight_is_found_from_the_shape_that_it_sinks_to() {
    let mut problem = Problem::new(
        Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(EDGE) },
        material(neo_hookean(3000.0, 0.3)),
        Recipe::with_spacing(EDGE / 6.0),
    );
    problem.conditions = vec![condition("base", face(2, 0.0), [Some(0.0); 3])];
    gravity(&mut problem, Vector3::new(2.0, 0.0, -9.81));
    problem.motion = newton();
    let found = unload(&problem, tight(), &mut Unobserved).unwrap();
    assert!(found.found && found.distances.len() < 25, "{:?}", found.distances);
    let first = found.distances[0].largest;
    assert!(first > 0.05 * EDGE, "{first}");
    // What is loaded again has the known shape.
    let apart = found.offsets.iter().zip(&found.state.displacement);
    let apart = apart.fold(0.0f64, |a, (w, u)| a.max((w + u).abs()));
    assert!(apart < 1e-4 * first, "{apart:e}");
    // The mass is that of the known shape over its J.
    let mass: f64 = found.model.lumped_mass.iter().sum();
    assert!(mass > 1.02 * 1000.0 * EDGE.powi(3), "{mass}");
}

#[test]
fn what_has_no_known_shape_under_loads_is_refused_with_its_name() {
    let mut problem = cube(4);
    problem.motion = newton();
    gravity(&mut problem, Vector3::z());
    problem.obstacles = vec![floor(-1.0, Vector3::z(), Friction::Frictionless)];
    let refused = unload(&problem, tight(), &mut Unobserved).unwrap_err();
    assert!(matches!(refused, Error::NotUnloaded { what: "obstacles" }), "{refused}");
    let mut problem = cube(4);
    problem.motion = newton();
    let refused = unload(&problem, tight(), &mut Unobserved).unwrap_err();
    assert!(matches!(refused, Error::NotUnloaded { what: "bodies without loads" }), "{refused}");
}
