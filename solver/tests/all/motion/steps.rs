//! Time integration against exact solutions and its theoretical order.
#![allow(non_snake_case)]

use crate::common::*;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::discretisation::{Discretisation, Warning};
use mtled::model::Model;
use mtled::motion::energy::{Energies, momenta};
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::problem::*;

fn run(model: &Model, motion: &Motion) -> State {
    let mut state = State::new(model);
    simulate(model, motion, &mut state, &mut Unobserved).unwrap();
    state
}

fn energies_of(model: &Model, motion: &Motion, mut state: State) -> Vec<Energies> {
    let mut recorder = Recorder::default();
    simulate(model, motion, &mut state, &mut recorder).unwrap();
    recorder.energies
}

/// Largest deviation of the balance from its value after the first step, over the
/// largest energy.
fn fluctuation(energies: &[Energies]) -> f64 {
    let start = energies[1].balance();
    let deviations = energies[1..].iter().map(|e| (e.balance() - start).abs());
    let sizes = energies.iter().flat_map(|e| [e.kinetic, e.strain, e.external_work.abs()]);
    deviations.fold(0.0, f64::max) / sizes.fold(0.0, f64::max)
}

#[test]
fn a_body_under_a_body_force_alone_falls_by_half_g_t_squared() {
    let g = Vector3::new(1.0, 2.0, -9.81);
    for mut problem in [jittered(cube(3), 0.2, 1), jittered(square(5), 0.2, 1)] {
        problem.recipe.mass = MassRule::MomentsOfFreeBodies;
        gravity(&mut problem, g);
        let (_, model) = build(&problem);
        let state = run(&model, &dynamic(0.2, 2e-3, 0.0));
        for node in 0..model.positions.len() {
            let exact = vector_at(&[g.x, g.y, g.z], 0, model.components) * (0.5 * 0.2 * 0.2);
            let u = state.displacement_of(node, model.components);
            assert!((u - exact).norm() < 1e-10 * exact.norm());
        }
    }
}

/// ∫ ρ X ⊗ X dV of a body at rest over its points and over its nodes.
fn second_moments(discretisation: &Discretisation, model: &Model, density: f64) -> [Matrix3; 2] {
    let square = |X: &Vector3, mass: f64| mass * X * X.transpose();
    let quadrature = &discretisation.quadrature;
    let points = quadrature.positions.iter().zip(&quadrature.weights);
    let nodes = model.positions.iter().zip(&model.lumped_mass);
    [points.map(|(X, w)| square(X, density * w)).sum(), nodes.map(|(X, m)| square(X, *m)).sum()]
}

/// Relative difference of the second moments of a motion with masses of this rule.
fn moments_off(problem: &Problem, rule: MassRule) -> f64 {
    let mut problem = problem.clone();
    problem.recipe.mass = rule;
    let density = problem.regions[0].material.density;
    let (discretisation, model) = build(&problem);
    let [points, nodes] = second_moments(&discretisation, &model, density);
    (points - nodes).norm() / points.norm()
}

#[test]
fn bodies_that_nothing_holds_have_their_moments_of_inertia() {
    for problem in [cube(5), jittered(cube(5), 0.3, 4), jittered(square(6), 0.3, 2)] {
        assert!(moments_off(&problem, MassRule::MomentsOfFreeBodies) < 1e-12);
        assert!(moments_off(&problem, MassRule::RowSum) > 0.01);
    }
}

#[test]
fn held_bodies_have_row_sums_unless_their_moments_are_asked_for() {
    let mut problem = cube(5);
    problem.conditions.push(condition("foot", face(2, 0.0), [Some(0.0); 3]));
    assert!(moments_off(&problem, MassRule::MomentsOfFreeBodies) > 0.01);
    assert!(moments_off(&problem, MassRule::Moments) < 1e-12);
    problem.conditions[0].release = Some(0.05);
    assert!(moments_off(&problem, MassRule::MomentsOfFreeBodies) < 1e-12);
}

#[test]
fn a_body_with_too_few_nodes_to_turn_as_it_should_says_so() {
    let few = |cells: usize| {
        let mut problem = cube(cells);
        problem.recipe.mass = MassRule::MomentsOfFreeBodies;
        let warnings = build(&problem).1.warnings;
        warnings.iter().any(|own| matches!(own, Warning::FewNodesToTurn { .. }))
    };
    assert!(few(1) && few(2));
    assert!(!few(6));
}

#[test]
fn with_evenly_split_masses_the_centre_of_mass_falls_by_half_g_t_squared() {
    let g = Vector3::new(0.0, 0.0, -9.81);
    let mut problem = jittered(cube(3), 0.2, 1);
    problem.recipe.mass = MassRule::EvenSplit;
    gravity(&mut problem, g);
    let (_, model) = build(&problem);
    let state = run(&model, &dynamic(0.2, 2e-3, 0.0));
    let exact = g * (0.5 * 0.2 * 0.2);
    assert!((mean_by_mass(&model, &state.displacement) - exact).norm() < 1e-10 * exact.norm());
}

