//! Loads on parts, areas of composites, and volumes of regions, against closed forms.
#![allow(non_snake_case)]

use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::Discretisation;
use mtled::error::Error;
use mtled::geometry::{Selector, Shape};
use mtled::material::*;
use mtled::model::Model;
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::problem::*;
use std::f64::consts::PI;

/// Numbers in [0, 1), SplitMix64.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn vector(&mut self, reach: f64) -> Vector3 {
        Vector3::from_fn(|_, _| self.between(-reach, reach))
    }

    fn direction(&mut self) -> Vector3 {
        loop {
            let v = self.vector(1.0);
            if (0.1..1.0).contains(&v.norm()) {
                return v.normalize();
            }
        }
    }

    fn solid(&mut self) -> Shape {
        let centre = self.vector(0.3);
        match (4.0 * self.next()) as usize {
            0 => Shape::Sphere { centre, radius: self.between(0.4, 0.7) },
            1 => {
                let reach = Vector3::from_fn(|_, _| self.between(0.3, 0.6));
                Shape::Box { min: centre - reach, max: centre + reach }
            }
            2 => {
                Shape::Ellipsoid { centre, radii: Vector3::from_fn(|_, _| self.between(0.4, 0.8)) }
            }
            _ => {
                let axis = self.direction();
                let (radius, height) = (self.between(0.3, 0.5), self.between(0.6, 1.2));
                Shape::Cylinder { base: centre - 0.5 * height * axis, axis, radius, height }
            }
        }
    }

    /// Two or three solids together, in common or one without the others, cut by a plane.
    fn body(&mut self) -> Shape {
        let (first, second) = (self.solid(), self.solid());
        let body = match (3.0 * self.next()) as usize {
            0 => Shape::Union(vec![first, second, self.solid()]),
            1 => Shape::Intersection(vec![first, second]),
            _ => Shape::Difference(Box::new(first), Box::new(second)),
        };
        let plane = Shape::HalfSpace { point: self.vector(0.1), normal: self.direction() };
        Shape::Intersection(vec![body, plane])
    }
}

/// Volume by the fractions of small cubes [m³].
fn volume(body: &Shape, step: f64) -> f64 {
    let (lower, upper) = body.bounding_box().unwrap();
    let count = ((upper - lower) / step).map(f64::ceil);
    let mut sum = 0.0;
    for k in 0..count.z as usize {
        for j in 0..count.y as usize {
            for i in 0..count.x as usize {
                let at = Vector3::new(i as f64, j as f64, k as f64) + Vector3::repeat(0.5);
                let distance = body.signed_distance(&(lower + step * at));
                sum += (0.5 - distance / step).clamp(0.0, 1.0);
            }
        }
    }
    sum * step.powi(3)
}

#[test]
fn surfaces_of_random_bodies_are_closed_and_enclose_their_volume() {
    let mut numbers = Numbers(7);
    let mut bodies = 0;
    while bodies < 50 {
        let body = numbers.body();
        let expected = volume(&body, 0.016);
        if expected < 0.03 {
            continue;
        }
        bodies += 1;
        let panels = body.boundary_panels(0.1, &Dimension::Three).unwrap();
        let area: f64 = panels.iter().map(|p| p.area).sum();
        let total: Vector3 = panels.iter().map(|p| p.area * p.mean_normal()).sum();
        assert!(total.norm() < 5e-4 * area, "∮ N dA = {} of {area}: {body:?}", total.norm());
        let flux: f64 = panels.iter().map(|p| p.area * p.centre.dot(&p.mean_normal())).sum();
        let error = (flux / 3.0 - expected).abs();
        // Of a cube on an edge the lesser of two fractions counts, a twelfth of it too much.
        assert!(error < 1e-3 * expected + 3e-4 * area, "{} of {expected}: {body:?}", flux / 3.0);
    }
}

/// A cube held at the bottom, with a part of its top about a place off the nodes.
fn held_cube(cells: usize) -> Problem {
    let mut problem = cube(cells);
    problem.conditions = vec![condition("bottom", face(2, 0.0), [Some(0.0); 3])];
    problem
}

