//! Dynamic relaxation against closed forms and balances.
#![allow(non_snake_case)]

use crate::common::statics::*;
use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::Discretisation;
use mtled::error::Error;
use mtled::geometry::Selector;
use mtled::model::Model;
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::problem::*;

/// A cube on rollers, stretched along x by a fifth.
fn bar() -> Problem {
    let mut problem = cube(4);
    problem.conditions = vec![
        condition("x0", face(0, 0.0), [Some(0.0), None, None]),
        condition("y0", face(1, 0.0), [None, Some(0.0), None]),
        condition("z0", face(2, 0.0), [None, None, Some(0.0)]),
        condition("pull", face(0, EDGE), [Some(0.2 * EDGE), None, None]),
    ];
    problem.conditions[3].amplitude = Amplitude::Smooth { duration: 1.0 };
    problem
}

/// λ across with μ(λ² − 1) + Λ ln(λ_x λ²) = 0, by Newton's method; and the
/// nominal stress μ(λ_x − 1/λ_x) + Λ ln J/λ_x.
fn uniaxial(stretch: f64) -> (f64, f64) {
    let (mu, lame) = (constants().shear_modulus, constants().lame_modulus());
    let mut across: f64 = 1.0;
    for _ in 0..30 {
        let value = mu * (across * across - 1.0) + lame * (stretch * across * across).ln();
        across -= value / (2.0 * mu * across + 2.0 * lame / across);
    }
    let volume = stretch * across * across;
    (across, mu * (stretch - 1.0 / stretch) + lame * volume.ln() / stretch)
}

#[test]
fn the_weight_of_a_part_is_that_of_its_mass_and_acts_there_alone() {
    let mut problem = cube(6);
    problem.loads.body_forces = vec![BodyForce {
        part: Selector::Inside {
            shape: mtled::geometry::Shape::HalfSpace {
                point: Vector3::new(0.0, 0.0, 0.5 * EDGE),
                normal: -Vector3::z(),
            },
            tolerance: 0.0,
        },
        acceleration: (Vector3::z() * -9.81).into(),
        amplitude: Amplitude::Constant,
    }];
    let (_, model) = build(&problem);
    let weight = |node: usize| vector_at(&model.loads[0].force, node, 3).z;
    let total: f64 = (0..model.positions.len()).map(weight).sum();
    let half = 0.5 * 1000.0 * EDGE.powi(3) * -9.81;
    approx::assert_relative_eq!(total, half, max_relative = 0.12);
    let reach = 1.8 * EDGE / 6.0;
    let below = (0..model.positions.len())
        .filter(|&node| model.positions[node].z < 0.5 * EDGE - reach)
        .all(|node| weight(node) == 0.0);
    assert!(below);
}

#[test]
fn a_body_force_on_no_point_is_refused_by_its_number() {
    let mut problem = cube(3);
    gravity(&mut problem, Vector3::z());
    gravity(&mut problem, Vector3::z());
    problem.loads.body_forces[1].part = face(2, 2.0 * EDGE);
    let discretisation = Discretisation::new(&problem).unwrap();
    let error = Model::new(&problem, &discretisation).unwrap_err();
    assert!(matches!(error, Error::EmptyBodyForce { index: 1 }), "{error}");
}

#[test]
fn a_stretched_bar_on_rollers_reaches_the_uniaxial_state() {
    let (across, nominal) = uniaxial(1.2);
    for problem in [bar(), collocated(bar())] {
        let solved = solve(&problem);
        let d = &solved.discretisation;
        // Measured: 4e-4 in the displacement, 5e-5 in the force.
        let rows = d.rows_at(&[Vector3::repeat(EDGE), Vector3::repeat(0.5 * EDGE)]).unwrap();
        for (i, edge) in [EDGE, 0.5 * EDGE].into_iter().enumerate() {
            let u = rows.interpolate(i, &solved.state.displacement, 3);
            let exact = Vector3::new(0.2, across - 1.0, across - 1.0) * edge;
            assert!((u - exact).norm() < 2e-3 * 0.2 * EDGE, "{u} {exact}");
        }
        let pull = solved.recorder.reactions[3].force.x;
        let exact = nominal * EDGE * EDGE;
        assert!((pull / exact - 1.0).abs() < 1e-3, "{pull} {exact}");
    }
}

#[test]
fn the_estimated_error_and_the_residual_are_reported_and_small() {
    let solved = solve(&bar());
    let convergence = solved.summary.relaxation.unwrap();
    assert!(convergence.estimated_error <= TOLERANCE * largest(&solved.state.displacement));
    assert!(convergence.residual <= 10.0 * TOLERANCE);
    assert!(solved.summary.steps == solved.state.step && !solved.summary.stopped);
}

