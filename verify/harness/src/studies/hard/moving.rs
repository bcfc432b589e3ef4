//! Hard cases of motion: sudden loads, and contact that is released.

use crate::studies::hard::bodies::{cube, face, rubber};
use crate::studies::hard::case::{Expected, HardCase, Limit, case};
use crate::studies::workbench::Workbench;
use anyhow::Result;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{Selector, Shape};
use mtled::problem::{Amplitude, BodyForce, Motion, Obstacle, Problem, StepControl};
use mtled_run::specimens::simple::SIZE;

/// Adds the cases to the list.
pub(crate) fn moving(bench: &Workbench, spacing: f64, list: &mut Vec<HardCase>) -> Result<()> {
    let resonates: &[&str] = &["finite", "Diverged", "Inverted"];
    for (id, label, safety_factor, ends, remark) in [
        (
            "sudden_08",
            "half gravity applied suddenly, no damping, 0.8 of the critical step",
            0.8,
            ["finite"].as_slice(),
            "",
        ),
        (
            "sudden_09",
            "half gravity applied suddenly, no damping, 0.9 of the critical step",
            0.9,
            resonates,
            "resonates with the step: it diverges after 39 558 of 100 000 steps",
        ),
    ] {
        list.push(HardCase {
            steps: Some(bench.pick(4_000, 100_000)),
            limit: Some(Limit::Stored("the target is 1 %")),
            ends,
            remark,
            ..case(id, label, sudden(safety_factor)?, Expected::Balance)
        });
    }
    let mut problem = pressed(spacing)?;
    let limit = Some(Limit::Stored(
        "1.9 s after the contact has ended: the law is elastic and the body returns to its undeformed \
         shape, as exp(−15 t/s) on most clouds, slower on five of 21",
    ));
    let label = "pressed against a ball by 30 % and taken away, damped";
    list.push(HardCase {
        limit,
        ..case("contact_release", label, problem.clone(), Expected::Rest)
    });
    // Released while pressed: the body rebounds.
    problem.conditions[0].release = Some(0.6);
    let step = StepControl { safety_factor: 0.8, ..StepControl::default() };
    problem.motion = Motion::Dynamic { end: 1.2, step, damping: 0.0 };
    list.push(HardCase {
        limit: Some(Limit::Stored("O(Δt²) in theory")),
        ..case("contact_let_go", "released while pressed, no damping", problem, Expected::Balance)
    });
    Ok(())
}

/// A bonded cube that starts at rest under a body force from the side.
fn sudden(safety_factor: f64) -> Result<Problem> {
    let mut problem = cube(rubber()?, SIZE / 4.0);
    problem.conditions = vec![face(0.0, [Some(0.0); 3], Amplitude::Constant)];
    problem.loads.body_forces = vec![BodyForce {
        part: Selector::All,
        acceleration: Vector3::new(5.0, 0.0, 0.0).into(),
        amplitude: Amplitude::Constant,
    }];
    let step = StepControl { safety_factor, ..StepControl::default() };
    problem.motion = Motion::Dynamic { end: 1.0, step, damping: 0.0 };
    Ok(problem)
}

/// A cube whose base lifts it by 30 % of its height against a fixed ball, 5 % of the height above
/// it, and lowers it again.
fn pressed(spacing: f64) -> Result<Problem> {
    let mut problem = cube(rubber()?, spacing);
    let there_and_back = Amplitude::Table(vec![(0.0, 0.0), (0.5, 1.0), (0.6, 1.0), (1.1, 0.0)]);
    let base = face(0.0, [Some(0.0), Some(0.0), Some(0.3 * SIZE)], there_and_back);
    problem.conditions = vec![base];
    problem.obstacles = vec![Obstacle::new(
        "ball",
        Shape::Sphere { centre: Vector3::z() * (1.5 * SIZE), radius: 0.45 * SIZE },
    )];
    let step = StepControl { safety_factor: 0.8, ..StepControl::default() };
    problem.motion = Motion::Dynamic { end: 3.0, step, damping: 30.0 };
    Ok(problem)
}