/// A square of the top face.
fn square_of_top(edge: f64) -> Selector {
    let centre = Vector3::new(0.47 * EDGE, 0.53 * EDGE, EDGE);
    let reach = Vector3::repeat(0.5 * edge);
    Selector::Inside {
        shape: Shape::Box { min: centre - reach, max: centre + reach },
        tolerance: 1e-9 * EDGE,
    }
}

fn total(forces: &[f64]) -> Vector3 {
    (0..forces.len() / 3).map(|node| vector_at(forces, node, 3)).sum()
}

#[test]
fn a_traction_or_a_pressure_on_a_part_of_any_size_has_the_force_of_its_area() {
    for cells in [4, 7] {
        let h = EDGE / cells as f64;
        for edge in [3.0, 1.2, 0.8, 0.2, 0.02].map(|edge| edge * h) {
            let mut problem = held_cube(cells);
            let part = square_of_top(edge);
            problem.loads.tractions = vec![Traction {
                name: "part".into(),
                part: part.clone(),
                traction: Vector3::new(10.0, 0.0, 5.0).into(),
                amplitude: Amplitude::Constant,
            }];
            problem.loads.pressures = vec![Pressure {
                name: "part".into(),
                part,
                pressure: 7.0,
                amplitude: Amplitude::Constant,
            }];
            let (_, model) = build(&problem);
            let expected = Vector3::new(10.0, 0.0, 5.0) * edge * edge;
            let error = (total(&model.loads[0].force) - expected).norm();
            assert!(error < 1e-3 * expected.norm(), "{edge} of {h}: {error}");
            let mut force = vec![0.0; model.size()];
            let at_rest = force.clone();
            model.following.pressures[0].add_force(0.0, &at_rest, 3, &mut force);
            let expected = Vector3::z() * (-7.0 * edge * edge);
            let error = (total(&force) - expected).norm();
            assert!(error < 2e-3 * expected.norm(), "{edge} of {h}: {error}");
        }
    }
}

#[test]
fn a_part_is_loaded_about_its_own_middle() {
    let mut problem = held_cube(5);
    let edge = 0.3 * EDGE / 5.0;
    problem.loads.tractions = vec![Traction {
        name: "part".into(),
        part: square_of_top(edge),
        traction: Vector3::z().into(),
        amplitude: Amplitude::Constant,
    }];
    let (_, model) = build(&problem);
    let forces = &model.loads[0].force;
    let weighted = |node: usize| model.positions[node] * forces[3 * node + 2];
    let middle = (0..model.positions.len()).map(weighted).sum::<Vector3>() / (edge * edge);
    let expected = Vector3::new(0.47 * EDGE, 0.53 * EDGE, EDGE);
    assert!((middle - expected).norm() < 2e-3 * edge, "{middle} {expected}");
}

#[test]
fn a_body_force_on_a_part_of_any_size_has_the_mass_of_the_part() {
    for cells in [4, 7] {
        let h = EDGE / cells as f64;
        for size in [3.0, 2.0, 1.2, 0.8, 0.4].map(|size| size * h) {
            let centre = Vector3::new(0.47, 0.53, 0.51) * EDGE;
            let reach = Vector3::repeat(0.5 * size);
            let cube = Shape::Box { min: centre - reach, max: centre + reach };
            let ball = Shape::Sphere { centre, radius: 0.5 * size };
            // The surface of a ball is cut as flat in cells where it bends by at most 0.4 % of their edge.
            for (shape, volume, tolerance) in [(cube, 1.0, 1e-6), (ball, PI / 6.0, 0.005)] {
                let mut problem = held_cube(cells);
                problem.loads.body_forces = vec![BodyForce {
                    part: Selector::Inside { shape, tolerance: 0.0 },
                    acceleration: Vector3::x().into(),
                    amplitude: Amplitude::Constant,
                }];
                let (_, model) = build(&problem);
                let density = problem.regions[0].material.density;
                let found = total(&model.loads[0].force).x;
                let expected = density * volume * size.powi(3);
                let error = (found / expected - 1.0).abs();
                assert!(error < tolerance, "{size} of {h}: {found} of {expected}");
            }
        }
    }
}

