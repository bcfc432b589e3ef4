//! Static contact without friction, by Newton's method and by relaxation: a sphere on a
//! half-space (Hertz), a block on a floor, a ball in a hollow one.
#![allow(non_snake_case)]

use super::results::Results;
use crate::exact::hertz;
use crate::studies::workbench::Workbench;
use anyhow::{Context, Result};
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{Extent, Selector, Shape};
use mtled::material::{ElasticConstants, Law, LinearElastic, Material};
use mtled::model::contact::ContactResult;
use mtled::motion::observe::Unobserved;
use mtled::problem::{
    Amplitude, BodyForce, Cloud, Dimension, EssentialCondition, Field, Gradients, Motion, Newton,
    Obstacle, ObstacleSide, Prescribed, Problem, Recipe, Refinement, Relaxation, defaults,
};
use mtled_run::run::{Solved, integrate};
use mtled_run::specimens::simple::{free_body, recipe, tissue};
use std::f64::consts::PI;

/// Radius of the rigid sphere \[m\].
const SPHERE: f64 = 0.5;
/// Radius of the contact by Hertz \[m\]; strains are of the order of its ratio to the sphere.
const CONTACT: f64 = 0.01;
/// Height and half of the width of the block that stands for the half-space \[m\].
const BLOCK: f64 = 0.08;
/// E \[Pa\] and ν \[–\] of the block.
const BLOCK_ELASTICITY: (f64, f64) = (3000.0, 0.3);
/// Edge of the block on the floor and diameter of the ball \[m\].
const SIZE: f64 = 0.1;
/// Acceleration of gravity \[m/s²\]: the block gives way by a few per cent.
const GRAVITY: f64 = 1.0;
/// Of the ball, which is heavy enough to rest on some fifty nodes \[m/s²\].
const BALL_GRAVITY: f64 = 3.0;
/// Bound on what balances exactly, for solutions to a tolerance of 1e-5 \[–\].
const BALANCE: f64 = 1e-3;

