//! The parts of an error, and the run that shows each.

use crate::scene::{Case, Knob, Setting};
use crate::studies::workbench::spacing_of;
use mtled::problem::{Basis, Gradients, Motion, VolumetricProjection};

/// One part of the error.
#[derive(Debug, Clone)]
pub struct Part {
    pub name: &'static str,
    /// How it is estimated, in words.
    pub how: String,
    pub settings: Vec<Setting>,
    /// From the change that is seen to the error that is left: what a refinement by r
    /// leaves at order 1 is 1/(1 − 1/r) of the change.
    pub factor: f64,
}

/// Cells are made this many times smaller to see the quadrature.
const DENSER: f64 = 2.0;
/// Spacings are made this many times smaller to see the approximation.
const FINER: f64 = 1.5;

/// The parts that a case has.
pub fn parts(case: &Case) -> Vec<Part> {
    let recipe = &case.problem.recipe;
    let mut all = Vec::new();
    let mut add = |name, how: String, settings: Vec<Setting>, factor: f64| {
        all.push(Part { name, how, settings, factor });
    };
    if let Gradients::Consistent { tolerance } = recipe.gradients {
        add(
            "consistency",
            format!("gradients consistent to {:.0e} instead of {tolerance:.0e}", 1e-4 * tolerance),
            vec![Setting::number(Knob::GradientTolerance, 1e-4 * tolerance)],
            1.0,
        );
    } else {
        add(
            "consistency",
            "consistent gradients instead of plain ones".into(),
            vec![Setting::word(Knob::Gradients, "consistent")],
            1.0,
        );
    }
    if let Ok(spacing) = spacing_of(&case.problem) {
        let cells = spacing / recipe.grid.cell;
        add(
            "quadrature",
            format!("{:.3} cells per spacing instead of {cells:.3}", DENSER * cells),
            vec![Setting::number(Knob::CellsPerSpacing, DENSER * cells)],
            1.0,
        );
        add(
            "space",
            format!("all lengths of the recipe over {FINER}; what is left at order 1"),
            vec![Setting::word(Knob::Spacing, &format!("x{:.6}", 1.0 / FINER))],
            FINER / (FINER - 1.0),
        );
        if matches!(recipe.basis, Basis::Linear) {
            add(
                "basis",
                "quadratic basis instead of the linear one".into(),
                vec![Setting::word(Knob::Basis, "quadratic"), Setting::number(Knob::Dilation, 2.6)],
                1.0,
            );
        }
    }
    time(case, &mut add);
    let projected =
        case.problem.regions.iter().any(|region| region.material.law.projected_share() > 0.0);
    if recipe.volumetric_projection == VolumetricProjection::Patches && projected {
        add(
            "incompressibility",
            "J taken point by point: the locking that the projection avoids".into(),
            vec![Setting::word(Knob::VolumetricProjection, "none")],
            1.0,
        );
    }
    all
}

fn time(case: &Case, add: &mut impl FnMut(&'static str, String, Vec<Setting>, f64)) {
    match &case.problem.motion {
        Motion::Dynamic { step, .. } => add(
            "time",
            "half the step; what is left at order 1".into(),
            vec![Setting::number(Knob::SafetyFactor, 0.5 * step.safety_factor)],
            2.0,
        ),
        Motion::Static(_) if case.problem.obstacles.is_empty() => add(
            "time",
            "the equilibrium of the same discretisation by Newton's method".into(),
            vec![Setting::word(Knob::Solver, "newton")],
            1.0,
        ),
        Motion::Static(relaxation) => add(
            "time",
            format!(
                "relaxed to {:.0e} instead of {:.0e}",
                0.1 * relaxation.tolerance,
                relaxation.tolerance
            ),
            vec![Setting::number(Knob::Tolerance, 0.1 * relaxation.tolerance)],
            1.0,
        ),
        Motion::Equilibrium(newton) => add(
            "time",
            format!(
                "solved to {:.0e} instead of {:.0e}",
                1e-4 * newton.tolerance,
                newton.tolerance
            ),
            vec![Setting::number(Knob::Tolerance, (1e-4 * newton.tolerance).max(1e-12))],
            1.0,
        ),
    }
}