#[test]
fn a_body_without_forces_keeps_its_velocity() {
    let velocity = Vector3::new(0.3, -0.2, 0.1);
    let mut problem = jittered(cube(3), 0.2, 2);
    problem.loads.initial_velocities.push((mtled::geometry::Selector::All, velocity.into()));
    let (_, model) = build(&problem);
    let state = run(&model, &dynamic(0.1, 2e-3, 0.0));
    for node in 0..model.positions.len() {
        assert!((state.displacement_of(node, 3) - velocity * 0.1).norm() < 1e-12);
    }
}

#[test]
fn damping_reduces_the_energy_of_a_rigid_motion_exponentially() {
    let mut problem = square(4);
    problem.loads.initial_velocities.push((mtled::geometry::Selector::All, Vector3::x().into()));
    let (_, model) = build(&problem);
    let (damping, end, time_step) = (4.0, 0.5, 2e-3);
    let energies = energies_of(&model, &dynamic(end, time_step, damping), State::new(&model));
    let (first, last) = (energies[0], energies[energies.len() - 1]);
    // Velocities are half a step behind; the scheme has an error of (αΔt)²/12 of αt.
    let exact = (-2.0 * damping * (end - 0.5 * time_step)).exp();
    assert!((last.kinetic / first.kinetic / exact - 1.0).abs() < 1e-4);
    assert!((last.kinetic + last.damping_loss - first.kinetic).abs() < 1e-12 * first.kinetic);
}