#[test]
fn the_error_of_a_relaxed_solution_is_below_its_tolerance() {
    let slender = {
        let mut problem = with_law(square(4), neo_hookean(3000.0, 0.45));
        problem.body = mtled::geometry::Shape::Box {
            min: Vector3::zeros(),
            max: Vector3::new(4.0 * EDGE, EDGE, EDGE),
        };
        problem.conditions.push(condition("root", face(0, 0.0), [Some(0.0); 3]));
        gravity(&mut problem, Vector3::new(0.0, -0.1, 0.0));
        problem
    };
    for problem in [leaning(jittered(cube(4), 0.2, 1)), slender] {
        let exact = solve_to(&problem, 1e-10).state.displacement;
        for tolerance in [1e-2, 1e-3, 1e-5] {
            let relaxed = solve_to(&problem, tolerance);
            let u = &relaxed.state.displacement;
            let error = u.iter().zip(&exact).fold(0.0f64, |a, (u, v)| a.max((u - v).abs()));
            let ratio = error / largest(&exact) / tolerance;
            // Measured: 0.002 to 0.61.
            assert!(ratio < 1.0, "{ratio} times the tolerance of {tolerance:e}");
        }
    }
}

#[test]
fn reactions_balance_each_other_and_the_loads_and_so_do_their_moments() {
    for problem in [leaning(jittered(cube(4), 0.2, 1)), leaning(jittered(square(6), 0.2, 1))] {
        for problem in [problem.clone(), collocated(problem)] {
            let Solved { model, state, recorder, .. } = solve(&problem);
            let d = model.components;
            let mut force: Vector3 = recorder.reactions.iter().map(|r| r.force).sum();
            let mut moment: Vector3 = recorder.reactions.iter().map(|r| r.moment).sum();
            // Measured: 8e-7 in the plane, 3e-9 in space.
            let size = recorder.reactions[0].force.norm();
            assert!(size > 0.0);
            for (node, X) in model.positions.iter().enumerate() {
                let weight = vector_at(&model.loads[0].force, node, d);
                force += weight;
                moment += (X + state.displacement_of(node, d)).cross(&weight);
            }
            if d == 2 {
                moment = Vector3::new(0.0, 0.0, moment.z);
            }
            assert!(force.norm() < 1e-5 * size, "{:e}", force.norm() / size);
            let lever = 1e-5 * size * EDGE;
            assert!(
                moment.norm() < lever,
                "{:?} {:e}",
                problem.recipe.enforcement,
                moment.norm() / lever
            );
        }
    }
}

#[test]
fn with_collocation_the_field_takes_the_prescribed_values_at_the_nodes() {
    let solved = solve(&collocated(leaning(jittered(cube(4), 0.2, 2))));
    let on_top: Vec<Vector3> =
        solved.model.positions.iter().filter(|x| x.z == EDGE).copied().collect();
    let rows = solved.discretisation.rows_at(&on_top).unwrap();
    for i in 0..on_top.len() {
        let u = rows.interpolate(i, &solved.state.displacement, 3);
        assert!((u.x - 0.15 * EDGE).abs() < 1e-10 && (u.y - 0.05 * EDGE).abs() < 1e-10);
    }
}

#[test]
fn with_direct_enforcement_the_nodal_parameters_take_the_prescribed_values() {
    let solved = solve(&leaning(jittered(cube(4), 0.2, 2)));
    for (node, x) in solved.model.positions.iter().enumerate() {
        let u = solved.state.displacement_of(node, 3);
        assert!(x.z != 0.0 || u == Vector3::zeros());
        assert!(x.z != EDGE || (u.x == 0.15 * EDGE && u.y == 0.05 * EDGE));
    }
}

#[test]
fn a_prescribed_field_moves_every_node_by_its_own_value() {
    let u = |X: &Vector3| Vector3::new(0.1 * X.y, 0.3 * X.x * X.z, -0.05 * X.z);
    let mut problem = cube(4);
    let mut boundary = condition("boundary", Selector::All, [None; 3]);
    boundary.prescribed = Prescribed::Field(Field::of(u));
    boundary.amplitude = Amplitude::Smooth { duration: 1.0 };
    problem.conditions = vec![boundary];
    let solved = solve(&problem);
    let cloud = &solved.discretisation.cloud;
    for (node, X) in cloud.positions.iter().enumerate().filter(|(n, _)| cloud.on_boundary[*n]) {
        assert!((solved.state.displacement_of(node, 3) - u(X)).norm() < 1e-15);
    }
}

#[test]
fn a_body_force_field_is_weighted_with_the_mass_where_it_acts() {
    let mut problem = cube(4);
    let acceleration = Field::of(|X| Vector3::new(X.x, 0.0, 2.0 * X.y));
    let amplitude = Amplitude::Constant;
    problem.loads.body_forces = vec![BodyForce { part: Selector::All, acceleration, amplitude }];
    let (_, model) = build(&problem);
    let total: Vector3 =
        (0..model.positions.len()).map(|n| vector_at(&model.loads[0].force, n, 3)).sum();
    // ρ ∫ b dV over the cube, whose points are symmetric about its middle.
    let expected = Vector3::new(0.5, 0.0, 1.0) * (1000.0 * EDGE.powi(4));
    assert!((total - expected).norm() < 1e-12, "{total}");
}

