//! Static solutions of nearly incompressible bodies, whose pressures Newton's method has as
//! unknowns beside the displacements.
#![allow(non_snake_case)]

use crate::common::statics::*;
use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::force::{
    OwnPressures, Workspace, internal_force_with, linearise, linearised_stiffness_times,
};
use mtled::material::*;
use mtled::model::Model;
use mtled::motion::summary::{NewtonCounts, PatchPressures};
use mtled::problem::*;

/// Neo-Hookean with E = 3 kPa.
fn rubber(poisson_ratio: f64, volumetric: VolumetricTerm) -> Law {
    let constants = ElasticConstants::from_young_poisson(3000.0, poisson_ratio).unwrap();
    Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(constants, volumetric))
}

fn projected(mut problem: Problem, poisson_ratio: f64) -> Problem {
    problem.recipe.volumetric_projection = VolumetricProjection::Patches;
    collocated(with_law(problem, rubber(poisson_ratio, VolumetricTerm::Quadratic)))
}

/// Bonded to two plates, of which the upper one moves.
fn bonded(mut problem: Problem, moved: [Option<f64>; 3]) -> Problem {
    let up = problem.dimension.components() - 1;
    problem.conditions.push(condition("base", face(up, 0.0), [Some(0.0); 3]));
    let mut top = condition("top", face(up, EDGE), moved);
    top.amplitude = Amplitude::Linear { duration: 1.0 };
    problem.conditions.push(top);
    problem
}

/// Compressed by 20 %.
fn pressed(problem: Problem) -> Problem {
    bonded(problem, [Some(0.0), Some(0.0), Some(-0.2 * EDGE)])
}

fn to(tolerance: f64) -> Motion {
    Motion::Newton(Newton { load_end: 1.0, tolerance, ..Newton::default() })
}

fn counts(problem: &Problem, tolerance: f64) -> NewtonCounts {
    solve_by(problem, to(tolerance)).summary.newton.unwrap()
}

/// With the displacements alone as unknowns it took 31 and 92 corrections at ν = 0.499 and
/// 0.4999; a tangent that has the wrong pressures takes parts of the load and more than these.
#[test]
fn corrections_do_not_grow_with_the_bulk_modulus() {
    for poisson_ratio in [0.499, 0.4999, 0.499999, 0.4999999] {
        let counts = counts(&pressed(projected(cube(6), poisson_ratio)), 1e-6);
        assert!(
            counts.pressures == PatchPressures::Unknowns && counts.increments == 1,
            "{poisson_ratio}: {counts:?}"
        );
        assert!(counts.iterations <= 9 && counts.products <= 400, "{poisson_ratio}: {counts:?}");
        assert!(counts.residual <= 1e-6, "{poisson_ratio}: {counts:?}");
    }
}

#[test]
fn nothing_changes_up_to_a_poisson_ratio_of_0_49() {
    let counts = counts(&pressed(projected(cube(6), 0.49)), 1e-6);
    assert!(
        counts.pressures == PatchPressures::OfDisplacements && counts.increments == 1,
        "{counts:?}"
    );
}

/// The residual is that of the displacements alone, and relaxation knows nothing of pressures.
#[test]
fn the_solution_is_that_of_relaxation() {
    let pushed = |problem| bonded(problem, [Some(0.1 * EDGE), Some(-0.1 * EDGE), None]);
    for problem in [
        pushed(projected(jittered(square(8), 0.2, 1), 0.499)),
        pressed(projected(jittered(cube(4), 0.2, 1), 0.499)),
    ] {
        let exact = solve_by(&problem, to(1e-9));
        assert!(exact.summary.newton.unwrap().pressures == PatchPressures::Unknowns);
        let relaxed = solve_to(&problem, 1e-7);
        let error = difference(&relaxed.state.displacement, &exact.state.displacement);
        assert!(error <= 1e-6, "{error:e}");
        for (a, b) in relaxed.recorder.reactions.iter().zip(&exact.recorder.reactions) {
            let error = (a.force - b.force).norm() / b.force.norm();
            assert!(error < 1e-4, "{error:e}");
        }
    }
}

/// Between six smooth walls, of which the upper one has moved down by a part of the edge.
fn confined(problem: Problem, strain: f64) -> Problem {
    let mut problem = problem;
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        for at in [0.0, EDGE] {
            let mut held = [None; 3];
            held[axis] = Some(if axis == 2 { -strain * at } else { 0.0 });
            let mut wall = condition(&format!("{name}{at}"), face(axis, at), held);
            wall.amplitude = Amplitude::Linear { duration: 1.0 };
            problem.conditions.push(wall);
        }
    }
    problem
}

/// The volume is prescribed: the deformation is uniform, and P₃₃ = dψ/dJ of the law is known. Of
/// the linear one λ + 2 μ is off by less than twice the strain. What flowed between the nodes of
/// the walls took 17 % of the pressure at ν = 0.4999 and 75 % at 0.49999.
#[test]
fn a_confined_block_has_its_whole_bulk_modulus() {
    for (poisson_ratio, volumetric, strain) in [
        (0.49, VolumetricTerm::Quadratic, 0.0004),
        (0.499, VolumetricTerm::Quadratic, 0.0004),
        (0.4999, VolumetricTerm::SimoTaylor, 0.0004),
        (0.49999, VolumetricTerm::Quadratic, 0.0001),
    ] {
        let law = rubber(poisson_ratio, volumetric);
        let constants = law.constants();
        let mut problem = confined(with_law(projected(cube(4), poisson_ratio), law), strain);
        problem.recipe.gradients = Gradients::SecondOrder { tolerance: 1e-8 };
        let solved = solve_by(&problem, to(1e-8));
        let modulus = constants.lame_modulus() + 2.0 * constants.shear_modulus;
        let known = modulus * strain * EDGE * EDGE;
        let force = solved.recorder.reactions.last().unwrap().force.z;
        let counts = solved.summary.newton.unwrap();
        assert!((force.abs() / known - 1.0).abs() < 2.0 * strain, "{force} {known} {counts:?}");
    }
}

