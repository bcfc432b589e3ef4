//! Sensitivities against differences of solutions.
#![allow(non_snake_case)]

use crate::common::statics::newton;
use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::error::Error;
use mtled::geometry::Shape;
use mtled::material::*;
use mtled::motion::observe::Unobserved;
use mtled::problem::*;
use mtled::{Answer, Simulation};

/// Step of a number over itself \[–\].
const STEP: f64 = 1e-4;
/// Difference between a sensitivity and the differences of two solutions, over the largest of its
/// kind \[–\].
const AGREEMENT: f64 = 1e-6;

/// Sets a number of a problem to so many times what it is.
type Number = fn(&mut Problem, f64);

const YOUNG: Number = |problem, factor| set_law(problem, 2e4 * factor, poisson(problem));
const POISSON: Number = |problem, factor| set_law(problem, 2e4, poisson(problem) * factor);
const TOP: Number = |problem, factor| {
    if let Prescribed::Displacement(values) = &mut problem.conditions[1].prescribed {
        values.iter_mut().flatten().for_each(|u| *u *= factor);
    }
};
const ANGLE: Number = |problem, factor| {
    if let Prescribed::Rotation { angle, .. } = &mut problem.conditions[1].prescribed {
        *angle *= factor;
    }
};
const DENSITY: Number = |problem, factor| problem.regions[0].material.density *= factor;
const PRESSURE: Number = |problem, factor| problem.loads.pressures[0].pressure *= factor;

fn poisson(problem: &Problem) -> f64 {
    problem.regions[0].material.law.constants().poisson_ratio()
}

fn set_law(problem: &mut Problem, young_modulus: f64, poisson_ratio: f64) {
    let constants = ElasticConstants::from_young_poisson(young_modulus, poisson_ratio).unwrap();
    let law = NeoHookeanIsochoric::new(constants, VolumetricTerm::Quadratic);
    problem.regions[0].material.law = Law::NeoHookeanIsochoric(law);
}

/// Clamped at its base, under its own weight, its top moved askew.
fn bent(mut problem: Problem, poisson_ratio: f64) -> Problem {
    set_law(&mut problem, 2e4, poisson_ratio);
    problem.motion = newton();
    problem.recipe.gradients = Gradients::Consistent { tolerance: 1e-6 };
    let up = problem.dimension.components() - 1;
    problem.conditions.push(condition("base", face(up, 0.0), [Some(0.0); 3]));
    let mut moved = [Some(0.01), Some(0.004), Some(-0.006)];
    moved[up] = Some(-0.012);
    problem.conditions.push(condition("top", face(up, EDGE), moved));
    gravity(&mut problem, Vector3::new(3.0, -4.0, 0.0));
    collocated(problem)
}

fn projected(mut problem: Problem) -> Problem {
    problem.recipe.volumetric_projection = VolumetricProjection::Patches;
    problem
}

fn turned(mut problem: Problem) -> Problem {
    let axis = Vector3::new(0.1, 0.2, 1.0).normalize();
    problem.conditions[1].prescribed =
        Prescribed::Rotation { point: Vector3::new(0.05, 0.05, 0.1), axis, angle: 0.2 };
    problem
}

fn blown(mut problem: Problem) -> Problem {
    problem.conditions.truncate(1);
    problem.loads.pressures.push(Pressure {
        name: "side".into(),
        part: face(0, 0.0),
        pressure: 1500.0,
        amplitude: Amplitude::Constant,
    });
    problem
}

/// Compressed between plates, under no load.
fn unloaded(mut problem: Problem) -> Problem {
    problem.loads.body_forces.clear();
    problem
}

/// Pressed upon a ball below its middle.
fn on_ball(mut problem: Problem) -> Problem {
    problem.conditions.remove(0);
    problem.loads.body_forces.clear();
    let below = Vector3::new(0.05, 0.05, -0.04);
    let ball = Shape::Ellipsoid { centre: below, radii: Vector3::repeat(0.0395) };
    problem.obstacles.push(obstacle(ball, ObstacleSide::Outside, Friction::Frictionless));
    if let Prescribed::Displacement(values) = &mut problem.conditions[0].prescribed {
        *values = [Some(0.0), Some(0.0), Some(-0.01)];
    }
    problem.conditions.insert(0, problem.conditions[0].clone());
    problem.conditions[0].name = "side".into();
    problem.conditions[0].part = face(0, 0.0);
    problem.conditions[0].prescribed = Prescribed::Displacement([Some(0.0), None, None]);
    problem
}

/// Values of `answers` at the end of a run, with their first-order changes along a number.
fn run(problem: &Problem, answers: &[Answer], number: Number) -> (Vec<f64>, Vec<f64>) {
    let mut simulation = Simulation::new(problem).unwrap();
    simulation.run(&mut Unobserved).unwrap();
    let mut adjoint = simulation.adjoint(answers).unwrap();
    let change = adjoint.change(&with(problem, number, -STEP), &with(problem, number, STEP));
    (adjoint.values(), change.unwrap().iter().map(|change| change / (2.0 * STEP)).collect())
}

fn with(problem: &Problem, number: Number, step: f64) -> Problem {
    let mut changed = problem.clone();
    number(&mut changed, 1.0 + step);
    changed
}

