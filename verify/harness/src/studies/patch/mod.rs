//! The affine patch test and what an affine field obeys exactly.
#![allow(non_snake_case)]

mod identities;
mod problem;

use crate::studies::patch::identities::identities;
use crate::studies::patch::problem::{Body, EXACT, JITTER, PatchRecipe, bodies, problem};
use crate::studies::workbench::{Workbench, exact};
use mtled::Simulation;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::Selector;
use mtled::motion::observe::Unobserved;
use mtled::problem::{Amplitude, Enforcement, Gradients, Problem, Traction};
use mtled_checks::measure::larger;
use mtled_checks::study::{Cell, Figure, Plot, Study, Table, axis, curve, number, text};
use mtled_run::accuracy::patch::{AffineField, affine_gradient};
use mtled_run::run::integrate;
use mtled_run::specimens::simple::{SIZE, relaxation};

/// Bounds where all of the boundary is prescribed, and where it is free under traction \[–\].
const BOUND: f64 = 1e-10;
const BOUND_FREE: f64 = 1e-9;

pub(crate) fn patch(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    for body in &bodies(bench)? {
        for poisson_ratio in [0.3, 0.49] {
            let case = format!("{}-nu{:.0}", body.name, 100.0 * poisson_ratio);
            identities(bench, study, body, &case, poisson_ratio)?;
            let mut worst = [0.0; 2];
            for seed in 0..bench.pick(1, 10) {
                let errors = solve(bench, body, poisson_ratio, &PatchRecipe { seed, ..EXACT })?;
                worst = [0, 1].map(|k| larger(worst[k], errors[k]));
            }
            static_checks(study, &case, worst);
        }
    }
    let cube = &bodies(bench)?[0];
    // Compressive dead loads would turn the body around, and hydrostatic ones above about 2μ let
    // it neck: a stretch between the two for each ν.
    for (poisson_ratio, stretch) in [(0.3, 0.015), (0.49, 0.0)] {
        let stretch = Matrix3::from_diagonal_element(stretch);
        let H = cube.field.H;
        let field = AffineField { H: 0.5 * (H + H.transpose()) + stretch, ..cube.field };
        let free = Body { field, ..cube.clone() };
        study.checks.push(exact(
            &format!("patch/free-cube-nu{:.0}/stretch", 100.0 * poisson_ratio),
            "largest error of the stretch of a free body under tractions on all faces",
            stretch_error(bench, poisson_ratio, &free)?,
            BOUND_FREE,
            "Consistent gradients: a uniform stress balances its tractions; round-off",
        ));
    }
    study.tables.push(recipes_table(bench, cube)?);
    study.figures.push(Figure::Plot(quadrature_figure(bench, cube)?));
    study.notes.push(
        "Plain gradients do not pass: shape functions of interior nodes do not vanish on the \
         boundary and the quadrature does not integrate their gradients exactly, so \
         Σ_q w_q Grad φ_a differs from ∮ φ_a N dA and forces act on interior nodes in a homogeneous \
         field. Consistent gradients remove them. Nodal parameters prescribed directly do not pass \
         either: the boundary integral also acts on interior nodes near the boundary, and only \
         forces on the displacement field, as collocation makes them, can balance that."
            .into(),
    );
    study.notes.push(format!(
        "All boundary nodes follow the affine displacement u = H (X − X_c), |H| = {:.3}; jitter \
         {JITTER}; 1.26 cells per spacing with volume fractions, so that the grid fits no face; \
         dynamic relaxation to 1e-12. At ν = 0.49 J is projected on patches.",
        affine_gradient(3).norm()
    ));
    Ok(())
}

/// Applies the tractions P N of the affine field to the faces of the cube; it is unconstrained, so
/// only its stretch is determined.
fn push_faces(problem: &mut Problem, body: &Body) {
    let law = problem.regions[0].material.law;
    let P = law.first_piola_kirchhoff(&(Matrix3::identity() + body.field.H));
    for axis in 0..3 {
        for (at, side) in [(0.0, -1.0), (SIZE, 1.0)] {
            let normal = Vector3::ith(axis, 1.0);
            problem.loads.tractions.push(Traction {
                name: format!("face {axis} at {at}"),
                part: Selector::Plane { point: normal * at, normal, tolerance: 1e-9 },
                traction: (P * (normal * side)).into(),
                amplitude: Amplitude::Smooth { duration: 1.0 },
            });
        }
    }
}

