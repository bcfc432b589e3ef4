//! Viscosity and active stress against closed forms.
#![allow(non_snake_case)]

use crate::common::statics::{Solved, solve_by};
use crate::common::*;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::error::Error;
use mtled::force::{Workspace, internal_force, potential_energy, stiffness_times, strain_energy};
use mtled::geometry::{Extent, Field, Selector};
use mtled::material::*;
use mtled::motion::state::State;
use mtled::problem::*;
use mtled::simulation::Simulation;

const TERMS: [PronyTerm; 2] = [PronyTerm { g: 0.45, tau: 0.5 }, PronyTerm { g: 0.365, tau: 5.0 }];

fn series() -> PronySeries {
    PronySeries::new(&TERMS).unwrap()
}

/// What is left of a sudden stress at time `t` \[s\].
fn left(t: f64) -> f64 {
    1.0 - TERMS.iter().map(|term| term.g * (1.0 - (-t / term.tau).exp())).sum::<f64>()
}

fn isochoric_neo_hookean() -> Law {
    Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(constants(), VolumetricTerm::Quadratic))
}

/// A viscous cube, all nodes of which follow a shear of 0.4 times `amplitude`.
fn sheared(law: Law, amplitude: Amplitude) -> Problem {
    let mut problem = with_law(cube(2), law);
    problem.regions[0].viscosity = Some(series());
    let mut shear = condition("shear", Selector::All, [None; 3]);
    shear.extent = Extent::Volume;
    // What is held for ever would not deform.
    shear.release = Some(1e9);
    shear.prescribed =
        Prescribed::Field(Field::of(|X: &Vector3| Vector3::new(0.4 * X.y, 0.0, 0.0)));
    shear.amplitude = amplitude;
    problem.conditions.push(shear);
    problem
}

/// Σ f·X of the forces that hold the top \[J\], the mean P₁₂ times the volume.
fn shear_stress(solved: &Solved) -> f64 {
    let Solved { model, state, .. } = solved;
    let mut force = vec![0.0; model.size()];
    internal_force(&model.points, &state.displacement, &mut state.workspace(model), &mut force);
    let moments = model.positions.iter().zip(force.chunks(3)).map(|(X, f)| f[0] * X.y);
    moments.sum::<f64>() / EDGE.powi(3)
}

/// Has the cube stand on its three faces through the origin, which slide.
fn stand(problem: &mut Problem) {
    for axis in 0..3 {
        let mut values = [None; 3];
        values[axis] = Some(0.0);
        problem.conditions.push(condition("symmetry", face(axis, 0.0), values));
    }
}

fn followed(end: f64, parts: usize) -> Motion {
    Motion::Newton(Newton { load_end: end, tolerance: 1e-10, parts })
}

#[test]
fn the_stress_of_a_sudden_strain_relaxes_as_the_series_says_whatever_the_parts() {
    for law in objective_laws().into_iter().filter(Law::is_split) {
        let problem = sheared(law, Amplitude::Constant);
        let sudden = shear_stress(&solve_by(&problem, followed(1e-9, 1)));
        for (end, parts) in [(0.3, 1), (0.3, 7), (8.0, 3)] {
            let stress = shear_stress(&solve_by(&problem, followed(end, parts)));
            // What does not relax is the pressure, which has no part in P₁₂ where J is 1.
            assert!(
                (stress / sudden / left(end) - 1.0).abs() < 1e-8,
                "{law:?}: {stress} of {sudden}"
            );
        }
    }
}

#[test]
fn the_stress_of_a_strain_that_grows_is_the_convolution_to_second_order() {
    let (law, end) = (isochoric_neo_hookean(), 2.0);
    let problem = sheared(law, Amplitude::Linear { duration: end });
    // S̄ of a shear γ, by parts so many that the sum is exact beside what is compared.
    let S = |gamma: f64| {
        let mut F = Matrix3::identity();
        F[(0, 1)] = 0.4 * gamma;
        F.try_inverse().unwrap() * law.first_piola_kirchhoff(&F)
    };
    let (count, mut sum) = (20_000, Matrix3::zeros());
    for n in 0..count {
        let [from, to] = [n as f64, n as f64 + 1.0].map(|n| n / count as f64);
        sum += (S(to) - S(from)) * left(end * (1.0 - 0.5 * (from + to)));
    }
    let mut F = Matrix3::identity();
    F[(0, 1)] = 0.4;
    let exact = (F * sum)[(0, 1)];
    let error = |parts| shear_stress(&solve_by(&problem, followed(end, parts))) / exact - 1.0;
    let (coarse, fine) = (error(8), error(16));
    assert!(fine.abs() < 1e-4, "{fine:e}");
    assert!((3.5..4.5).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
}

#[test]
fn a_dead_load_creeps_to_the_strain_of_what_is_left_of_the_stiffness() {
    let mut problem = with_law(cube(2), isochoric_neo_hookean());
    stand(&mut problem);
    let traction = Vector3::new(600.0, 0.0, 0.0);
    problem.loads.tractions.push(Traction {
        name: "pull".into(),
        part: face(0, EDGE),
        traction: traction.into(),
        amplitude: Amplitude::Constant,
    });
    let elongation = |problem: &Problem, motion| {
        let Solved { model, state, .. } = solve_by(problem, motion);
        state.displacement_of(model.positions.len() - 1, 3).x
    };
    let elastic = elongation(&problem, statics::newton());
    problem.regions[0].viscosity = Some(series());
    let sudden = elongation(&problem, followed(1e-6, 1));
    assert!((sudden / elastic - 1.0).abs() < 1e-5, "{sudden} {elastic}");
    let crept = elongation(&problem, followed(500.0, 60));
    // The law with what is left of its shear modulus, and all of its bulk modulus.
    let ElasticConstants { shear_modulus, bulk_modulus } = constants();
    let slow =
        ElasticConstants { shear_modulus: left(f64::INFINITY) * shear_modulus, bulk_modulus };
    problem.regions[0].viscosity = None;
    let term = VolumetricTerm::Quadratic;
    problem.regions[0].material.law =
        Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(slow, term));
    let slow = elongation(&problem, statics::newton());
    assert!((crept / slow - 1.0).abs() < 1e-4, "{crept} {slow}");
}

