//! Consistent gradients and the projection of J.
#![allow(non_snake_case)]

use crate::common::*;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::discretisation::Discretisation;
use mtled::force::strain_energy;
use mtled::geometry::{Field, Panel, Selector, Shape};
use mtled::model::Model;
use mtled::model::essential::ConstraintForces;
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::problem::*;

fn consistent(mut problem: Problem, tolerance: f64) -> Discretisation {
    problem.recipe.gradients = Gradients::Consistent { tolerance };
    Discretisation::new(&problem).unwrap()
}

fn second_order(mut problem: Problem, tolerance: f64) -> Discretisation {
    problem.recipe.gradients = Gradients::SecondOrder { tolerance };
    Discretisation::new(&problem).unwrap()
}

/// Largest Σ_q w_q Grad φ_a over interior nodes, whose φ is 0 on the boundary.
fn largest_interior_sum(discretisation: &Discretisation) -> f64 {
    let nodes = &discretisation.cloud;
    let mut sums = vec![Vector3::zeros(); nodes.positions.len()];
    for (q, weight) in discretisation.quadrature.weights.iter().enumerate() {
        for entry in discretisation.supports.row(q) {
            let node = discretisation.supports.nodes[entry] as usize;
            sums[node] += *weight * discretisation.supports.grad_phi[entry];
        }
    }
    let inside = |X: &Vector3| X.iter().all(|c| (c - 0.5 * EDGE).abs() < 0.2 * EDGE);
    let deep = sums.iter().zip(&nodes.positions).filter(|(_, X)| inside(X));
    deep.map(|(sum, _)| sum.norm()).fold(0.0, f64::max)
}

#[test]
fn inside_the_body_the_sum_of_weighted_gradients_vanishes() {
    let problem = jittered(cube(8), 0.3, 1);
    let plain = largest_interior_sum(&Discretisation::new(&problem).unwrap());
    assert!(plain > 1e-7, "{plain}");
    for discretise in [consistent, second_order] {
        let corrected = largest_interior_sum(&discretise(problem.clone(), 1e-12));
        assert!(corrected < 1e-10 * plain, "{corrected} after {plain}");
    }
}

#[test]
fn changed_gradients_still_differentiate_linear_fields() {
    let problems = [jittered(cube(6), 0.4, 2), jittered(square(9), 0.4, 2)];
    let both = [consistent, second_order];
    for (problem, discretise) in
        problems.iter().flat_map(|p| both.map(|discretise| (p, discretise)))
    {
        let d = problem.dimension.components();
        let discretisation = discretise(problem.clone(), 1e-3);
        let rows = &discretisation.supports;
        for q in 0..rows.len() {
            let mut sum = Vector3::zeros();
            let mut slope = Matrix3::zeros();
            for entry in rows.row(q) {
                let X = discretisation.cloud.positions[rows.nodes[entry] as usize];
                sum += rows.grad_phi[entry];
                slope +=
                    (X - discretisation.quadrature.positions[q]) * rows.grad_phi[entry].transpose();
            }
            let mut identity = Matrix3::identity();
            if d == 2 {
                identity[(2, 2)] = 0.0;
            }
            assert!(sum.norm() < 1e-9, "{sum}");
            assert!((slope - identity).norm() < 1e-12, "{slope}");
        }
    }
}

#[test]
fn iterations_do_not_grow_with_the_number_of_nodes_nor_on_slender_bodies() {
    let mut beam = cube(8);
    beam.body = Shape::Box { min: Vector3::zeros(), max: Vector3::new(0.8, 0.05, 0.05) };
    for (name, problem) in [
        ("small", cube(6)),
        ("large", cube(18)),
        ("jittered", jittered(cube(12), 0.4, 3)),
        ("beam", beam),
    ] {
        for discretise in [consistent, second_order] {
            let correction = discretise(problem.clone(), 1e-3).correction.unwrap();
            assert!(correction.residual <= 1e-3, "{name}: {correction:?}");
            assert!(correction.iterations <= 20, "{name}: {correction:?}");
            assert!(
                correction.linear_stress_iterations.unwrap_or(0) <= 10,
                "{name}: {correction:?}"
            );
        }
    }
}