/// Largest error of C = FᵀF at any point over |H|: a free body may rotate.
fn stretch_error(bench: &Workbench, poisson_ratio: f64, body: &Body) -> anyhow::Result<f64> {
    let mut problem = problem(bench, body, poisson_ratio, &EXACT)?;
    push_faces(&mut problem, body);
    // An unconstrained body oscillates more.
    problem.motion = relaxation(1000, 1e-12);
    let simulation = Simulation::with_any_recipe(&problem)?;
    let solved = integrate(simulation, &mut Unobserved)?;
    let rows = &solved.simulation.discretisation.supports;
    let F = Matrix3::identity() + body.field.H;
    let error = |point: usize| {
        let computed = rows.deformation_gradient(point, &solved.simulation.state.displacement, 3);
        (computed.transpose() * computed - F.transpose() * F).norm() / body.field.H.norm()
    };
    Ok((0..rows.len()).map(error).fold(0.0, larger))
}

/// Errors of the displacement, of nodal parameters and of the field at all points, over the largest
/// displacement, and of its gradient over |H| \[–\].
fn solve(
    bench: &Workbench,
    body: &Body,
    poisson_ratio: f64,
    choice: &PatchRecipe,
) -> anyhow::Result<[f64; 2]> {
    let mut problem = problem(bench, body, poisson_ratio, choice)?;
    problem.conditions = vec![body.field.on_boundary()];
    let simulation = Simulation::with_any_recipe(&problem)?;
    let solved = integrate(simulation, &mut Unobserved)?;
    let errors = body.field.errors(&solved.simulation, &solved.simulation.state.displacement);
    let displacement = larger(errors.nodal, errors.displacement) / errors.largest_nodal;
    Ok([displacement, errors.gradient / body.field.H.norm()])
}

fn static_checks(study: &mut Study, case: &str, [displacement, gradient]: [f64; 2]) {
    let source =
        "Consistent gradients and collocation: an affine field is in equilibrium; round-off";
    for (quantity, value, bound) in [
        ("displacement", displacement, BOUND),
        // A gradient is a difference over a spacing, about a tenth of the body.
        ("gradient", gradient, 10.0 * BOUND),
    ] {
        let id = format!("patch/{case}/{quantity}");
        let label = format!(
            "largest error of the {quantity} in a static affine patch, all boundary nodes prescribed"
        );
        study.checks.push(exact(&id, &label, value, bound, source));
    }
}

/// Plain or consistent gradients, direct enforcement or collocation, on the jittered cube.
fn recipes_table(bench: &Workbench, cube: &Body) -> anyhow::Result<Table> {
    let mut rows = Vec::new();
    for poisson_ratio in [0.3, 0.49] {
        for (gradients, name) in [(Gradients::Plain, "plain"), (EXACT.gradients, "consistent")] {
            for (enforcement, how) in
                [(Enforcement::Direct, "direct"), (Enforcement::Collocation, "collocation")]
            {
                let choice = PatchRecipe { gradients, enforcement, ..EXACT };
                let [displacement, gradient] = solve(bench, cube, poisson_ratio, &choice)?;
                rows.push(vec![
                    Cell::Number(poisson_ratio),
                    Cell::Text(name.into()),
                    Cell::Text(how.into()),
                    Cell::Number(displacement),
                    Cell::Number(gradient),
                ]);
            }
        }
    }
    Ok(Table {
        title: "Largest errors on the jittered cube".into(),
        columns: vec![
            number("Poisson's ratio", "1"),
            text("gradients"),
            text("enforcement"),
            number("displacement", "1"),
            number("gradient", "1"),
        ],
        rows,
    })
}

/// More quadrature points do not make the error of plain gradients vanish.
fn quadrature_figure(bench: &Workbench, cube: &Body) -> anyhow::Result<Plot> {
    let mut series = Vec::new();
    for poisson_ratio in [0.3, 0.49] {
        let mut points = Vec::new();
        for cells_per_spacing in [1.26, 1.6, 2.0] {
            let gradients = Gradients::Plain;
            let choice = PatchRecipe { gradients, cells_per_spacing, ..EXACT };
            let [displacement, _] = solve(bench, cube, poisson_ratio, &choice)?;
            points.push((cells_per_spacing, displacement));
        }
        series.push(curve(&format!("ν = {poisson_ratio}"), points));
    }
    Ok(Plot {
        title: "Patch error of plain gradients against quadrature".into(),
        caption: "Jittered cube, collocation: largest error of the displacement. Smaller cells \
                  lower it but do not make it vanish."
            .into(),
        x: axis("cells per nodal spacing", "1", false),
        y: axis("relative error", "1", true),
        series,
        slopes: Vec::new(),
    })
}
