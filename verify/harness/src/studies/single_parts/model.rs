//! Lumped masses, amplitudes, the thickness of a slab, and NaN in the initial state.

use crate::studies::workbench::{Workbench, exact};
use anyhow::{Context, Result};
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::error::Error;
use mtled::geometry::Selector;
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::problem::{
    Amplitude, BodyForce, Dimension, MassRule, Motion, Problem, StepControl, Traction,
};
use mtled_checks::measure::larger;
use mtled_checks::study::Study;
use mtled_run::run::integrate;
use mtled_run::specimens::simple::{
    PLANE, SIZE, block_shape, bonded_face, free_body, recipe, relaxation, tissue,
};

/// A free jittered cube.
pub(crate) fn cube(bench: &Workbench) -> Result<Problem> {
    let recipe = recipe(SIZE / 5.0, 0.3, bench.seed(3));
    Ok(free_body(Dimension::Three, block_shape(), tissue(0.49)?, recipe))
}

/// Lumped masses add up to the body's; those of the row sum also have its centre.
pub(crate) fn masses(bench: &Workbench, study: &mut Study) -> Result<()> {
    for (rule, name) in [(MassRule::EvenSplit, "even_split"), (MassRule::RowSum, "row_sum")] {
        let mut problem = cube(bench)?;
        problem.recipe.mass = rule;
        problem.recipe.dilation = 2.0;
        let simulation = Simulation::with_any_recipe(&problem)?;
        let mass = problem.regions[0].material.density * SIZE.powi(3);
        let total: f64 = simulation.model.lumped_mass.iter().sum();
        study.checks.push(exact(
            &format!("parts/{name}/total"),
            "sum of the lumped masses against density times volume, relative error",
            (total / mass - 1.0).abs(),
            1e-12,
            "every point distributes all of its mass, and the weights sum to the volume",
        ));
        if rule == MassRule::RowSum {
            study.checks.push(exact(
                "parts/row_sum/centre",
                "centre of the lumped masses against that of the points, over the size",
                centre_error(&simulation),
                1e-12,
                "Σ_a m_a X_a = Σ_q ρ w_q Σ_a φ_a X_a, and linear fields are reproduced",
            ));
        }
    }
    Ok(())
}

fn centre_error(simulation: &Simulation) -> f64 {
    let centre = |positions: &[Vector3], masses: &[f64]| -> Vector3 {
        let sum: Vector3 = positions.iter().zip(masses).map(|(at, mass)| at * *mass).sum();
        sum / masses.iter().sum::<f64>()
    };
    let quadrature = &simulation.discretisation.quadrature;
    let points = centre(&quadrature.positions, &quadrature.weights);
    (centre(&simulation.model.positions, &simulation.model.lumped_mass) - points).norm() / SIZE
}

/// The smooth amplitude starts and ends without velocity and acceleration.
pub(crate) fn amplitude(study: &mut Study) {
    const S: f64 = 1e-3;
    let amplitude = Amplitude::Smooth { duration: 2.0 };
    let (start, end) = (amplitude.at(2.0 * S), 1.0 - amplitude.at(2.0 * (1.0 - S)));
    study.checks.push(exact(
        "parts/amplitude/ends",
        "change of the smooth amplitude within the first or the last thousandth s of its duration, \
         over s²",
        larger(start.abs(), end.abs()) / (S * S),
        20.0 * S,
        "10s³ − 15s⁴ + 6s⁵: no velocity and no acceleration at either end; 10 s remains",
    ));
    let halfway = [0.1, 0.3, 0.5].map(|s| amplitude.at(2.0 * s) + amplitude.at(2.0 * (1.0 - s)));
    study.checks.push(exact(
        "parts/amplitude/symmetry",
        "smooth amplitude at s and 1 − s, sum less one",
        halfway.iter().map(|sum| (sum - 1.0).abs()).fold(0.0, larger),
        1e-12,
        "10s³ − 15s⁴ + 6s⁵ is odd about its middle",
    ));
}