#[test]
fn a_body_force_on_a_part_too_small_for_the_cells_is_refused_with_its_volume() {
    let mut problem = held_cube(5);
    let shape = Shape::Sphere { centre: Vector3::repeat(0.47 * EDGE), radius: 0.1 * EDGE / 5.0 };
    problem.loads.body_forces = vec![BodyForce {
        part: Selector::Inside { shape, tolerance: 0.0 },
        acceleration: Vector3::x().into(),
        amplitude: Amplitude::Constant,
    }];
    let discretisation = Discretisation::new(&problem).unwrap();
    let error = Model::new(&problem, &discretisation).unwrap_err();
    assert!(matches!(error, Error::SmallBodyForce { index: 0, .. }), "{error}");
}

#[test]
fn layers_of_any_thickness_have_their_mass_at_every_spacing() {
    for cells in [4, 7] {
        let h = EDGE / cells as f64;
        for thickness in [2.0, 1.0, 0.5, 0.25, 0.1].map(|thickness| thickness * h) {
            for foot in [0.3, 0.237, 0.361].map(|foot| foot * EDGE) {
                let mut problem = held_cube(cells);
                let layer = Shape::Box {
                    min: Vector3::new(-EDGE, -EDGE, foot),
                    max: Vector3::new(2.0 * EDGE, 2.0 * EDGE, foot + thickness),
                };
                let all = problem.regions[0].clone();
                let part = Selector::Inside { shape: layer, tolerance: 0.0 };
                problem.regions = vec![Region { name: "layer".into(), part, ..all.clone() }, all];
                let (discretisation, _) = build(&problem);
                let rule = &discretisation.quadrature;
                let own =
                    rule.weights.iter().zip(&rule.regions).filter(|(_, region)| **region == 0);
                let volume: f64 = own.map(|(weight, _)| weight).sum();
                let error = (volume / (thickness * EDGE * EDGE) - 1.0).abs();
                assert!(error < 2e-3, "{thickness} at {foot}, {h}: {error}");
            }
        }
    }
}

#[test]
fn oblique_layers_balls_and_boxes_within_a_body_have_their_volume() {
    let centre = Vector3::new(0.47, 0.53, 0.51) * EDGE;
    let normal = Vector3::new(1.0, 2.0, -2.0) / 3.0;
    for cells in [4, 7] {
        let h = EDGE / cells as f64;
        for size in [2.5, 1.2, 0.8].map(|size| size * h) {
            let reach = Vector3::repeat(0.5 * size);
            let cube = Shape::Box { min: centre - reach, max: centre + reach };
            let ball = Shape::Sphere { centre, radius: 0.5 * size };
            let side = |sign: f64| {
                let normal = sign * normal;
                Shape::HalfSpace { point: centre + 0.1 * size * normal, normal }
            };
            let slab = Shape::Intersection(vec![ball.clone(), side(1.0), side(-1.0)]);
            let r = 0.5 * size;
            let slab_volume = PI * (0.2 * size * r * r - 2.0 * (0.1 * size).powi(3) / 3.0);
            let shapes = [
                (cube, size.powi(3), 1e-6),
                (ball, PI / 6.0 * size.powi(3), 4e-3),
                (slab, slab_volume, 6e-3),
            ];
            for (shape, expected, tolerance) in shapes {
                let mut problem = held_cube(cells);
                let all = problem.regions[0].clone();
                let part = Selector::Inside { shape, tolerance: 0.0 };
                problem.regions = vec![Region { name: "part".into(), part, ..all.clone() }, all];
                let (discretisation, _) = build(&problem);
                let rule = &discretisation.quadrature;
                let own =
                    rule.weights.iter().zip(&rule.regions).filter(|(_, region)| **region == 0);
                let volume: f64 = own.map(|(weight, _)| weight).sum();
                let error = (volume / expected - 1.0).abs();
                assert!(error < tolerance, "{size} of {h}: {volume} of {expected}");
            }
        }
    }
}