#[test]
fn a_free_body_vibrates_with_a_balance_whose_fluctuation_falls_with_the_step_squared() {
    let (_, model) = build(&jittered(cube(3), 0.2, 3));
    let deformed = || {
        let mut state = State::new(&model);
        state.displacement = field(&model, |x| Vector3::new(0.05 * x.x, -0.02 * x.y, 0.03 * x.x));
        state
    };
    let at = |fraction: f64| {
        let motion = dynamic(0.5, fraction * model.per_point_bound, 0.0);
        fluctuation(&energies_of(&model, &motion, deformed()))
    };
    let (coarse, fine) = (at(0.5), at(0.25));
    // Measured: 7.4e-3 and 1.9e-3.
    assert!(coarse < 0.02, "{coarse:e}");
    assert!((3.0..5.0).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
}

#[test]
fn without_conditions_and_contact_no_work_is_done_by_them() {
    let mut problem = square(5);
    gravity(&mut problem, Vector3::new(1.0, 0.0, 0.0));
    problem.loads.initial_velocities.push((face(0, 0.0), (Vector3::x() * 0.1).into()));
    let (_, model) = build(&problem);
    // With steps of changing size.
    let step = StepControl { reevaluate_every: 7, ..StepControl::default() };
    let motion = Motion::Dynamic { end: 0.1, step, damping: 1.0 };
    let energies = energies_of(&model, &motion, State::new(&model));
    for e in &energies {
        assert!(e.constraint_work.abs() < 1e-12 * (e.kinetic + e.strain), "{e:?}");
    }
}

#[test]
fn the_balance_holds_with_prescribed_motion_a_body_force_and_damping() {
    for problem in [jittered(cube(4), 0.2, 4), collocated(jittered(square(6), 0.2, 4))] {
        let mut problem = problem;
        let up = problem.dimension.components() - 1;
        problem.conditions.push(condition("base", face(up, 0.0), [Some(0.0); 3]));
        let mut values = [None; 3];
        values[up] = Some(0.2 * EDGE);
        let mut top = condition("top", face(up, EDGE), values);
        top.amplitude = Amplitude::Smooth { duration: 0.2 };
        problem.conditions.push(top);
        gravity(&mut problem, Vector3::new(3.0, -2.0, 1.0));
        let (_, model) = build(&problem);
        let motion = dynamic(0.4, 0.5 * model.per_point_bound, 3.0);
        let fluctuation = fluctuation(&energies_of(&model, &motion, State::new(&model)));
        // Measured: 1.6e-4.
        assert!(fluctuation < 1e-3, "{fluctuation:e}");
    }
}

#[test]
fn a_released_condition_constrains_no_longer() {
    let mut problem = square(6);
    let mut grip = condition("grip", face(1, EDGE), [Some(0.0); 3]);
    grip.release = Some(0.0505);
    problem.conditions.push(grip);
    gravity(&mut problem, Vector3::new(0.0, -9.81, 0.0));
    let (_, model) = build(&problem);
    let gripped: Vec<usize> =
        (0..model.positions.len()).filter(|&n| model.positions[n].y == EDGE).collect();
    let (mut state, mut speeds) = (State::new(&model), Vec::new());
    let mut observer = EachStep(|view: &mut mtled::motion::observe::View| {
        let moved = gripped.iter().any(|&n| view.state.displacement_of(n, 2) != Vector3::zeros());
        assert_eq!(moved, view.state.time > 0.0505, "t = {} s", view.state.time);
        if moved {
            speeds.push(mean_by_mass(&model, &view.state.velocity).y);
        }
    });
    simulate(&model, &dynamic(0.1, 1e-3, 0.0), &mut state, &mut observer).unwrap();
    // After the release the centre of mass falls freely.
    assert!(speeds.len() > 40);
    for pair in speeds.windows(2) {
        assert!((pair[1] - pair[0] + 9.81e-3).abs() < 1e-10, "{pair:?}");
    }
}

#[test]
fn prescribed_displacements_follow_their_tables() {
    let table = Amplitude::Table(vec![(0.01, 0.0), (0.05, 1.0), (0.07, -0.5)]);
    let mut problem = square(5);
    let mut top = condition("top", face(1, EDGE), [Some(0.004), None, None]);
    top.amplitude = table.clone();
    problem.conditions.push(top);
    let (_, model) = build(&problem);
    let node = model.positions.iter().position(|x| x.y == EDGE).unwrap();
    let mut observer = EachStep(|view: &mut mtled::motion::observe::View| {
        let u = view.state.displacement_of(node, 2).x;
        assert_eq!(u, 0.004 * table.at(view.state.time));
    });
    let mut state = State::new(&model);
    simulate(&model, &dynamic(0.1, 1e-3, 0.0), &mut state, &mut observer).unwrap();
}

#[test]
fn a_run_ends_exactly_at_its_end() {
    let (_, model) = build(&square(4));
    let motion = Motion::Dynamic { end: 0.0777, step: StepControl::default(), damping: 0.0 };
    let state = run(&model, &motion);
    assert!((state.time - 0.0777).abs() < 1e-15);
}

#[test]
fn a_body_that_is_held_whole_flies_on_from_its_release_with_its_speed() {
    let whole = |fixed| StepControl { fixed, ..StepControl::default() };
    for (release, step) in [(0.01, whole(None)), (0.1, whole(None)), (0.01, whole(Some(0.012)))] {
        let mut problem = cube(4);
        let mut kick = condition("kick", mtled::geometry::Selector::All, [Some(0.0); 3]);
        kick.extent = mtled::geometry::Extent::Volume;
        kick.prescribed = Prescribed::Displacement([Some(1.0), Some(0.0), Some(0.0)]);
        kick.amplitude = Amplitude::Linear { duration: 1.0 };
        kick.release = Some(release);
        problem.conditions.push(kick);
        let (_, model) = build(&problem);
        let state = run(&model, &Motion::Dynamic { end: 0.5, step, damping: 0.0 });
        for node in 0..model.positions.len() {
            let u = state.displacement_of(node, 3);
            assert!((u - 0.5 * Vector3::x()).norm() < 1e-9, "released at {release} s: {u:?}");
        }
    }
}

#[test]
fn a_spinning_body_keeps_its_momenta_while_it_stretches() {
    let mut problem = jittered(cube(4), 0.2, 5);
    let spin = |X: &Vector3| Vector3::new(0.3, 0.0, -0.1) + Vector3::new(2.0, -4.0, 9.0).cross(X);
    problem.loads.initial_velocities.push((mtled::geometry::Selector::All, Field::of(spin)));
    let (_, model) = build(&problem);
    let about = Vector3::new(0.1, 0.2, -0.3);
    let at = |end: f64| momenta(&model, &run(&model, &dynamic(end, 5e-4, 0.0)), &about);
    let (first, last) = (at(5e-4), at(0.25));
    let mass: f64 = model.inertia.iter().sum();
    let middle = spin(&Vector3::repeat(0.5 * EDGE)) * mass;
    assert!((first.linear - middle).norm() < 1e-3 * middle.norm(), "{first:?}");
    assert!((last.linear - first.linear).norm() < 1e-12 * first.linear.norm());
    assert!((last.angular - first.angular).norm() < 1e-12 * first.angular.norm(), "{last:?}");
}

#[test]
fn a_load_or_velocity_that_is_no_number_somewhere_is_refused_with_the_place() {
    let hole = || Field::of(|X| Vector3::x() * (X.x - 0.5 * EDGE).sqrt());
    let refusal = |change: &dyn Fn(&mut Loads)| {
        let mut problem = cube(3);
        change(&mut problem.loads);
        let discretisation = Discretisation::new(&problem).unwrap();
        Model::new(&problem, &discretisation).unwrap_err().to_string()
    };
    let all = mtled::geometry::Selector::All;
    let velocity = refusal(&|loads| loads.initial_velocities.push((all.clone(), hole())));
    assert!(velocity.contains("initial_velocity 0 is no number at (0"), "{velocity}");
    let amplitude = Amplitude::Constant;
    let force = refusal(&|loads| {
        let (part, amplitude) = (all.clone(), amplitude.clone());
        loads.body_forces.push(BodyForce { part, acceleration: hole(), amplitude });
    });
    assert!(force.contains("body_force 0 is no number at (0"), "{force}");
    let traction = refusal(&|loads| {
        let (name, part, amplitude) = ("side".into(), all.clone(), amplitude.clone());
        loads.tractions.push(Traction { name, part, traction: hole(), amplitude });
    });
    assert!(traction.contains("traction 0 is no number at (0"), "{traction}");
}