/// |Σ_q w_q ((x_q − X_a) ⊗ Grad φ_a + φ_a I)| over nodes so deep inside that φ_a is 0 on the
/// boundary, in the mean \[m³\].
fn mean_interior_moment(discretisation: &Discretisation) -> f64 {
    let (rows, quadrature) = (&discretisation.supports, &discretisation.quadrature);
    let nodes = &discretisation.cloud.positions;
    let d = discretisation.dimension.components();
    let mut moments = vec![Matrix3::zeros(); nodes.len()];
    for (q, (X, weight)) in quadrature.positions.iter().zip(&quadrature.weights).enumerate() {
        for entry in rows.row(q) {
            let node = rows.nodes[entry] as usize;
            let mut value = (X - nodes[node]) * rows.grad_phi[entry].transpose();
            (0..d).for_each(|k| value[(k, k)] += rows.phi[entry]);
            moments[node] += *weight * value;
        }
    }
    let inside = |X: &Vector3| X.iter().take(d).all(|c| (c - 0.5 * EDGE).abs() < 0.2 * EDGE);
    let pairs = moments.iter().zip(nodes).filter(|(_, X)| inside(X));
    let deep: Vec<f64> = pairs.map(|(moment, _)| moment.norm()).collect();
    deep.iter().sum::<f64>() / deep.len() as f64
}

#[test]
fn of_second_order_gradients_nearly_integrate_linear_stresses() {
    for problem in [jittered(cube(9), 0.3, 1), jittered(square(13), 0.3, 1)] {
        let first = mean_interior_moment(&consistent(problem.clone(), 1e-3));
        let second = mean_interior_moment(&second_order(problem, 1e-3));
        assert!(second < 0.35 * first, "{second} after {first}");
    }
}

#[test]
fn two_bodies_are_made_consistent_each_by_itself() {
    let mut problem = cube(6);
    let ball = |x: f64| Shape::Sphere { centre: Vector3::new(x, 0.0, 0.0), radius: 0.04 };
    problem.body = Shape::Union(vec![ball(0.0), ball(0.3)]);
    problem.recipe.cloud = Cloud::Regular { spacing: 0.012 };
    let correction = consistent(problem, 1e-10).correction.unwrap();
    assert_eq!(correction.bodies, 2);
    assert!(correction.residual <= 1e-10, "{correction:?}");
}

#[test]
fn projected_forces_are_the_derivative_of_the_projected_energy() {
    for law in objective_laws() {
        let mut problem = with_law(jittered(cube(5), 0.3, 4), law);
        problem.recipe.volumetric_projection = VolumetricProjection::Patches;
        let discretisation = Discretisation::new(&problem).unwrap();
        let model = Model::new(&problem, &discretisation).unwrap();
        let wave = |i: usize| 1e-3 * (1.7 * i as f64).sin();
        let u: Vec<f64> = (0..model.size()).map(wave).collect();
        let f = forces(&model, &u);
        let scale = largest(&f);
        for i in (0..model.size()).step_by(37) {
            let energy = |shift: f64| {
                let mut moved = u.clone();
                moved[i] += shift;
                strain_energy(&model.points, &moved)
            };
            let difference = (energy(1e-7) - energy(-1e-7)) / 2e-7;
            assert!((difference - f[i]).abs() < 1e-5 * scale, "{law:?}: {difference} {}", f[i]);
        }
    }
}

#[test]
fn a_material_that_changes_its_volume_is_not_projected() {
    let mut problem = cube(5);
    problem.recipe.volumetric_projection = VolumetricProjection::Patches;
    let discretisation = Discretisation::new(&problem).unwrap();
    let projected = |problem: &Problem| {
        let model = Model::new(problem, &discretisation).unwrap();
        model.points.blocks.iter().any(|block| block.projection.is_some())
    };
    assert!(!projected(&problem));
    assert!(projected(&with_law(problem, neo_hookean(3000.0, 0.49))));
}

/// A nearly incompressible cube in equilibrium with a field prescribed on its whole
/// boundary, and its nodal parameters \[m\].
fn prescribed_on_boundary(storage: GradientStorage, field: Field) -> (Model, Vec<f64>) {
    let gradients = Gradients::Consistent { tolerance: 1e-13 };
    prescribed_with(gradients, storage, field)
}

fn prescribed_with(
    gradients: Gradients,
    storage: GradientStorage,
    field: Field,
) -> (Model, Vec<f64>) {
    let mut problem = collocated(jittered(cube(6), 0.3, 4));
    problem = with_law(problem, neo_hookean(3000.0, 0.49));
    problem.recipe.volumetric_projection = VolumetricProjection::Patches;
    problem.recipe.gradient_storage = storage;
    problem.recipe.gradients = gradients;
    let mut boundary = condition("boundary", Selector::All, [None; 3]);
    boundary.prescribed = Prescribed::Field(field);
    problem.conditions.push(boundary);
    problem.motion =
        Motion::Newton(Newton { load_end: 1.0, tolerance: 1e-11, ..Newton::default() });
    let (_, model) = build(&problem);
    let mut state = State::new(&model);
    simulate(&model, &problem.motion, &mut state, &mut Unobserved).unwrap();
    (model, state.displacement)
}