#[test]
fn a_soft_compressible_half_does_not_disturb_the_pressures_of_the_other() {
    let problem = pressed(with_stiff_half(projected(cube(6), 0.4999), neo_hookean(1000.0, 0.3)));
    let counts = counts(&problem, 1e-6);
    assert!(counts.pressures == PatchPressures::Unknowns && counts.increments == 1, "{counts:?}");
    assert!(counts.iterations <= 24, "{counts:?}");
}

/// Pressed against a wall by its own weight, with nothing else to hold it along the wall's normal.
#[test]
fn a_floating_body_comes_to_rest_on_a_floor_at_any_bulk_modulus() {
    let resting = |poisson_ratio| {
        let mut problem = projected(cube(4), poisson_ratio);
        for axis in [0, 1] {
            let mut held = [None; 3];
            held[axis] = Some(0.0);
            let name = ["x", "y"][axis];
            problem.conditions.push(condition(name, face(axis, 0.0), held));
        }
        gravity(&mut problem, Vector3::new(0.0, 0.0, -2.0));
        let up = Vector3::z();
        problem.obstacles = vec![floor(-0.001 * EDGE, up, Friction::Frictionless)];
        solve_by(&problem, to(1e-8))
    };
    let (known, solved) = (resting(0.49), resting(0.4999));
    let counts = solved.summary.newton.unwrap();
    assert!(counts.pressures == PatchPressures::Unknowns && counts.increments == 1, "{counts:?}");
    let weight = solved.model.lumped_mass.iter().sum::<f64>() * 2.0;
    let forces = &solved.state.contact.forces;
    let carried: f64 = forces.iter().map(|contact| contact.force.z).sum();
    assert!((carried / weight - 1.0).abs() < 1e-5, "{carried} {weight}");
    // E is the same; of ν the sinking depends little.
    let error = difference(&known.state.displacement, &solved.state.displacement);
    assert!(error < 0.1, "{error}");
}

/// K v of patches with pressures of their own.
fn product(model: &Model, u: &[f64], v: &[f64], own: &OwnPressures) -> Vec<f64> {
    let mut workspace = Workspace::new(&model.points);
    linearise(&model.points, u, &mut workspace);
    let mut product = vec![0.0; model.size()];
    linearised_stiffness_times(&model.points, v, Some(own), &mut workspace, &mut product);
    product
}

#[test]
fn the_tangent_is_the_derivative_of_the_force_whatever_the_pressures() {
    for volumetric in [VolumetricTerm::Quadratic, VolumetricTerm::SimoTaylor] {
        let problem = projected(jittered(cube(3), 0.2, 1), 0.4999);
        let (_, model) = build(&with_law(problem, rubber(0.4999, volumetric)));
        let (u, v) = (noise(&model, 1e-3 * EDGE, 1), noise(&model, 1e-3 * EDGE, 2));
        let mut workspace = Workspace::new(&model.points);
        let mut force = |step: f64, own: &OwnPressures| {
            let moved: Vec<f64> = u.iter().zip(&v).map(|(u, v)| u + step * v).collect();
            let mut f = vec![0.0; model.size()];
            internal_force_with(&model.points, &moved, Some(own), &mut workspace, &mut f);
            f
        };
        // Far from those that J gives, which are some thousand times as large.
        let own = OwnPressures::zero(&model.points, 30.0);
        let (ahead, back) = (force(1e-4, &own), force(-1e-4, &own));
        let slope: Vec<f64> = ahead.iter().zip(&back).map(|(a, b)| (a - b) / 2e-4).collect();
        let product = product(&model, &u, &v, &own);
        let error = difference(&product, &slope);
        assert!(error < 1e-6, "{error:e}");
    }
}

#[test]
fn the_tangent_with_pressures_is_symmetric() {
    let (_, model) = build(&projected(jittered(cube(3), 0.2, 1), 0.4999));
    let [u, v, w] = [1, 2, 3].map(|seed| noise(&model, 1e-3 * EDGE, seed));
    let own = OwnPressures::zero(&model.points, 30.0);
    let work = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let there = work(&w, &product(&model, &u, &v, &own));
    let back = work(&v, &product(&model, &u, &w, &own));
    assert!((there - back).abs() < 1e-11 * there.abs().max(back.abs()), "{there} {back}");
}

/// The pressures that J gives are those of the force without pressures of its own.
#[test]
fn pressures_taken_from_j_leave_the_force_as_it_is() {
    let (_, model) = build(&projected(jittered(cube(3), 0.2, 1), 0.4999));
    let u = noise(&model, 1e-3 * EDGE, 1);
    let (mut workspace, plain) = (Workspace::new(&model.points), forces(&model, &u));
    let mut f = vec![0.0; model.size()];
    let mut own = OwnPressures::zero(&model.points, 30.0);
    internal_force_with(&model.points, &u, Some(&own), &mut workspace, &mut f);
    assert!(difference(&f, &plain) > 0.1);
    own.set_values(&workspace.pressures_of_j());
    internal_force_with(&model.points, &u, Some(&own), &mut workspace, &mut f);
    assert!(difference(&f, &plain) < 1e-13);
}
