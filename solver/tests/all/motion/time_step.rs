//! The critical step against a dense eigenvalue problem.

use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::Discretisation;
use mtled::force::Workspace;
use mtled::model::Model;
use mtled::motion::critical_time_step::{critical_time_step, local_growth};
use mtled::problem::*;
use nalgebra::DMatrix;
use proptest::prelude::*;

/// M^(−1/2) K M^(−1/2) at `u`.
fn dense_operator(model: &Model, u: &[f64]) -> DMatrix<f64> {
    let mass = |i: usize| model.lumped_mass[i / model.components];
    let tangent = dense_tangent(model, u, 1e-7);
    tangent.map_with_location(|i, j, entry| entry / (mass(i) * mass(j)).sqrt())
}

fn limit_of(operator: DMatrix<f64>) -> f64 {
    2.0 / operator.symmetric_eigenvalues().max().sqrt()
}

fn true_limit(model: &Model, u: &[f64]) -> f64 {
    limit_of(dense_operator(model, u))
}

/// The limit among displacements whose constrained values vanish: with
/// B = Φ M^(−1/2), the operator between projections I − Bᵀ(BBᵀ)⁻¹B.
fn constrained_limit(problem: &Problem, discretisation: &Discretisation, model: &Model) -> f64 {
    let (n, d) = (model.size(), model.components);
    let sets = model.constraints.active(0.0);
    let count: usize = sets.iter().map(|set| set.rows.len()).sum();
    let mut rows = DMatrix::zeros(count, n);
    let mut next = 0;
    for set in sets {
        for row in &set.rows {
            let node = row.node as usize;
            if problem.recipe.enforcement == Enforcement::Direct {
                rows[(next, d * node + set.component)] = 1.0 / model.lumped_mass[node].sqrt();
            } else {
                let at = discretisation.rows_at(&[model.positions[node]]).unwrap();
                for (&node, phi) in at.nodes.iter().zip(&at.phi) {
                    let node = node as usize;
                    rows[(next, d * node + set.component)] = phi / model.lumped_mass[node].sqrt();
                }
            }
            next += 1;
        }
    }
    let gram = (&rows * rows.transpose()).try_inverse().unwrap();
    let projection = DMatrix::identity(n, n) - rows.transpose() * gram * &rows;
    limit_of(&projection * dense_operator(model, &vec![0.0; n]) * &projection)
}

fn by_lanczos(model: &Model, u: &[f64]) -> f64 {
    critical_time_step(model, u, 0.0, None, &mut Workspace::new(&model.points)).time_step
}

/// Within one per cent of the limit and, but for round-off, never above it.
fn assert_close_below(time_step: f64, limit: f64) {
    let ratio = time_step / limit;
    assert!((0.99..=1.0 + 1e-6).contains(&ratio), "{ratio}");
}

fn bodies() -> Vec<Problem> {
    let stiff = neo_hookean(30000.0, 0.45);
    vec![
        jittered(cube(3), 0.2, 1),
        with_stiff_half(jittered(cube(3), 0.2, 2), stiff),
        jittered(square(7), 0.3, 3),
        quadratic(jittered(square(7), 0.3, 4)),
    ]
}

#[test]
fn lanczos_finds_the_limit_at_rest_from_below_within_a_per_cent() {
    for problem in bodies() {
        let (_, model) = build(&problem);
        let u = vec![0.0; model.size()];
        assert_close_below(by_lanczos(&model, &u), true_limit(&model, &u));
    }
}

#[test]
fn lanczos_finds_the_limit_of_a_deformed_body_from_below_within_a_per_cent() {
    for problem in bodies() {
        let (_, model) = build(&problem);
        let mut u = field(&model, |x| Vector3::new(-0.3 * x.x, 0.1 * x.y + 0.2 * x.x, 0.1 * x.z));
        u.iter_mut().zip(noise(&model, 1e-3, 1)).for_each(|(u, n)| *u += n);
        assert_close_below(by_lanczos(&model, &u), true_limit(&model, &u));
    }
}

#[test]
fn a_compressed_body_has_a_smaller_limit_than_a_body_at_rest() {
    let (_, model) = build(&square(6));
    let rest = by_lanczos(&model, &vec![0.0; model.size()]);
    let u = field(&model, |x| Vector3::new(-0.5 * x.x, 0.0, 0.0));
    assert!(by_lanczos(&model, &u) < 0.8 * rest);
}

