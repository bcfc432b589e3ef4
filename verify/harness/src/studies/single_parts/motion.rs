//! A single evaluation or a few steps: forces on several threads, prescribed displacements,
//! contact and damping.
#![allow(non_snake_case)]

use crate::studies::single_parts::model::cube;
use crate::studies::workbench::{Workbench, exact};
use anyhow::Result;
use mtled::Simulation;
use mtled::algebra::random::Random;
use mtled::algebra::tensor::Vector3;
use mtled::force::{Workspace, internal_force};
use mtled::geometry::{Selector, Shape};
use mtled::model::Model;
use mtled::model::contact::{ContactState, ContactStep};
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::problem::{
    Amplitude, BackgroundGrid, BodyForce, EssentialCondition, Motion, Obstacle, Prescribed,
    StepControl,
};
use mtled_checks::measure::larger;
use mtled_checks::study::Study;
use mtled_run::machine::on_threads;
use mtled_run::run::integrate;
use mtled_run::specimens::simple::{SIZE, bonded_face, recipe};

/// A step far below the critical one \[s\].
const STEP: f64 = 1e-6;

/// Forces do not depend on the threads, to the last bit.
pub(crate) fn threads(bench: &Workbench, study: &mut Study) -> Result<()> {
    let mut problem = cube(bench)?;
    problem.recipe = recipe(SIZE / 10.0, 0.3, bench.seed(3));
    problem.recipe.grid = BackgroundGrid::with_cell(SIZE / 20.0);
    let model = Simulation::with_any_recipe(&problem)?.model;
    anyhow::ensure!(
        model.points.blocks.len() > 4,
        "too few blocks to show a dependence on threads"
    );
    let mut random = Random(bench.seed(5));
    let u: Vec<f64> = (0..model.size()).map(|_| 1e-3 * SIZE * random.symmetric()).collect();
    let alone = force_on(1, &model, &u)?;
    let together = force_on(3, &model, &u)?;
    let differing = alone.iter().zip(&together).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
    study.checks.push(exact(
        "parts/threads/force",
        "components of the internal force that differ on three threads from one",
        differing as f64,
        0.0,
        "blocks do not depend on the threads and are summed in a fixed order",
    ));
    Ok(())
}

fn force_on(threads: usize, model: &Model, u: &[f64]) -> Result<Vec<f64>> {
    Ok(on_threads(threads, || {
        let mut f = vec![0.0; u.len()];
        internal_force(&model.points, u, &mut Workspace::new(&model.points), &mut f);
        f
    })?)
}

/// A component that is prescribed alone has its value after one step.
pub(crate) fn components(bench: &Workbench, study: &mut Study) -> Result<()> {
    const MOVED: f64 = 1e-3 * SIZE;
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let mut problem = cube(bench)?;
        let mut alone = [None; 3];
        alone[k] = Some(MOVED);
        let face = bonded_face(k, 0.0, 0.0, Amplitude::Constant);
        problem.conditions =
            vec![EssentialCondition { prescribed: Prescribed::Displacement(alone), ..face }];
        problem.motion = steps(1, 0.0);
        let solved = integrate(Simulation::with_any_recipe(&problem)?, &mut Unobserved)?;
        let at: Vec<Vector3> =
            solved.simulation.model.positions.iter().copied().filter(|X| X[k] == 0.0).collect();
        let rows = solved.simulation.discretisation.rows_at(&at)?;
        let u = &solved.simulation.state.displacement;
        let miss = |q: usize| {
            let there: f64 =
                rows.row(q).map(|e| rows.phi[e] * u[3 * rows.nodes[e] as usize + k]).sum();
            (there / MOVED - 1.0).abs()
        };
        study.checks.push(exact(
            &format!("parts/held/{axis}"),
            &format!("displacement along {axis} on a face that is moved along {axis} alone, over the prescribed one, less one"),
            (0..at.len()).map(miss).fold(if at.is_empty() { f64::NAN } else { 0.0 }, larger),
            1e-9,
            "collocation enforces prescribed displacements at the nodes",
        ));
    }
    Ok(())
}

/// Contact moves nodes that have entered an obstacle to its surface.
pub(crate) fn contact(bench: &Workbench, study: &mut Study) -> Result<()> {
    const DEPTH: f64 = 0.02 * SIZE;
    let mut problem = cube(bench)?;
    let centre = Vector3::new(0.5 * SIZE, 0.5 * SIZE, -SIZE + DEPTH);
    problem.obstacles.push(Obstacle::new("ball", Shape::Sphere { centre, radius: SIZE }));
    problem.motion = steps(1, 0.0);
    let model = Simulation::with_any_recipe(&problem)?.model;
    let mut contact = ContactState::default();
    let mut u = vec![0.0; model.size()];
    let mut velocity = vec![0.0; model.size()];
    let (displacement, velocity) = (&mut u[..], &mut velocity[..]);
    let (mass, times) = (&model.inertia, (0.0, 1.0));
    let step = ContactStep { mass, displacement, velocity, times, time_step: 1.0, growth: 1.0 };
    contact.enforce(&model.contact, &model.positions, 0.0, step);
    let obstacle = model.contact.placed(0, 1.0);
    let position = |node: usize| {
        model.positions[node] + Vector3::from_column_slice(&u[3 * node..3 * node + 3])
    };
    let inside = |node: usize| (-obstacle.gap(&position(node))).max(0.0);
    let touching = contact.touching.len();
    let deepest = (0..model.positions.len()).map(inside).fold(0.0, larger);
    study.checks.push(exact(
        "parts/contact/depth",
        "penetration of a cube's nodes into a ball after contact, over that before",
        if touching > 0 { deepest / DEPTH } else { f64::NAN },
        1e-9,
        "a node that has entered moves to the nearest point of the surface",
    ));
    Ok(())
}

/// A falling free body reaches the speed at which damping balances its weight.
pub(crate) fn damping(bench: &Workbench, study: &mut Study) -> Result<()> {
    const STEPS: usize = 60;
    let mut problem = cube(bench)?;
    let (acceleration, amplitude) = (Vector3::new(0.0, 0.0, -9.81), Amplitude::Constant);
    problem.loads.body_forces.push(BodyForce {
        part: Selector::All,
        acceleration: acceleration.into(),
        amplitude,
    });
    let damping = 1.0 / STEP;
    problem.motion = steps(STEPS, damping);
    let model = Simulation::with_any_recipe(&problem)?.model;
    let mut state = State::new(&model);
    simulate(&model, &problem.motion, &mut state, &mut Unobserved)?;
    let terminal = acceleration.z / damping;
    let masses = || model.lumped_mass.iter();
    let momentum: f64 = masses().enumerate().map(|(a, m)| m * state.velocity[3 * a + 2]).sum();
    let speed = momentum / masses().sum::<f64>();
    study.checks.push(exact(
        "parts/damping/terminal_speed",
        "mean speed of a damped body after 60 steps of free fall, over g/α, less one, at αΔt = 1",
        (speed / terminal - 1.0).abs(),
        1e-6,
        "M α v = M g in the steady state; a third of the difference remains after each step",
    ));
    Ok(())
}

fn steps(count: usize, damping: f64) -> Motion {
    let step = StepControl { fixed: Some(STEP), ..StepControl::default() };
    Motion::Dynamic { end: count as f64 * STEP, step, damping }
}