/// The reaction of a slab a fifth of a metre thick balances its load.
pub(crate) fn thickness(bench: &Workbench, study: &mut Study) -> Result<()> {
    const THICKNESS: f64 = 0.2;
    let (traction, acceleration) = (Vector3::new(20.0, -30.0, 0.0), Vector3::new(0.0, -0.5, 0.0));
    let recipe = recipe(SIZE / 8.0, 0.3, bench.seed(3));
    let Dimension::PlaneStrain { z, .. } = PLANE else {
        anyhow::bail!("PLANE is not plane strain")
    };
    let dimension = Dimension::PlaneStrain { thickness: THICKNESS, z };
    let mut problem = free_body(dimension, block_shape(), tissue(0.3)?, recipe);
    let amplitude = Amplitude::Smooth { duration: 1.0 };
    problem.conditions = vec![bonded_face(1, 0.0, 0.0, Amplitude::Constant)];
    let (point, normal) = (Vector3::y() * SIZE, Vector3::y());
    let part = Selector::Plane { point, normal, tolerance: 1e-9 };
    let name = "top".into();
    let pull = Traction { name, part, traction: traction.into(), amplitude: amplitude.clone() };
    problem.loads.tractions.push(pull);
    problem.loads.body_forces.push(BodyForce {
        part: Selector::All,
        acceleration: acceleration.into(),
        amplitude,
    });
    problem.motion = relaxation(400, 1e-8);
    let solved = integrate(Simulation::with_any_recipe(&problem)?, &mut Unobserved)?;
    let (model, state) = (&solved.simulation.model, &solved.simulation.state);
    let (forces, about) = (&state.constraint_forces, Vector3::zeros());
    let reactions = model.constraints.reactions(
        forces,
        state.force_factor,
        &about,
        &model.positions,
        &state.displacement,
    );
    let reaction = reactions.first().context("the slab has no condition")?.force;
    let density = problem.regions[0].material.density;
    let load = THICKNESS * (SIZE * traction + density * SIZE * SIZE * acceleration);
    study.checks.push(exact(
        "parts/slab/reaction",
        "slab in plane strain under traction and weight: reaction and load, sum over the load",
        (reaction + load).norm() / load.norm(),
        1e-6,
        "equilibrium of forces; ten times the tolerance of the relaxation on the residual",
    ));
    Ok(())
}

/// NaN in the initial displacement or velocity ends a run with an error.
pub(crate) fn not_a_number(bench: &Workbench, study: &mut Study) -> Result<()> {
    let mut problem = cube(bench)?;
    problem.conditions = vec![bonded_face(2, 0.0, 0.0, Amplitude::Constant)];
    let moving = |step| Motion::Dynamic { end: 0.01, step, damping: 0.0 };
    problem.motion = moving(StepControl::default());
    let model = Simulation::with_any_recipe(&problem)?.model;
    let fixed = StepControl { fixed: Some(0.5 * model.per_point_bound), ..StepControl::default() };
    let last = model.size() - 1;
    let mut undetected = 0;
    for motion in [problem.motion.clone(), moving(fixed)] {
        let mut pushed = State::new(&model);
        pushed.velocity[last] = f64::NAN;
        let mut displaced = State::new(&model);
        displaced.displacement[last] = f64::NAN;
        for mut state in [pushed, displaced] {
            let end = simulate(&model, &motion, &mut state, &mut Unobserved);
            undetected += usize::from(!matches!(end, Err(Error::Diverged { step: 0 | 1, .. })));
        }
    }
    study.checks.push(exact(
        "parts/not_a_number/unseen",
        "of four runs that start with NaN in a displacement or a velocity, those that do not end as \
         Diverged at the first step",
        undetected as f64,
        0.0,
        "NaN propagates through the body; no run may succeed with it",
    ));
    Ok(())
}
