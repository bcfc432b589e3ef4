//! Affine fields on the body and recipe of any case: the patch test.
#![allow(non_snake_case)]

use crate::run::{march, prepare_to_run};
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::error::Error;
use mtled::geometry::selection::{Extent, Selector};
use mtled::motion::observe::Unobserved;
use mtled::problem::{
    Amplitude, EssentialCondition, Field, Loads, Motion, Newton, Prescribed, Problem,
};
use std::collections::BTreeMap;

/// Stretch, contraction and shear of about 10 %, not symmetric.
fn shear(components: usize) -> Matrix3 {
    let mut H = Matrix3::new(0.08, 0.03, 0.01, 0.02, -0.05, 0.03, -0.01, 0.02, -0.02);
    if components == 2 {
        H.fill_row(2, 0.0);
        H.fill_column(2, 0.0);
    }
    H
}

/// The body and recipe of a case with nothing but u = H X on the whole boundary at
/// t = 1 s, all of its first material.
pub fn held_affinely(problem: &Problem, H: Matrix3) -> Problem {
    let mut problem = problem.clone();
    let material = problem.regions[0].material;
    problem.regions.iter_mut().for_each(|region| region.material = material);
    problem.loads = Loads::default();
    problem.obstacles.clear();
    problem.conditions = vec![EssentialCondition {
        name: "boundary".into(),
        extent: Extent::Surface,
        part: Selector::All,
        prescribed: Prescribed::Field(Field::of(move |X| H * X)),
        amplitude: Amplitude::Smooth { duration: 1.0 },
        release: None,
    }];
    problem.motion = Motion::Equilibrium(Newton { load_end: 1.0, tolerance: 1e-12 });
    problem
}

/// Largest errors of field and gradient where the whole boundary of the case's body
/// follows an affine field: relative to the largest displacement and to |H| \[–\]. With
/// consistent gradients both are as large as their tolerance lets them be; without,
/// percents.
pub fn patch_errors(problem: &Problem) -> Result<BTreeMap<String, f64>, Error> {
    let components = problem.dimension.components();
    let H = shear(components);
    let problem = held_affinely(problem, H);
    let prepared = prepare_to_run(&problem)?;
    let solved = march(&problem, prepared, &mut Unobserved)?;
    let (rows, u) = (&solved.prepared.discretisation.supports, &solved.state.displacement);
    let (mut field, mut gradient, mut largest) = (0.0f64, 0.0f64, 0.0f64);
    for (point, X) in solved.prepared.discretisation.quadrature.positions.iter().enumerate() {
        let mut exact: Vector3 = H * X;
        (components..3).for_each(|axis| exact[axis] = 0.0);
        largest = largest.max(exact.norm());
        field = field.max((rows.interpolate(point, u, components) - exact).norm());
        let F = rows.deformation_gradient(point, u, components);
        gradient = gradient.max((F - Matrix3::identity() - H).norm());
    }
    Ok(BTreeMap::from([
        ("patch_displacement_error".into(), field / largest),
        ("patch_gradient_error".into(), gradient / H.norm()),
    ]))
}