#[test]
fn what_is_released_goes_at_once_whatever_the_parts() {
    let mut problem = with_law(cube(2), isochoric_neo_hookean());
    stand(&mut problem);
    let mut top = condition("top", face(0, EDGE), [Some(0.03), None, None]);
    top.release = Some(1.0);
    problem.conditions.push(top);
    problem.regions[0].viscosity =
        Some(PronySeries::new(&[PronyTerm { g: 0.5, tau: 1.0 }]).unwrap());
    let left = |parts| {
        let Solved { model, state, .. } = solve_by(&problem, followed(1.0, parts));
        state.displacement_of(model.positions.len() - 1, 3).x
    };
    let (few, many) = (left(3), left(24));
    assert!(many > 0.001 && (few / many - 1.0).abs() < 2e-3, "{few} {many}");
}

#[test]
fn the_time_step_allows_for_the_tension_that_is_to_come() {
    let step = |tension: f64, amplitude| {
        let mut problem = pulling(isochoric_neo_hookean(), Vector3::x(), tension);
        problem.regions[0].active = Some(ActiveStress { tension, amplitude });
        solve_by(&problem, Motion::dynamic(1e-6, 0.0)).summary.critical_time_step
    };
    let ramp = || Amplitude::Linear { duration: 0.02 };
    let table = Amplitude::Table(vec![(0.0, 0.0), (1.0, 1.0), (2.0, 0.2)]);
    let whole = step(6e4, Amplitude::Constant);
    assert_eq!([step(6e4, ramp()), step(6e4, table)], [whole; 2]);
    assert!(whole < 0.5 * step(1.0, ramp()));
}

#[test]
fn works_close_the_balance_and_relaxation_takes_energy_from_a_slow_cycle() {
    let cycle = Amplitude::Table(vec![(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)]);
    let solved = solve_by(&sheared(isochoric_neo_hookean(), cycle), followed(2.0, 20));
    let work = solved.state.work;
    assert!(work.extra > 0.0);
    // All that the conditions have done is lost or in branches: the strain is gone.
    assert!((work.constraint / work.extra - 1.0).abs() < 1e-9, "{work:?}");
    let largest = strain_energy(
        &solved.model.points,
        &field(&solved.model, |X| Vector3::new(0.4 * X.y, 0.0, 0.0)),
    );
    assert!(work.extra > 0.05 * largest, "{} of {largest}", work.extra);
}