#[test]
fn local_growth_follows_the_largest_eigenvalue_wherever_the_body_stiffens() {
    let (_, model) = build(&jittered(square(9), 0.2, 1));
    let mut workspace = Workspace::new(&model.points);
    let rest = vec![0.0; model.size()];
    let first = critical_time_step(&model, &rest, 0.0, None, &mut workspace);
    // The corner far from the origin is pressed, wherever the stiffest mode is at rest.
    let squeezed = field(&model, |x| -0.1 * x * (x.norm() / (1.42 * EDGE)).powi(4));
    let mut growth =
        |u: &[f64], pattern: &mut Vec<f64>| local_growth(&model, u, 0.0, pattern, &mut workspace);
    let mut pattern = first.pattern.clone();
    let before = growth(&rest, &mut pattern);
    // Several products, as in a run.
    let after = (0..5).map(|_| growth(&squeezed, &mut pattern)).last().unwrap();
    let exact = (true_limit(&model, &rest) / true_limit(&model, &squeezed)).powi(2);
    assert!(exact > 2.0, "{exact}");
    assert!((0.8..1.2).contains(&(after / before / exact)), "{} {exact}", after / before);
}

#[test]
fn an_earlier_run_saves_products() {
    let (_, model) = build(&jittered(cube(3), 0.2, 1));
    let (u, mut workspace) = (vec![0.0; model.size()], Workspace::new(&model.points));
    let first = critical_time_step(&model, &u, 0.0, None, &mut workspace);
    let again = critical_time_step(&model, &u, 0.0, Some(&first), &mut workspace);
    assert!(again.products < first.products, "{} {}", again.products, first.products);
    assert!((again.time_step / first.time_step - 1.0).abs() < 0.01);
}

#[test]
fn with_conditions_the_limit_is_that_of_the_constrained_operator() {
    for problem in [jittered(cube(3), 0.2, 5), jittered(square(6), 0.3, 6)] {
        for enforcement in [Enforcement::Direct, Enforcement::Collocation] {
            let mut problem = problem.clone();
            problem.recipe.enforcement = enforcement;
            let axis = problem.dimension.components() - 1;
            problem.conditions.push(condition("base", face(axis, 0.0), [Some(0.0); 3]));
            problem.conditions.push(condition("side", face(0, 0.0), [Some(0.0), None, None]));
            let (discretisation, model) = build(&problem);
            let time_step = by_lanczos(&model, &vec![0.0; model.size()]);
            assert_close_below(time_step, constrained_limit(&problem, &discretisation, &model));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    #[test]
    fn lanczos_finds_the_limit_of_any_body_within_a_per_cent(
        plane in any::<bool>(), even in any::<bool>(), jitter in 0.0..0.4f64, seed in 1..9999u64,
        dilation in 1.6..2.4f64, young_modulus in 100.0..1e5f64, poisson_ratio in 0.0..0.49f64,
    ) {
        let body = jittered(if plane { square(6) } else { cube(3) }, jitter, seed);
        let mut problem = with_stiff_half(body, neo_hookean(young_modulus, poisson_ratio));
        problem.recipe.dilation = dilation;
        problem.recipe.mass = if even { MassRule::EvenSplit } else { MassRule::RowSum };
        let (_, model) = build(&problem);
        let u = noise(&model, 1e-3, seed);
        let ratio = by_lanczos(&model, &u) / true_limit(&model, &u);
        prop_assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    }

    #[test]
    fn the_bound_per_point_is_below_the_limit(
        plane in any::<bool>(), even in any::<bool>(), jitter in 0.0..0.3f64, seed in 1..99u64,
        dilation in 1.6..2.4f64, poisson_ratio in 0.0..0.49f64,
    ) {
        let body = if plane { square(6) } else { cube(3) };
        let mut problem = with_law(jittered(body, jitter, seed), neo_hookean(3000.0, poisson_ratio));
        problem.recipe.dilation = dilation;
        problem.recipe.mass = if even { MassRule::EvenSplit } else { MassRule::RowSum };
        let (_, model) = build(&problem);
        let limit = true_limit(&model, &vec![0.0; model.size()]);
        prop_assert!(model.per_point_bound <= limit, "{} of the limit", model.per_point_bound / limit);
    }
}
