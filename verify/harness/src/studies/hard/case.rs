//! What a hard case is.
#![allow(non_snake_case)]

use crate::exact::homogeneous::uniaxial;
use crate::studies::hard::bodies::{on_rollers, relax_elongation};
use anyhow::{Context, Result};
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::problem::Problem;
use mtled_checks::study::Kind;

/// What the result of a run is compared with.
#[derive(Debug, Clone)]
pub(crate) enum Expected {
    /// The same right Cauchy–Green tensor C = FᵀF everywhere.
    Homogeneous(Matrix3),
    /// Vertical force \[N\] of the last condition.
    Force(f64),
    /// Moment about the vertical through the origin \[N·m\] of the last condition.
    Moment(f64),
    /// The vertical force of the same body on a finer cloud.
    Finer(Box<Problem>),
    /// The undeformed shape, C = I.
    Rest,
    /// A constant balance of all energies.
    Balance,
    /// Nothing.
    Unknown,
}

impl Expected {
    /// What the error of a case is measured against.
    pub(crate) fn label(&self) -> &'static str {
        match self {
            Expected::Homogeneous(_) => "uniaxial closed form, largest error of C",
            Expected::Force(_) => "reaction of three-field finite elements",
            Expected::Moment(_) => "moment of the incompressible closed form",
            Expected::Finer(_) => "reaction on a finer cloud",
            Expected::Rest => "undeformed shape, largest error of C",
            Expected::Balance => "energy balance, over the largest energy",
            Expected::Unknown => "–",
        }
    }
}

/// The bound on the error of a case.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Limit {
    /// From theory or a reference.
    Stated { kind: Kind, bound: f64, source: &'static str },
    /// Our own figure, with a remark.
    Stored(&'static str),
}

/// A hard problem, and what its solution is compared with.
#[derive(Debug, Clone)]
pub(crate) struct HardCase {
    pub id: &'static str,
    pub label: &'static str,
    pub problem: Problem,
    pub expected: Expected,
    pub limit: Option<Limit>,
    /// Known outcomes: "finite", or the names of errors.
    pub ends: &'static [&'static str],
    /// Whether the expected result is the only equilibrium; beyond buckling it is not.
    pub unique: bool,
    /// Shown in the table.
    pub remark: &'static str,
    /// Number of steps of a motion, whose duration then follows from the critical step at rest.
    pub steps: Option<usize>,
}

const UNIFORM: Limit = Limit::Stated {
    kind: Kind::Exact,
    bound: 1e-6,
    source: "Gradients consistent to round-off balance every uniform stress; ten times the \
             tolerance of the relaxation, 1e-7",
};

/// A case that is known to converge.
pub(crate) fn case(
    id: &'static str,
    label: &'static str,
    problem: Problem,
    expected: Expected,
) -> HardCase {
    let limit = match expected {
        Expected::Homogeneous(_) => Some(UNIFORM),
        _ => None,
    };
    HardCase {
        id,
        label,
        problem,
        expected,
        limit,
        ends: &["finite"],
        unique: true,
        remark: "",
        steps: None,
    }
}

/// A body of `height` \[m\] between rollers, elongated by a fraction of its height, and the expected
/// uniform C.
pub(crate) fn rolled(
    mut problem: Problem,
    height: f64,
    fraction: f64,
) -> Result<(Problem, Expected)> {
    let law = problem.regions[0].material.law;
    let state = uniaxial::uniaxial_stress(&law, 1.0 + fraction)
        .context("the lateral stretch has not converged")?;
    let lateral = state.lateral_stretch.powi(2);
    let C = Matrix3::from_diagonal(&Vector3::new(lateral, lateral, (1.0 + fraction).powi(2)));
    problem.conditions = on_rollers(height, fraction * height);
    problem.motion = relax_elongation(1e-7, fraction);
    Ok((problem, Expected::Homogeneous(C)))
}