#[test]
fn gradients_of_second_order_pass_the_patch_test() {
    let H = Matrix3::new(0.08, 0.03, 0.01, 0.02, -0.05, 0.03, -0.01, 0.02, -0.02);
    let gradients = Gradients::SecondOrder { tolerance: 1e-13 };
    let (model, u) = prescribed_with(gradients, GradientStorage::Double, Field::of(move |X| H * X));
    let error = |(node, X): (usize, &Vector3)| (vector_at(&u, node, 3) - H * X).amax();
    let largest_error = model.positions.iter().enumerate().map(error).fold(0.0, f64::max);
    assert!(largest_error < 1e-9 * largest(&u), "{largest_error}");
}

#[test]
fn gradients_in_single_precision_pass_the_patch_test_to_one_in_a_million() {
    let H = Matrix3::new(0.08, 0.03, 0.01, 0.02, -0.05, 0.03, -0.01, 0.02, -0.02);
    let mut errors = [GradientStorage::Double, GradientStorage::Single].map(|storage| {
        let (model, u) = prescribed_on_boundary(storage, Field::of(move |X| H * X));
        let error = |(node, X): (usize, &Vector3)| (vector_at(&u, node, 3) - H * X).amax();
        model.positions.iter().enumerate().map(error).fold(0.0, f64::max) / largest(&u)
    });
    assert!(errors[0] < 1e-9, "{errors:?}");
    // As accurate as single precision, and no more.
    errors[1] /= 1e-6;
    assert!((1e-4..1.0).contains(&errors[1]), "{errors:?}");
}

#[test]
fn gradients_in_single_precision_change_displacements_by_one_in_a_million() {
    let bent = |X: &Vector3| Vector3::new(X.x * X.y, -0.5 * X.y * X.y, X.x * X.x) * (0.3 / EDGE);
    let [double, single] = [GradientStorage::Double, GradientStorage::Single]
        .map(|storage| prescribed_on_boundary(storage, Field::of(bent)).1);
    let differences: Vec<f64> = double.iter().zip(&single).map(|(a, b)| a - b).collect();
    let change = largest(&differences) / largest(&double);
    assert!(change > 0.0 && change < 1e-6, "{change}");
}

#[test]
fn gradients_in_single_precision_take_14_bytes_per_entry_in_place_of_26() {
    let bytes = [GradientStorage::Double, GradientStorage::Single].map(|storage| {
        let mut problem = cube(5);
        problem.recipe.gradient_storage = storage;
        build(&problem).1.bytes_per_step()
    });
    assert_eq!(14 * bytes[0], 26 * bytes[1]);
}

#[test]
fn a_field_prescribed_on_the_whole_boundary_gives_a_body_the_mean_gradient_of_the_field() {
    for problem in [collocated(jittered(cube(5), 0.3, 4)), collocated(jittered(square(6), 0.3, 4))]
    {
        let d = problem.dimension.components();
        let bent = |X: &Vector3| Vector3::new(X.x * X.y * X.y, X.x * X.x * X.y, 0.0) / EDGE.powi(2);
        let mut problem = problem;
        let mut boundary = condition("boundary", Selector::All, [None; 3]);
        boundary.prescribed = Prescribed::Field(Field::of(bent));
        problem.conditions.push(boundary);
        let discretisation = consistent(problem.clone(), 1e-12);
        let model = Model::new(&problem, &discretisation).unwrap();
        let mut u = vec![0.0; model.size()];
        let (inertia, mut forces) = (&model.inertia, ConstraintForces::default());
        model.constraints.enforce(0.0, &model.positions, inertia, &mut u, &mut forces, |_, _| ());
        let mut mean = Matrix3::zeros();
        for (q, weight) in discretisation.quadrature.weights.iter().enumerate() {
            let F = discretisation.supports.deformation_gradient(q, &u, d);
            mean += (F - Matrix3::identity()) * *weight;
        }
        let integrand =
            |panel: &Panel| bent(&panel.centre) * (panel.area * panel.normal).transpose();
        let expected: Matrix3 = discretisation.surface.panels.iter().map(integrand).sum();
        let error = (mean - expected).norm() / expected.norm();
        assert!(error < 1e-9, "{error} in {d} dimensions");
    }
}
