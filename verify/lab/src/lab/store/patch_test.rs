//! The affine patch test on the body and recipe of any case.
#![allow(non_snake_case)]

use super::record::Figures;
use mtled::Simulation;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::error::Error;
use mtled::motion::observe::Unobserved;
use mtled::problem::{Fibres, Loads, Motion, Newton, Problem, Region};
use mtled_run::accuracy::patch::{AffineField, affine_gradient};
use mtled_run::run::integrate;

/// The body and recipe of a case, all of its first material, whose whole boundary
/// follows u = H X, reached at t = 1 s.
pub(crate) fn with_affine_boundary(problem: &Problem, H: Matrix3) -> Problem {
    let mut problem = problem.clone();
    let Region { material, fibres, .. } = problem.regions[0].clone();
    for region in &mut problem.regions {
        region.material = material;
        // Fibres that turn from place to place do not keep an affine deformation.
        region.fibres = fibres
            .as_ref()
            .map(|_| Fibres { fibre: Vector3::x().into(), sheet: Some(Vector3::y().into()) });
    }
    problem.loads = Loads::default();
    problem.obstacles.clear();
    problem.conditions = vec![AffineField { H, centre: Vector3::zeros() }.on_boundary()];
    problem.motion =
        Motion::Newton(Newton { load_end: 1.0, tolerance: 1e-12, ..Newton::default() });
    problem
}

/// Largest errors of the displacement and its gradient at the quadrature points, over the
/// largest displacement and over |H| \[–\]: as small as the tolerance of consistent
/// gradients, some per cent with plain ones.
pub(crate) fn patch_errors(problem: &Problem) -> Result<Figures, Error> {
    let H = affine_gradient(problem.dimension.components());
    let problem = with_affine_boundary(problem, H);
    let simulation = Simulation::new(&problem)?;
    let solved = integrate(simulation, &mut Unobserved)?;
    let field = AffineField { H, centre: Vector3::zeros() };
    let errors = field.errors(&solved.simulation, &solved.simulation.state.displacement);
    Ok(Figures::from([
        ("patch_displacement_error".into(), errors.displacement / errors.largest),
        ("patch_gradient_error".into(), errors.gradient / H.norm()),
    ]))
}