/// The ways to a static solution, with names for labels and keys.
fn solvers() -> [(&'static str, Motion); 2] {
    let relaxation = Relaxation { tolerance: 1e-5, ..Relaxation::default() };
    [
        ("newton", Motion::Newton(Newton { load_end: 1.0, tolerance: 1e-6, ..Newton::default() })),
        ("relaxation", Motion::Relaxed(relaxation)),
    ]
}

/// Checks of all three.
pub(crate) fn contact(bench: &Workbench, results: &mut Results) -> Result<()> {
    for (solver, motion) in solvers() {
        let relaxes = matches!(motion, Motion::Relaxed(_));
        let with = |problem: Problem| Problem { motion: motion.clone(), ..problem };
        block_on_floor(&with(resting_block(bench)?), solver, results)?;
        // In relaxation the ball rolls on its nodes for a hundred thousand steps.
        if bench.pick(!relaxes, true) {
            sphere_on_half_space(&with(hertz_problem(bench)?), solver, results)?;
            ball_in_ball(&with(ball(bench)?), solver, results)?;
        }
    }
    Ok(())
}

/// A body at rest and what its obstacle does.
struct Rest {
    solved: Solved,
    contact: ContactResult,
}

impl Rest {
    fn of(problem: &Problem) -> Result<Rest> {
        let solved = integrate(Simulation::with_any_recipe(problem)?, &mut Unobserved)?;
        let contact = solved.simulation.contact_results()?.into_iter().next();
        Ok(Rest { contact: contact.context("there is no obstacle")?, solved })
    }

    fn moved(&self, X: Vector3) -> Result<Vector3> {
        let rows = self.solved.simulation.discretisation.rows_at(&[X])?;
        Ok(rows.interpolate(0, &self.solved.simulation.state.displacement, 3))
    }

    fn weight(&self, gravity: f64) -> f64 {
        gravity * self.solved.simulation.model.lumped_mass.iter().sum::<f64>()
    }
}

/// A half-space is pressed against a fixed sphere by its far field, that of a point force.
fn hertz_problem(bench: &Workbench) -> Result<Problem> {
    let (young, poisson) = BLOCK_ELASTICITY;
    let constants = ElasticConstants::from_young_poisson(young, poisson)?;
    let law = Law::LinearElastic(LinearElastic::new(constants));
    let body = Shape::Box { min: Vector3::repeat(-BLOCK), max: Vector3::new(BLOCK, BLOCK, 0.0) };
    let spacing = bench.pick(CONTACT / 5.0, CONTACT / 7.0);
    let near = Shape::Sphere { centre: Vector3::zeros(), radius: 1.5 * CONTACT };
    let fine = Selector::Inside { shape: near, tolerance: 0.0 };
    let cloud = Cloud::Graded {
        spacing: 6.0 * spacing,
        refinements: vec![Refinement { part: fine, size: spacing }],
        growth: defaults::GROWTH,
        seed: bench.seed(1),
    };
    let mut recipe = Recipe { cloud, ..Recipe::with_spacing(6.0 * spacing) };
    recipe.grid.cells_per_spacing = Some(defaults::CELLS_PER_SPACING);
    let material = Material { density: 1000.0, law };
    let mut problem = free_body(Dimension::Three, body, material, recipe);
    let hertz = half_space();
    let approach = CONTACT * CONTACT / SPHERE;
    let far = Field::of(move |at| {
        Vector3::z() * approach + point_force(at, hertz.force(approach), young, poisson)
    });
    for (axis, end) in [(0, -BLOCK), (0, BLOCK), (1, -BLOCK), (1, BLOCK), (2, -BLOCK)] {
        problem.conditions.push(moved_face(axis, end, far.clone()));
    }
    let sphere = Shape::Sphere { centre: Vector3::z() * SPHERE, radius: SPHERE };
    problem.obstacles.push(obstacle("sphere", sphere, ObstacleSide::Outside));
    Ok(problem)
}

fn half_space() -> hertz::Contact {
    let (young, poisson) = BLOCK_ELASTICITY;
    hertz::Contact { relative_radius: SPHERE, contact_modulus: young / (1.0 - poisson * poisson) }
}

/// Displacement \[m\] of the half-space z ≤ 0 under a force \[N\] at the origin towards −z
/// (Boussinesq; Johnson 1985, eq. 3.18 and 3.19).
fn point_force(at: &Vector3, force: f64, young: f64, poisson: f64) -> Vector3 {
    let (depth, distance) = (-at.z, at.norm());
    let factor = force * (1.0 + poisson) / (2.0 * PI * young * distance);
    let outward = depth / distance.powi(2) - (1.0 - 2.0 * poisson) / (distance + depth);
    let sinking = depth * depth / distance.powi(2) + 2.0 * (1.0 - poisson);
    factor * Vector3::new(outward * at.x, outward * at.y, -sinking)
}

fn sphere_on_half_space(problem: &Problem, solver: &str, results: &mut Results) -> Result<()> {
    let rest = Rest::of(problem)?;
    let source = "Hertz 1882; Johnson 1985, section 4.2";
    results.value(
        (
            &format!("hertz/{solver}/force"),
            &format!("rigid sphere on a half-space, force ({solver})"),
            "N",
        ),
        (-rest.contact.force.z, half_space().force(CONTACT * CONTACT / SPHERE)),
        source,
    );
    Ok(())
}

/// A block on a floor, ν = 0: every line of it is a bar under its weight.
fn resting_block(bench: &Workbench) -> Result<Problem> {
    let half = Vector3::new(0.5 * SIZE, 0.5 * SIZE, 0.0);
    let body = Shape::Box { min: -half, max: half + Vector3::z() * SIZE };
    let constants = ElasticConstants::from_young_poisson(3000.0, 0.0)?;
    let law = Law::LinearElastic(LinearElastic::new(constants));
    let mut problem = free_body(
        Dimension::Three,
        body,
        Material { density: 1000.0, law },
        heavy(SIZE / 8.0, bench.seed(1)),
    );
    fall(&mut problem, GRAVITY);
    let max = Vector3::new(SIZE, SIZE, -0.01 * SIZE);
    let floor = Shape::Box { min: Vector3::new(-SIZE, -SIZE, -SIZE), max };
    problem.obstacles.push(obstacle("floor", floor, ObstacleSide::Outside));
    Ok(problem)
}

fn block_on_floor(problem: &Problem, solver: &str, results: &mut Results) -> Result<()> {
    let rest = Rest::of(problem)?;
    let sag = 1000.0 * GRAVITY * SIZE * SIZE / (2.0 * 3000.0);
    results.value(
        (
            &format!("resting_block/{solver}/sag"),
            &format!("block on a floor, sag of its top ({solver})"),
            "m",
        ),
        (-rest.moved(Vector3::z() * SIZE)?.z - 0.01 * SIZE, sag),
        "Timoshenko and Goodier, a bar under its own weight",
    );
    results.value(
        (
            &format!("resting_block/{solver}/area"),
            &format!("block on a floor, area of contact ({solver})"),
            "m²",
        ),
        (rest.contact.area, SIZE * SIZE),
        "its lower face",
    );
    balance(&rest, GRAVITY, ("resting_block", "block on a floor"), solver, results);
    Ok(())
}

/// A ball in a hollow one, a tenth wider, which it touches nowhere at first.
fn ball(bench: &Workbench) -> Result<Problem> {
    let centre = Vector3::zeros();
    let body = Shape::Sphere { centre, radius: 0.5 * SIZE };
    let mut problem =
        free_body(Dimension::Three, body, tissue(0.45)?, heavy(SIZE / 10.0, bench.seed(1)));
    fall(&mut problem, BALL_GRAVITY);
    let hollow = Shape::Sphere { centre, radius: 0.55 * SIZE };
    problem.obstacles.push(obstacle("hollow", hollow, ObstacleSide::Inside));
    Ok(problem)
}

fn ball_in_ball(problem: &Problem, solver: &str, results: &mut Results) -> Result<()> {
    let rest = Rest::of(problem)?;
    balance(&rest, BALL_GRAVITY, ("ball_in_ball", "ball in a hollow one"), solver, results);
    let centre = rest.moved(Vector3::zeros())?;
    results.relative(
        &format!("ball_in_ball/{solver}/aside"),
        &format!("ball in a hollow one, its centre aside over its way down ({solver})"),
        centre.xy().norm() / centre.z.abs(),
        super::results::BOUND,
        "symmetry",
    );
    Ok(())
}

/// What the obstacle exerts is the weight.
fn balance(
    rest: &Rest,
    gravity: f64,
    (id, label): (&str, &str),
    solver: &str,
    results: &mut Results,
) {
    let difference = rest.contact.force / rest.weight(gravity) - Vector3::z();
    results.relative(
        &format!("{id}/{solver}/force"),
        &format!("{label}, force of the obstacle less the weight, over the weight ({solver})"),
        difference.norm(),
        BALANCE,
        "balance of forces",
    );
}

fn heavy(spacing: f64, seed: u64) -> Recipe {
    Recipe { gradients: Gradients::Consistent { tolerance: 1e-6 }, ..recipe(spacing, 0.2, seed) }
}

fn fall(problem: &mut Problem, gravity: f64) {
    problem.loads.body_forces.push(BodyForce {
        part: Selector::All,
        acceleration: Vector3::new(0.0, 0.0, -gravity).into(),
        amplitude: Amplitude::Smooth { duration: 1.0 },
    });
}

fn obstacle(name: &str, shape: Shape, side: ObstacleSide) -> Obstacle {
    Obstacle { side, ..Obstacle::new(name, shape) }
}

fn moved_face(axis: usize, at: f64, field: Field) -> EssentialCondition {
    let normal = Vector3::ith(axis, 1.0);
    EssentialCondition {
        name: format!("{} = {at} m", ["x", "y", "z"][axis]),
        extent: Extent::Surface,
        part: Selector::Plane { point: normal * at, normal, tolerance: 1e-9 },
        prescribed: Prescribed::Field(field),
        amplitude: Amplitude::Smooth { duration: 1.0 },
        release: None,
    }
}