#[test]
fn a_viscous_motion_keeps_its_balance_and_loses_energy() {
    let mut problem = with_law(cube(4), isochoric_neo_hookean());
    problem.regions[0].viscosity =
        Some(PronySeries::new(&[PronyTerm { g: 0.5, tau: 0.01 }]).unwrap());
    problem.conditions.push(condition("base", face(2, 0.0), [Some(0.0); 3]));
    problem
        .loads
        .initial_velocities
        .push((Selector::All, Field::of(|X: &Vector3| Vector3::new(8.0 * X.z, 0.0, 0.0))));
    let balance = |fixed: f64| {
        let Solved { recorder, .. } = solve_by(&problem, dynamic(0.06, fixed, 0.0));
        let energies = recorder.energies;
        let start = energies[1].balance();
        let off = energies[1..].iter().map(|e| (e.balance() - start).abs()).fold(0.0, f64::max);
        (off / start, energies[energies.len() - 1].extra_work / start)
    };
    let ((coarse, lost), (fine, _)) = (balance(4e-4), balance(2e-4));
    assert!(lost > 0.05, "{lost}");
    assert!(fine < 0.01 && (3.0..5.0).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
}

/// A free cube with fibres along a direction that pull.
fn pulling(law: Law, direction: Vector3, tension: f64) -> Problem {
    let mut problem = cube(2);
    problem.regions[0].material = material(law);
    problem.regions[0].fibres = Some(Fibres { fibre: direction.into(), sheet: None });
    problem.regions[0].active =
        Some(ActiveStress { tension, amplitude: Amplitude::Linear { duration: 1.0 } });
    problem
}

#[test]
fn muscle_that_nothing_holds_shortens_until_its_law_balances_its_tension() {
    let guccione = Law::Guccione(isochoric(&[2000.0, 8.0, 2.0, 4.0]));
    for law in [isochoric_neo_hookean(), neo_hookean(3000.0, 0.3), guccione] {
        let mut problem = pulling(law, Vector3::x(), 900.0);
        stand(&mut problem);
        let mut simulation =
            Simulation::new(&Problem { motion: statics::newton(), ..problem }).unwrap();
        simulation.run(&mut mtled::Unobserved).unwrap();
        let corner = simulation.displacements_at(&[Vector3::repeat(EDGE)]).unwrap()[0];
        let F = Matrix3::from_diagonal(&(corner / EDGE + Vector3::repeat(1.0)));
        let P = law.first_piola_kirchhoff(&F)
            + F * Matrix3::from_diagonal(&Vector3::new(900.0, 0.0, 0.0));
        assert!(F[(0, 0)] < 0.97, "{F}");
        assert!(P.amax() < 1e-6 * 900.0, "{law:?}: {P}");
        let audit = simulation.audit().unwrap();
        assert!(!audit.rows.iter().any(|row| row.exceeds()), "{audit:?}");
        // The muscle has done what the strain energy holds.
        let energies = simulation.energies();
        assert!(energies.balance().abs() < 0.05 * energies.strain, "{energies:?}");
    }
}

#[test]
fn forces_with_extra_stresses_are_the_derivative_of_their_potential_and_have_a_symmetric_tangent() {
    let law = Law::Ogden(match ogden() {
        Law::Ogden(law) => law,
        _ => unreachable!(),
    });
    for dimension in [cube(2), square(3)] {
        let mut problem = with_law(jittered(dimension, 0.2, 3), law);
        problem.regions[0].fibres =
            Some(Fibres { fibre: Vector3::new(1.0, 2.0, 0.5).into(), sheet: None });
        problem.regions[0].viscosity = Some(series());
        problem.regions[0].active =
            Some(ActiveStress { tension: 400.0, amplitude: Amplitude::Constant });
        let (_, model) = build(&problem);
        let mut state = State::new(&model);
        state.displacement = noise(&model, 0.01, 5);
        // Remembered after a while at one state, then moved to another.
        let mut workspace = state.workspace(&model);
        let mut force = vec![0.0; model.size()];
        internal_force(&model.points, &state.displacement, &mut workspace, &mut force);
        state.extra.remember(&model, 0.0, &mut workspace);
        let mut workspace: Workspace = state.workspace(&model);
        let u = noise(&model, 0.01, 9);
        internal_force(&model.points, &u, &mut workspace, &mut force);
        let (v, w) = (noise(&model, 1.0, 11), noise(&model, 1.0, 13));
        let energy = |s: f64| {
            let moved: Vec<f64> = u.iter().zip(&v).map(|(u, v)| u + s * v).collect();
            potential_energy(&model.points, &moved, &workspace)
        };
        let slope = (energy(1e-6) - energy(-1e-6)) / 2e-6;
        let product: f64 = force.iter().zip(&v).map(|(f, v)| f * v).sum();
        assert!((product / slope - 1.0).abs() < 1e-6, "{product} {slope}");
        let mut times = |v: &[f64]| {
            let mut product = vec![0.0; model.size()];
            stiffness_times(&model.points, &u, v, &mut workspace, &mut product);
            product
        };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (one, other) = (dot(&times(&v), &w), dot(&times(&w), &v));
        assert!((one / other - 1.0).abs() < 1e-10, "{one} {other}");
    }
}

#[test]
fn what_a_memory_or_a_tension_cannot_belong_to_is_refused() {
    let refused = |problem: &Problem| match Simulation::new(problem) {
        Err(Error::Mistake(mistake)) => mistake.to_string(),
        other => panic!("{other:?}"),
    };
    let mut problem = cube(2);
    problem.regions[0].viscosity = Some(series());
    assert!(refused(&problem).starts_with("regions[0].viscosity relaxes"), "{}", refused(&problem));
    problem.regions[0].material.law = isochoric_neo_hookean();
    problem.motion = Motion::Relaxed(Relaxation::default());
    assert!(refused(&problem).starts_with("motion is by relaxation"), "{}", refused(&problem));
    problem.motion = followed(1.0, 0);
    assert!(refused(&problem).starts_with("motion.parts is 0"), "{}", refused(&problem));
    let mut problem = pulling(isochoric_neo_hookean(), Vector3::x(), f64::NAN);
    assert!(refused(&problem).starts_with("regions[0].active.tension is NaN"));
    problem.regions[0].fibres = None;
    assert!(refused(&problem).starts_with("regions[0].fibres is missing"));
}
