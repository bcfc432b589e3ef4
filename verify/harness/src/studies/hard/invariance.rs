//! The same body in other units, translated and rotated has the same solution.
#![allow(non_snake_case)]

use crate::studies::hard::bodies::{SMOOTH, hard_recipe, rubber, turn};
use crate::studies::workbench::{Workbench, exact};
use anyhow::Result;
use mtled::Simulation;
use mtled::algebra::tensor::{Matrix3, Vector3, rotation};
use mtled::discretisation::Discretisation;
use mtled::discretisation::mls::Approximation;
use mtled::geometry::{Extent, Selector, Shape};
use mtled::model::Model;
use mtled::motion::observe::Unobserved;
use mtled::problem::{Dimension, EssentialCondition, Field, Prescribed, Problem};
use mtled_checks::measure::relative_max;
use mtled_checks::study::{Cell, Study, Table, number, text};
use mtled_run::run::integrate;
use mtled_run::specimens::simple::{SIZE, free_body, relaxation};

/// A change of unit and a translation: X → scale · X + offset.
#[derive(Debug, Clone, Copy)]
struct Frame {
    scale: f64,
    /// \[m\]
    offset: Vector3,
}

/// Bound on the difference of paired runs \[–\]. The relaxation stops at 1e-10, so they may differ
/// by round-off alone.
const ROUND_OFF: f64 = 1e-8;

/// Solves the block in every frame and compares the displacements.
pub(crate) fn invariance(bench: &Workbench, study: &mut Study) -> Result<()> {
    let home = Frame { scale: 1.0, offset: Vector3::zeros() };
    let problem_in = |frame| problem_in(frame, bench.seed(7));
    let base = problem_in(home)?;
    let solution = solve(Simulation::with_any_recipe(&base)?)?;
    let mut rows = Vec::new();
    let mut add = |id: &str, label: &str, paired: Vec<f64>| {
        let difference = relative_max(&paired, &solution);
        rows.push(vec![Cell::Text(label.into()), Cell::Number(difference)]);
        study.checks.push(exact(
            &format!("hard_cases/{id}"),
            &format!("{label}: largest change of the displacements over the largest displacement"),
            difference,
            ROUND_OFF,
            "The equations have no length scale, origin or direction; what remains is round-off, \
             1e-16 of the coordinates over the displacements, times the condition of the problem",
        ));
    };
    let far = Vector3::new(6.0, -7.0, 4.0);
    for (id, label, frame) in [
        ("micrometres", "lengths a million times smaller", Frame { scale: 1e-6, ..home }),
        ("kilometres", "lengths a hundred thousand times larger", Frame { scale: 1e5, ..home }),
        ("far_away", "10 m from the origin", Frame { offset: far, ..home }),
    ] {
        let problem = problem_in(frame)?;
        let u = solve(Simulation::with_any_recipe(&problem)?)?;
        add(id, label, u.iter().map(|u| u / frame.scale).collect());
    }
    let R = rotation(&(Vector3::new(1.0, 2.0, 3.0) / 14.0_f64.sqrt()), 1.1);
    let problem = rotated_conditions(&base, R);
    let discretisation = rotated(&Discretisation::new(&base)?, R);
    let model = Model::new(&problem, &discretisation)?;
    let u = solve(Simulation::of_parts(&problem, discretisation, model))?;
    add("turned", "everything rotated", rotated_field(&u, &R.transpose()));
    study.tables.push(Table {
        title: "Paired runs of a sheared and compressed block".into(),
        columns: vec![text("paired run"), number("relative difference of displacements", "1")],
        rows,
    });
    Ok(())
}

/// Corners of a block without equal edges \[m\]: where edges or diagonals are equal, round-off
/// chooses the panels of the boundary.
const OUTLINE: [[f64; 2]; 4] = [[-0.05, -0.045], [0.0465, -0.05], [0.05, 0.035], [-0.048, 0.0415]];

/// A jittered block, compressed by 20 % and sheared by 10 % between bonded faces, in a frame.
fn problem_in(frame: Frame, seed: u64) -> Result<Problem> {
    let Frame { scale, offset } = frame;
    let corner = |p: [f64; 2]| [scale * p[0] + offset.x, scale * p[1] + offset.y];
    let z = move |fraction: f64| scale * fraction * SIZE + offset.z;
    let points = OUTLINE.map(turn).map(corner).to_vec();
    let body = Shape::Polygon { points: points.into(), z: (z(0.0), z(1.0)) };
    let recipe = hard_recipe(scale * SIZE / 4.0, seed);
    let mut problem = free_body(Dimension::Three, body, rubber()?, recipe);
    let push = Vector3::new(0.1, 0.0, -0.2) * (scale * SIZE);
    let top = move |X: &Vector3| if X.z > z(0.5) { push } else { Vector3::zeros() };
    let face = |at: f64| Selector::Plane {
        point: Vector3::z() * z(at),
        normal: Vector3::z(),
        tolerance: 1e-6 * scale * SIZE,
    };
    problem.conditions = vec![EssentialCondition {
        name: "faces".into(),
        extent: Extent::Surface,
        part: Selector::Union(vec![face(0.0), face(1.0)]),
        prescribed: Prescribed::Field(Field::of(top)),
        amplitude: SMOOTH,
        release: None,
    }];
    problem.motion = relaxation(300, 1e-10);
    Ok(problem)
}

fn solve(simulation: Simulation) -> Result<Vec<f64>> {
    Ok(integrate(simulation, &mut Unobserved)?.simulation.state.displacement)
}

/// The conditions of a problem after X → R X.
fn rotated_conditions(problem: &Problem, R: Matrix3) -> Problem {
    let mut problem = problem.clone();
    for condition in &mut problem.conditions {
        if let Prescribed::Field(field) = condition.prescribed.clone() {
            let back = R.transpose();
            condition.prescribed = Prescribed::Field(Field::of(move |X| R * field.at(&(back * X))));
        }
        rotate_selector(&mut condition.part, &R);
    }
    problem
}

fn rotate_selector(part: &mut Selector, R: &Matrix3) {
    match part {
        Selector::Plane { point, normal, .. } => (*point, *normal) = (R * *point, R * *normal),
        Selector::Union(parts) => parts.iter_mut().for_each(|part| rotate_selector(part, R)),
        _ => {}
    }
}

/// Nodes, points, gradients and boundary after X → R X.
fn rotated(discretisation: &Discretisation, R: Matrix3) -> Discretisation {
    let mut rotated = discretisation.clone();
    let all = |vectors: &mut Vec<Vector3>| vectors.iter_mut().for_each(|X| *X = R * *X);
    all(&mut rotated.cloud.positions);
    all(&mut rotated.quadrature.positions);
    all(&mut rotated.supports.grad_phi);
    for panel in &mut rotated.surface.panels {
        (panel.centre, panel.normal) = (R * panel.centre, R * panel.normal);
    }
    let old = &discretisation.approximation;
    rotated.approximation = Approximation::new(
        rotated.cloud.positions.clone(),
        old.influence_radius.clone(),
        old.basis,
        old.weight_function,
        &discretisation.dimension,
    );
    rotated
}

fn rotated_field(u: &[f64], R: &Matrix3) -> Vec<f64> {
    let at = |u: &[f64]| <[f64; 3]>::from(R * Vector3::from_column_slice(u));
    u.chunks_exact(3).flat_map(at).collect()
}
