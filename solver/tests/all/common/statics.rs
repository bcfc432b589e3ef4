//! Static problems and their solution by any method.

use super::*;
use mtled::audit::{Kind, audit};
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::motion::summary::Summary;

pub const TOLERANCE: f64 = 1e-5;

pub fn relaxation(tolerance: f64) -> Motion {
    Motion::Relaxed(Relaxation {
        load_end: 1.0,
        load_steps: 200,
        tolerance,
        max_steps: 50_000,
        step: StepControl::default(),
        mass: RelaxationMass::default(),
        ..Relaxation::default()
    })
}

pub fn newton() -> Motion {
    Motion::Newton(Newton { load_end: 1.0, tolerance: 1e-10, ..Newton::default() })
}
pub struct Solved {
    pub discretisation: Discretisation,
    pub model: Model,
    pub state: State,
    pub recorder: Recorder,
    pub summary: Summary,
}

pub fn solve(problem: &Problem) -> Solved {
    solve_to(problem, TOLERANCE)
}

pub fn solve_to(problem: &Problem, tolerance: f64) -> Solved {
    solve_by(problem, relaxation(tolerance))
}

pub fn solve_by(problem: &Problem, motion: Motion) -> Solved {
    let problem = Problem { motion, ..problem.clone() };
    let (discretisation, model) = build(&problem);
    let (mut state, mut recorder) = (State::new(&model), Recorder::default());
    let summary = simulate(&model, &problem.motion, &mut state, &mut recorder).unwrap();
    Solved { discretisation, model, state, recorder, summary }
}

/// What the audit doubts of a solution as one of this problem.
pub fn doubts(problem: &Problem, solved: &Solved) -> Vec<Kind> {
    let Solved { discretisation, model, state, .. } = solved;
    let table = audit(problem, discretisation, model, state).unwrap();
    table.doubts().map(|row| row.kind).collect()
}

/// Largest difference over the largest displacement.
pub fn difference(u: &[f64], v: &[f64]) -> f64 {
    u.iter().zip(v).fold(0.0f64, |a, (u, v)| a.max((u - v).abs())) / largest(v)
}
/// Clamped at its base, its top displaced sideways, under its own weight.
pub fn leaning(problem: Problem) -> Problem {
    let mut problem = problem;
    let up = problem.dimension.components() - 1;
    problem.conditions.push(condition("base", face(up, 0.0), [Some(0.0); 3]));
    let mut top = condition("top", face(up, EDGE), [Some(0.15 * EDGE), Some(0.05 * EDGE), None]);
    top.amplitude = Amplitude::Linear { duration: 1.0 };
    problem.conditions.push(top);
    let mut down = Vector3::zeros();
    down[up] = -2.0;
    gravity(&mut problem, down);
    problem
}
