//! Identities of affine and rigid fields on any cloud, without a solution.
#![allow(non_snake_case)]

use crate::studies::patch::problem::{Body, EXACT, problem};
use crate::studies::workbench::{Workbench, exact};
use mtled::Simulation;
use mtled::algebra::random::Random;
use mtled::algebra::tensor::{Matrix3, Vector3, rotation};
use mtled::force::{Workspace, internal_force};
use mtled_checks::measure::larger;
use mtled_checks::study::Study;

/// Checks of the identities on one jittered body.
pub(crate) fn identities(
    bench: &Workbench,
    study: &mut Study,
    body: &Body,
    case: &str,
    poisson_ratio: f64,
) -> anyhow::Result<()> {
    let problem = problem(bench, body, poisson_ratio, &EXACT)?;
    let simulation = Simulation::with_any_recipe(&problem)?;
    let centre = body.field.centre;
    let stretched = field(&simulation, |X| body.field.displacement(X));
    let scale = forces(&simulation, &stretched).iter().map(|f| f.norm()).fold(0.0, larger);
    let turn = rotation(&Vector3::z(), 1.0) - Matrix3::identity();
    let turned = field(&simulation, |X| turn * (X - centre) + Vector3::new(0.3, -0.2, 0.0));
    let rigid = forces(&simulation, &turned).iter().map(|f| f.norm()).fold(0.0, larger);
    let (force, moment) = resultants(&simulation, body);
    let reproduction = "Linear reproduction: Σ φ_a,_j X_a,i = δ_ij";
    let balance = "Σ_a Grad φ_a = 0, and Σ_a x_a × P Grad φ_a = axial part of P Fᵀ = 0; round-off";
    let rows = [
        (
            "affine_gradient",
            "largest |F − (I + H)| of an affine field",
            uniformity(&simulation, &stretched, &body.field.H),
            1e-12,
            reproduction,
        ),
        (
            "rigid_force",
            "largest force in a rotation by 1 rad and a translation of 3.6 sizes, over that of the affine field",
            rigid / scale,
            1e-10,
            "A rigid motion causes no stress; round-off of F times (λ + 2μ)/μ",
        ),
        ("force", "sum of the internal forces over the sum of their sizes", force, 1e-12, balance),
        ("moment", "sum of the moments over the sum of their sizes", moment, 1e-12, balance),
    ];
    for (quantity, label, value, bound, source) in rows {
        study.checks.push(exact(&format!("patch/{case}/{quantity}"), label, value, bound, source));
    }
    Ok(())
}

/// Nodal parameters from a function of the reference position.
fn field(simulation: &Simulation, mut u: impl FnMut(&Vector3) -> Vector3) -> Vec<f64> {
    let model = &simulation.model;
    let values = model.positions.iter().flat_map(|X| {
        let value = u(X);
        (0..model.components).map(move |k| value[k])
    });
    values.collect()
}

fn forces(simulation: &Simulation, u: &[f64]) -> Vec<Vector3> {
    let model = &simulation.model;
    let mut f = vec![0.0; model.size()];
    internal_force(&model.points, u, &mut Workspace::new(&model.points), &mut f);
    f.chunks(model.components).map(vector).collect()
}

fn vector(components: &[f64]) -> Vector3 {
    Vector3::from_fn(|k, _| components.get(k).copied().unwrap_or(0.0))
}

/// Largest entry of F − (I + H) at any point \[–\].
fn uniformity(simulation: &Simulation, u: &[f64], H: &Matrix3) -> f64 {
    let rows = &simulation.discretisation.supports;
    let gradient = |i| rows.deformation_gradient(i, u, simulation.model.components);
    (0..rows.len()).map(|i| (gradient(i) - Matrix3::identity() - H).amax()).fold(0.0, larger)
}

/// Sums of the forces and of their moments about the centre, for random nodal
/// parameters of 5 % of the spacing, each over the sum of sizes \[–\].
fn resultants(simulation: &Simulation, body: &Body) -> (f64, f64) {
    let mut random = Random(7);
    let u =
        field(simulation, |_| random.vector(simulation.model.components) * (0.05 * body.spacing));
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    let (mut force_size, mut moment_size) = (0.0, 0.0);
    let displacements = u.chunks(simulation.model.components).map(vector);
    let positions = simulation.model.positions.iter().zip(displacements);
    for ((X, u), f) in positions.zip(forces(simulation, &u)) {
        let mut arm = X + u - body.field.centre;
        if simulation.model.components == 2 {
            arm.z = 0.0;
        }
        force += f;
        moment += arm.cross(&f);
        force_size += f.norm();
        moment_size += arm.norm() * f.norm();
    }
    (force.norm() / force_size, moment.norm() / moment_size)
}
