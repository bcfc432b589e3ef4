//! Properties of internal forces for every cloud, basis and law.
#![allow(non_snake_case)]

use crate::common::*;
use mtled::algebra::tensor::{Matrix3, Vector3, rotation};
use mtled::force::{Workspace, internal_force, stiffness_times, strain_energy};
use mtled::material::Law;
use mtled::model::Model;
use mtled::problem::{Fibres, Field, Problem, VolumetricProjection};
use proptest::prelude::*;

/// Cube and square, regular and jittered, linear and quadratic.
fn bodies() -> Vec<Problem> {
    vec![
        cube(3),
        jittered(cube(4), 0.3, 5),
        quadratic(jittered(cube(4), 0.2, 6)),
        square(6),
        jittered(square(6), 0.3, 7),
        quadratic(jittered(square(8), 0.3, 8)),
    ]
}

/// Largest force at a strain of ten per cent along x.
fn typical_force(model: &Model) -> f64 {
    largest(&forces(model, &field(model, |X| Vector3::new(0.1 * X.x, 0.0, 0.0))))
}

fn assert_no_force(problem: &Problem, u: impl Fn(&Vector3) -> Vector3) {
    for law in objective_laws() {
        let (_, model) = build(&with_law(problem.clone(), law));
        let ratio = largest(&forces(&model, &field(&model, &u))) / typical_force(&model);
        assert!(ratio < 1e-12, "{law:?}: {ratio:e}");
    }
}

#[test]
fn a_rigid_translation_gives_no_force() {
    for problem in bodies() {
        assert_no_force(&problem, |_| Vector3::new(0.03, -0.02, 0.05));
    }
}

#[test]
fn a_rigid_rotation_through_a_large_angle_gives_no_force() {
    for problem in bodies() {
        let axis = match problem.dimension.components() {
            2 => Vector3::z(),
            _ => Vector3::new(1.0, -2.0, 0.5).normalize(),
        };
        let turn = rotation(&axis, 2.1) - Matrix3::identity();
        assert_no_force(&problem, |X| turn * (X - Vector3::repeat(0.02)));
    }
}

#[test]
fn an_affine_displacement_gives_the_same_deformation_gradient_everywhere() {
    for problem in bodies() {
        let (discretisation, model) = build(&problem);
        let d = model.components;
        let mut G = Matrix3::new(0.1, -0.2, 0.05, 0.3, -0.1, 0.15, -0.25, 0.08, 0.2);
        if d == 2 {
            G.fill_column(2, 0.0);
            G.fill_row(2, 0.0);
        }
        let u = field(&model, |X| G * X);
        let expected = Matrix3::identity() + G;
        for point in 0..discretisation.supports.len() {
            let F = discretisation.supports.deformation_gradient(point, &u, d);
            assert!((F - expected).amax() < 1e-12, "{:e}", (F - expected).amax());
        }
    }
}

#[test]
fn the_internal_force_is_the_gradient_of_the_strain_energy() {
    for law in objective_laws() {
        for problem in [with_stiff_half(cube(3), law), with_stiff_half(square(5), law)] {
            let (_, model) = build(&problem);
            let u = noise(&model, 2e-3, 1);
            let v = noise(&model, 1.0, 2);
            let step = 1e-6;
            let energy = |sign: f64| {
                let moved: Vec<f64> = u.iter().zip(&v).map(|(u, v)| u + sign * step * v).collect();
                strain_energy(&model.points, &moved)
            };
            let slope = (energy(1.0) - energy(-1.0)) / (2.0 * step);
            let f = forces(&model, &u);
            let exact: f64 = f.iter().zip(&v).map(|(f, v)| f * v).sum();
            let size: f64 = f.iter().zip(&v).map(|(f, v)| (f * v).abs()).sum();
            assert!((slope - exact).abs() < 1e-6 * size, "{law:?}: {slope:e} {exact:e}");
        }
    }
}

/// K v at `u`.
fn product(model: &Model, u: &[f64], v: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; model.size()];
    stiffness_times(&model.points, u, v, &mut Workspace::new(&model.points), &mut product);
    product
}

/// Laws with and without projected J: the last one is projected.
fn laws_of_the_tangent() -> Vec<Law> {
    [objective_laws(), vec![neo_hookean(3000.0, 0.49)]].concat()
}