#[test]
fn static_solutions_do_not_depend_on_the_mass_of_the_relaxation() {
    let problem = collocated(leaning(jittered(square(6), 0.3, 3)));
    let with = |mass: RelaxationMass| {
        let Motion::Relaxed(settings) = relaxation(1e-8) else { unreachable!() };
        solve_by(&problem, Motion::Relaxed(Relaxation { mass, ..settings }))
    };
    let (stiffness, lumped) = (with(RelaxationMass::Stiffness), with(RelaxationMass::Lumped));
    assert!(stiffness.model.inertia != lumped.model.inertia);
    let total = |mass: &[f64]| mass.iter().sum::<f64>();
    let masses = (total(&stiffness.model.inertia), total(&lumped.model.inertia));
    assert!((masses.0 / masses.1 - 1.0).abs() < 1e-12);
    let difference = difference(&stiffness.state.displacement, &lumped.state.displacement);
    assert!(difference < 2e-8, "{difference:e}");
}

#[test]
fn a_model_with_fictitious_masses_is_refused_in_a_dynamic_run() {
    let problem = Problem { motion: newton(), ..jittered(cube(3), 0.2, 1) };
    let (_, model) = build(&problem);
    let run = simulate(&model, &dynamic(0.1, 1e-4, 0.0), &mut State::new(&model), &mut Unobserved);
    assert!(matches!(run, Err(Error::FictitiousMass)), "{run:?}");
}

#[test]
fn the_stiffness_of_a_node_is_the_mean_diagonal_of_the_tangent_at_rest() {
    for (problem, poisson_ratio) in
        [(cube(3), 0.3), (jittered(cube(3), 0.2, 1), 0.49), (jittered(square(5), 0.2, 1), 0.49)]
    {
        let mut problem = with_law(problem, neo_hookean(3000.0, poisson_ratio));
        problem.recipe.volumetric_projection = VolumetricProjection::Patches;
        let (_, model) = build(&problem);
        let d = model.components;
        let diagonal = dense_tangent(&model, &vec![0.0; model.size()], 1e-7 * EDGE).diagonal();
        for (stiffness, diagonal) in model.stiffness.iter().zip(diagonal.as_slice().chunks(d)) {
            let mean = diagonal.iter().sum::<f64>() / d as f64;
            assert!((stiffness / mean - 1.0).abs() < 1e-6, "{stiffness} {mean}");
        }
    }
}

/// A cube whose top is moved aside, and nothing else: the whole body follows.
fn shifted() -> Problem {
    let mut problem = collocated(jittered(cube(4), 0.2, 1));
    let by = [Some(0.04 * EDGE), Some(0.0), Some(0.01 * EDGE)];
    problem.conditions.push(condition("top", face(2, EDGE), by));
    problem.conditions[0].amplitude = Amplitude::Smooth { duration: 1.0 };
    problem
}

#[test]
fn a_body_that_only_shifts_converges_without_stress_to_compare_with() {
    let relaxed = solve(&shifted());
    assert!(relaxed.summary.steps < 2000, "{} steps", relaxed.summary.steps);
    let solved = solve_by(&shifted(), newton());
    let residual = solved.summary.newton.unwrap().residual;
    assert!(residual < 1e-6, "{residual:e}");
}

#[test]
fn a_static_problem_that_nothing_holds_against_its_loads_is_refused() {
    for motion in [relaxation(1e-4), newton()] {
        let mut problem = Problem { motion, ..square(5) };
        gravity(&mut problem, Vector3::new(0.0, -9.81, 0.0));
        problem.conditions.push(condition("side", face(0, 0.0), [Some(0.0), None, None]));
        let (_, model) = build(&problem);
        let run = simulate(&model, &problem.motion, &mut State::new(&model), &mut Unobserved);
        assert!(matches!(run, Err(Error::NothingHolds { axis: 'y', force }) if force < 0.0));
    }
}

#[test]
fn a_static_block_that_slides_away_is_reported_with_the_motion_that_nothing_prevents() {
    // On a floor without friction, pushed aside for ever.
    let mut problem = square(4);
    gravity(&mut problem, Vector3::new(0.5, -9.81, 0.0));
    problem.obstacles.push(floor(0.0, Vector3::y(), Friction::Frictionless));
    problem.motion = relaxation(1e-6);
    let (_, model) = build(&problem);
    let run = simulate(&model, &problem.motion, &mut State::new(&model), &mut Unobserved);
    assert!(matches!(run, Err(Error::NotHeld { free: 1, .. })), "{run:?}");
}

#[test]
fn a_relaxation_that_no_longer_gets_nearer_stops_before_its_last_step() {
    // Below round-off nothing improves.
    let problem = Problem { motion: relaxation(1e-18), ..leaning(square(4)) };
    let (_, model) = build(&problem);
    let run = simulate(&model, &problem.motion, &mut State::new(&model), &mut Unobserved);
    let Err(Error::NotConverged { steps, stalled: true, free: 0, .. }) = run else {
        panic!("{run:?}")
    };
    assert!(steps < 50_000, "{steps} steps");
}
