//! Configurations without loads of bodies whose shape under loads is known.
#![allow(non_snake_case)]

mod common;

use common::*;
use mtled::algebra::tensor::Vector3;
use mtled::error::Error;
use mtled::geometry::{Selector, Shape};
use mtled::material::*;
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
    let count = 2000;
    let ring = |n: usize| {
        let step = (b - a) / count as f64;
        let R = a + (n as f64 + 0.5) * step;
        let square = 1.0 + c / (R * R);
        mu * (square - 1.0 / square) * R * step / (R * R + c)
    };
    let p = (0..count).map(ring).sum::<f64>();
    let (inner, outer) = (1.5, (4.0f64 + c).sqrt());
    let cylinder = |radius| Shape::Cylinder {
        base: Vector3::new(0.0, 0.0, -1.0),
        axis: Vector3::z(),
        radius,
        height: 2.0,
    };
    let without = |body, hole| Shape::Difference(Box::new(body), Box::new(hole));
    let half = |normal| Shape::HalfSpace { point: Vector3::zeros(), normal };
    let shell = without(cylinder(outer), cylinder(inner));
    let body = without(without(shell, half(Vector3::x())), half(Vector3::y()));
    let constants = ElasticConstants::from_shear_poisson(mu, 0.4995).unwrap();
    let law = NeoHookeanIsochoric::new(constants, VolumetricTerm::Quadratic);
    let law = material(Law::NeoHookeanIsochoric(law));
    let mut problem = Problem::new(body, law, Recipe::with_spacing(0.1));
    problem.dimension = Dimension::PlaneStrain { thickness: 0.01, z: 0.0 };
    problem.conditions = vec![
        condition("x0", face(0, 0.0), [Some(0.0), None, None]),
        condition("y0", face(1, 0.0), [None, Some(0.0), None]),
    ];
    let hole = Selector::Inside { shape: cylinder(inner), tolerance: 0.01 * inner };
    let faces = Selector::Union(vec![face(0, 0.0), face(1, 0.0)]);
    let part = Selector::Intersection(vec![hole, Selector::Not(Box::new(faces))]);
    let amplitude = Amplitude::Constant;
    problem.loads.pressures = vec![Pressure { name: "p".into(), part, pressure: p, amplitude }];
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