#[test]
fn the_tangent_is_the_derivative_of_the_internal_force() {
    for law in laws_of_the_tangent() {
        for mut problem in [with_stiff_half(cube(3), law), with_stiff_half(square(5), law)] {
            problem.recipe.volumetric_projection = VolumetricProjection::Patches;
            let (_, model) = build(&problem);
            // No point of this noise crosses the kink where fibres begin to carry.
            let (u, v) = (noise(&model, 2e-3, 4), noise(&model, 1.0, 2));
            let moved = |sign: f64| -> Vec<f64> {
                forces(
                    &model,
                    &u.iter().zip(&v).map(|(u, v)| u + sign * 1e-6 * v).collect::<Vec<_>>(),
                )
            };
            let exact = product(&model, &u, &v);
            for ((plus, minus), exact) in moved(1.0).iter().zip(moved(-1.0)).zip(&exact) {
                let error = ((plus - minus) / 2e-6 - exact).abs();
                assert!(error < 1e-6 * largest(&product(&model, &u, &v)), "{law:?}: {error:e}");
            }
        }
    }
}

#[test]
fn the_tangent_is_symmetric_to_round_off() {
    for law in laws_of_the_tangent() {
        for mut problem in bodies() {
            problem = with_stiff_half(problem, law);
            problem.recipe.volumetric_projection = VolumetricProjection::Patches;
            let (_, model) = build(&problem);
            let (u, v, w) = (noise(&model, 1e-3, 1), noise(&model, 1.0, 2), noise(&model, 1.0, 3));
            let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
            let (Kv, Kw) = (product(&model, &u, &v), product(&model, &u, &w));
            let size = (dot(&Kv, &Kv) * dot(&w, &w)).sqrt();
            let difference = (dot(&Kv, &w) - dot(&Kw, &v)).abs() / size;
            assert!(difference < 1e-13, "{law:?}: {difference:e}");
        }
    }
}

#[test]
fn every_set_of_vector_instructions_gives_the_same_forces_up_to_round_off() {
    for problem in bodies() {
        for law in laws_of_the_tangent() {
            let mut problem = with_stiff_half(problem.clone(), law);
            problem.recipe.volumetric_projection = VolumetricProjection::Patches;
            let (_, model) = build(&problem);
            let u = noise(&model, 1e-3, 4);
            let mut workspace = Workspace::new(&model.points);
            workspace.level = fearless_simd::Level::baseline();
            let mut plain = vec![0.0; model.size()];
            internal_force(&model.points, &u, &mut workspace, &mut plain);
            let fast = forces(&model, &u);
            for (a, b) in plain.iter().zip(&fast) {
                assert!((a - b).abs() < 1e-13 * largest(&fast), "{law:?}: {a:e} {b:e}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn internal_forces_and_their_moments_sum_to_zero(
        body in 0..6usize, law in 0..4usize, seed in 1..1000u64,
        about in prop::array::uniform3(-1.0..1.0f64),
    ) {
        let problem = with_stiff_half(bodies()[body].clone(), objective_laws()[law]);
        let (_, model) = build(&problem);
        let d = model.components;
        let u = noise(&model, 1e-3, seed);
        let f = forces(&model, &u);
        let about = Vector3::from(about);
        let (mut force, mut moment, mut size, mut arm) = (Vector3::zeros(), Vector3::zeros(), 0.0, 0.0);
        for (node, X) in model.positions.iter().enumerate() {
            let lever = X + vector_at(&u, node, d) - about;
            let nodal_force = vector_at(&f, node, d);
            force += nodal_force;
            moment += lever.cross(&nodal_force);
            size += nodal_force.norm();
            arm += lever.norm() * nodal_force.norm();
        }
        if d == 2 {
            // Only the moment about z is a sum of forces in the plane.
            moment = Vector3::new(0.0, 0.0, moment.z);
        }
        prop_assert!(force.norm() < 1e-12 * size, "{:e}", force.norm() / size);
        prop_assert!(moment.norm() < 1e-12 * arm, "{:e}", moment.norm() / arm);
    }
}

#[test]
fn a_body_that_is_turned_with_its_fibres_stores_the_same_energy() {
    // x to y to z to x: the cube and its lattice come to lie on themselves.
    let turn = Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    let fibres = |X: &Vector3| Vector3::new((20.0 * X.y).cos(), (20.0 * X.y).sin(), 0.4);
    let bent = |X: &Vector3| Vector3::new(0.2 * X.y, 3.0 * X.x * X.z, -0.1 * X.z);
    let energy = |Q: Matrix3, law: Law| {
        let mut problem = with_law(cube(3), law);
        let fibre = Field::of(move |X| Q * fibres(&(Q.transpose() * X)));
        let sheet = Some((Q * Vector3::new(0.3, -0.2, 1.0)).into());
        problem.regions[0].fibres = Some(Fibres { fibre, sheet });
        let (_, model) = build(&problem);
        strain_energy(&model.points, &field(&model, |X| Q * bent(&(Q.transpose() * X))))
    };
    for law in objective_laws().into_iter().filter(Law::has_fibres) {
        let (home, turned) = (energy(Matrix3::identity(), law), energy(turn, law));
        assert!((turned / home - 1.0).abs() < 1e-10, "{law:?}: {home} {turned}");
    }
}
