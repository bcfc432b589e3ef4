//! A quarter of a pipe in plane strain.
#![allow(non_snake_case)]

use super::*;

/// It, held on its planes of symmetry x = 0 and y = 0, and the surface of its hole.
pub fn quarter_pipe(
    (inner, outer): (f64, f64),
    (spacing, thickness): (f64, f64),
    law: Law,
) -> (Problem, Selector) {
    let cylinder = |radius| Shape::Cylinder {
        base: Vector3::new(0.0, 0.0, -1.0),
        axis: Vector3::z(),
        radius,
        height: 2.0,
    };
    let without = |body, hole| Shape::Difference(Box::new(body), Box::new(hole));
    let half = |normal| Shape::HalfSpace { point: Vector3::zeros(), normal };
    let ring = without(cylinder(outer), cylinder(inner));
    let body = without(without(ring, half(Vector3::x())), half(Vector3::y()));
    let mut problem = Problem::new(body, material(law), Recipe::with_spacing(spacing));
    problem.dimension = Dimension::PlaneStrain { thickness, z: 0.0 };
    problem.conditions = vec![
        condition("x0", face(0, 0.0), [Some(0.0), None, None]),
        condition("y0", face(1, 0.0), [None, Some(0.0), None]),
    ];
    let hole = Selector::Inside { shape: cylinder(inner), tolerance: 0.01 * inner };
    let faces = Selector::Union(vec![face(0, 0.0), face(1, 0.0)]);
    (problem, Selector::Intersection(vec![hole, Selector::Not(Box::new(faces))]))
}

/// An incompressible pipe of which r² = R² + c: p = ∫ μ(λ² − λ⁻²)/r dr over the wall, dr/r = R dR/r².
pub fn pressure_to_widen((inner, outer): (f64, f64), mu: f64, c: f64) -> f64 {
    let count = 2000;
    let ring = |n: usize| {
        let step = (outer - inner) / count as f64;
        let R = inner + (n as f64 + 0.5) * step;
        let square = 1.0 + c / (R * R);
        mu * (square - 1.0 / square) * R * step / (R * R + c)
    };
    (0..count).map(ring).sum()
}

/// Of ν = 0.4995.
pub fn nearly_incompressible(mu: f64) -> Law {
    let constants = ElasticConstants::from_shear_poisson(mu, 0.4995).unwrap();
    Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(constants, VolumetricTerm::Quadratic))
}