#[test]
fn a_quarter_of_a_tube_has_its_area_and_volume_where_panels_end_at_its_faces_too() {
    let (inner, outer, length) = (0.03, 0.06, 0.03);
    let cylinder = |radius: f64, from: f64, to: f64| Shape::Cylinder {
        base: Vector3::z() * from,
        axis: Vector3::z(),
        radius,
        height: to - from,
    };
    let side = |normal: Vector3| Shape::HalfSpace { point: Vector3::zeros(), normal };
    let quarter = Shape::Intersection(vec![
        cylinder(outer, 0.0, length),
        side(-Vector3::x()),
        side(-Vector3::y()),
    ]);
    let hole = cylinder(inner, -0.01, length + 0.01);
    let body = Shape::Difference(Box::new(quarter), Box::new(hole));
    let ends = 0.5 * PI * (outer * outer - inner * inner);
    let expected = 0.5 * PI * (inner + outer) * length + 2.0 * (outer - inner) * length + ends;
    for size in [0.01, 0.005, 0.0047, 0.0025] {
        let panels = body.boundary_panels(size, &Dimension::Three).unwrap();
        let area: f64 = panels.iter().map(|p| p.area).sum();
        assert!((area / expected - 1.0).abs() < 1e-3, "{size}: {area} of {expected}");
        let total: Vector3 = panels.iter().map(|p| p.area * p.mean_normal()).sum();
        assert!(total.norm() < 2e-4 * area, "{size}: {total}");
        let flux: f64 = panels.iter().map(|p| p.area * p.centre.dot(&p.mean_normal())).sum();
        let volume = 0.5 * ends * length;
        assert!((flux / 3.0 / volume - 1.0).abs() < 1e-3, "{size}: {flux}");
    }
}

/// Half an ellipsoid, held on its flat side, under a pressure on the other.
fn dome(spacing: f64, pressure: f64) -> Problem {
    let body = Shape::Intersection(vec![
        Shape::Ellipsoid { centre: Vector3::zeros(), radii: Vector3::new(0.06, 0.045, 0.05) },
        Shape::HalfSpace { point: Vector3::zeros(), normal: -Vector3::z() },
    ]);
    let constants = ElasticConstants::from_young_poisson(3000.0, 0.45).unwrap();
    let law = NeoHookeanIsochoric::new(constants, VolumetricTerm::Quadratic);
    let law = material(Law::NeoHookeanIsochoric(law));
    let mut problem = Problem::new(body, law, Recipe::with_spacing(spacing));
    problem.conditions = vec![condition("base", face(2, 0.0), [Some(0.0); 3])];
    problem.loads.pressures = vec![Pressure {
        name: "dome".into(),
        part: Selector::Not(Box::new(face(2, 0.0))),
        pressure,
        amplitude: Amplitude::Linear { duration: 1.0 },
    }];
    problem.motion = Motion::Newton(Newton { tolerance: 1e-4, ..Newton::default() });
    problem
}

#[test]
fn a_pressure_that_dents_a_dome_stays_in_balance_with_its_base() {
    let problem = dome(0.0125, 700.0);
    let (_, model) = build(&problem);
    let mut state = State::new(&model);
    simulate(&model, &problem.motion, &mut state, &mut Unobserved).unwrap();
    assert!(largest(&state.displacement) > 0.001, "{}", largest(&state.displacement));
    let mut force = vec![0.0; model.size()];
    model.following.pressures[0].add_force(1.0, &state.displacement, 3, &mut force);
    // The rim does not move: the force is the pressure times the area of the base.
    let expected = Vector3::z() * (-700.0 * PI * 0.06 * 0.045);
    let error = (total(&force) - expected).norm() / expected.norm();
    assert!(error < 5e-3, "{error}");
}