fn answers(problem: &Problem) -> Vec<Answer> {
    let simulation = Simulation::new(problem).unwrap();
    let place = Vector3::new(0.031, 0.062, 0.047);
    let place = match problem.dimension {
        Dimension::Three => place,
        Dimension::PlaneStrain { z, .. } => Vector3::new(place.x, place.y, z),
    };
    let rows = simulation.discretisation.rows_at(&[place]).unwrap();
    let weights: Vec<(u32, f64)> =
        rows.row(0).map(|entry| (rows.nodes[entry], rows.phi[entry])).collect();
    let (components, axis) = (0..problem.dimension.components(), |k| Vector3::ith(k, 1.0));
    let mut answers: Vec<Answer> = components
        .clone()
        .map(|k| Answer::Displacement { weights: weights.clone(), along: axis(k) })
        .collect();
    for condition in 0..problem.conditions.len() {
        answers.extend(components.clone().map(|k| Answer::Force { condition, along: axis(k) }));
        let about = Vector3::new(0.0, 0.01, 0.02);
        answers.push(Answer::Moment { condition, along: axis(2), about });
    }
    answers.push(Answer::StrainEnergy);
    answers
}

/// The largest difference between sensitivities and differences, over the largest of their kind.
fn disagreement(problem: &Problem, numbers: &[(&str, Number)]) -> Vec<(String, f64)> {
    let answers = answers(problem);
    let mut found = Vec::new();
    for (name, number) in numbers {
        let (_, slopes) = run(problem, &answers, *number);
        let value = |step: f64| {
            let changed = with(problem, *number, step);
            run(&changed, &answers, *number).0
        };
        let (up, down) = (value(STEP), value(-STEP));
        let differences: Vec<f64> =
            up.iter().zip(&down).map(|(up, down)| (up - down) / (2.0 * STEP)).collect();
        let kind = |answer: &Answer| std::mem::discriminant(answer);
        let worst = (0..answers.len()).map(|i| {
            let of_kind = (0..answers.len()).filter(|&j| kind(&answers[j]) == kind(&answers[i]));
            let scale = of_kind
                .fold(0.0f64, |most, j| most.max(differences[j].abs()).max(1e-3 * up[j].abs()));
            (slopes[i] - differences[i]).abs() / scale
        });
        found.push(((*name).to_string(), worst.fold(0.0, f64::max)));
    }
    found
}

fn agrees(problem: &Problem, numbers: &[(&str, Number)], bound: f64) {
    for (name, difference) in disagreement(problem, numbers) {
        assert!(difference < bound, "{name}: {difference:e}");
    }
}

const OF_MATERIAL: [(&str, Number); 3] =
    [("Young's modulus", YOUNG), ("Poisson's ratio", POISSON), ("density", DENSITY)];

#[test]
fn material_constants_weight_and_prescribed_values_change_answers_as_differences_say() {
    let problem = bent(jittered(cube(5), 0.2, 3), 0.3);
    agrees(&problem, &OF_MATERIAL, AGREEMENT);
    agrees(&problem, &[("top", TOP)], AGREEMENT);
}

#[test]
fn the_energy_of_a_body_without_loads_has_an_adjoint_of_0() {
    let problem = unloaded(bent(jittered(cube(5), 0.2, 3), 0.3));
    agrees(&problem, &[("Young's modulus", YOUNG), ("top", TOP)], AGREEMENT);
}

#[test]
fn the_angle_of_a_support_that_turns_counts_as_it_turns() {
    agrees(&turned(bent(jittered(cube(5), 0.2, 3), 0.3)), &[("angle", ANGLE)], AGREEMENT);
}

#[test]
fn in_a_plane_sensitivities_are_those_of_the_slice() {
    let problem = bent(jittered(square(8), 0.2, 3), 0.3);
    agrees(&problem, &OF_MATERIAL, AGREEMENT);
    agrees(&problem, &[("top", TOP)], AGREEMENT);
}

#[test]
fn near_incompressibility_the_pressures_of_patches_follow() {
    for poisson_ratio in [0.49, 0.4999] {
        let problem = projected(bent(jittered(cube(5), 0.2, 3), poisson_ratio));
        agrees(&problem, &[("top", TOP), ("Young's modulus", YOUNG)], AGREEMENT);
    }
}

#[test]
fn pressures_that_follow_a_face_with_a_free_rim_have_a_stiffness_that_is_not_symmetric() {
    agrees(
        &blown(bent(jittered(cube(5), 0.2, 3), 0.3)),
        &[("pressure", PRESSURE), ("Young's modulus", YOUNG)],
        AGREEMENT,
    );
}

#[test]
fn closed_contacts_stay_closed() {
    agrees(
        &on_ball(bent(jittered(cube(6), 0.2, 3), 0.3)),
        &[("top", TOP), ("Young's modulus", YOUNG)],
        1e-3,
    );
}

#[test]
fn motions_and_relaxation_have_no_equilibrium_to_vary() {
    let mut problem = bent(cube(4), 0.3);
    problem.motion = Motion::Dynamic { end: 1e-3, step: StepControl::default(), damping: 0.0 };
    let simulation = Simulation::new(&problem).unwrap();
    let refused = simulation.adjoint(&[Answer::StrainEnergy]).map(drop);
    assert!(matches!(refused, Err(Error::NoEquilibriumToVary)), "{refused:?}");
}
