//! The parts of an error, and the run that shows each.

use mtled::problem::{Basis, Motion, VolumetricProjection};
use mtled_case::scene::{Case, Knob, Setting};

/// One part of the error.
#[derive(Debug, Clone)]
pub struct Part {
    /// Its name, such as "quadrature".
    pub name: &'static str,
    /// How it is estimated.
    pub how: String,
    /// Changes to the recipe of the case.
    pub settings: Vec<Setting>,
    /// Estimate of the part over the change of the solution: 1/(1 − 1/r) for a refinement by
    /// r at order 1 \[–\].
    pub factor: f64,
}

/// Refinement of the cells that shows the quadrature \[–\].
const DENSER: f64 = 2.0;
/// Refinement of the spacing that shows the approximation \[–\].
const FINER: f64 = 1.5;

/// The parts that a case has.
pub(crate) fn parts(case: &Case) -> Vec<Part> {
    let mut all = vec![consistency(case)];
    all.extend(space(case));
    all.push(time(case));
    all.extend(incompressibility(case));
    all
}

fn part(name: &'static str, how: String, settings: Vec<Setting>) -> Part {
    Part { name, how, settings, factor: 1.0 }
}

fn consistency(case: &Case) -> Part {
    let (how, setting) = match case.problem.recipe.gradients.tolerance() {
        Some(tolerance) => {
            let tighter = 1e-4 * tolerance;
            (
                format!("gradients consistent to {tighter:.0e} instead of {tolerance:.0e}"),
                Setting::number(Knob::GradientTolerance, tighter),
            )
        }
        None => (
            "consistent gradients instead of plain ones".into(),
            Setting::word(Knob::Gradients, "consistent"),
        ),
    };
    part("consistency", how, vec![setting])
}

fn space(case: &Case) -> Vec<Part> {
    let recipe = &case.problem.recipe;
    let Some(spacing) = recipe.spacing() else { return Vec::new() };
    let cells = spacing / recipe.grid.cell;
    let mut parts = vec![
        part(
            "quadrature",
            format!("{:.3} cells per spacing instead of {cells:.3}", DENSER * cells),
            vec![Setting::number(Knob::CellsPerSpacing, DENSER * cells)],
        ),
        Part {
            factor: FINER / (FINER - 1.0),
            ..part(
                "space",
                format!("all lengths of the recipe divided by {FINER}; remainder at order 1"),
                vec![Setting::word(Knob::Spacing, &format!("x{:.6}", 1.0 / FINER))],
            )
        },
    ];
    if matches!(recipe.basis, Basis::Linear) {
        parts.push(part(
            "basis",
            "quadratic basis instead of the linear one".into(),
            vec![Setting::word(Knob::Basis, "quadratic"), Setting::number(Knob::Dilation, 2.6)],
        ));
    }
    parts
}

fn time(case: &Case) -> Part {
    let tolerance = |tolerance: f64| vec![Setting::number(Knob::Tolerance, tolerance)];
    match &case.problem.motion {
        Motion::Dynamic { step, .. } => Part {
            factor: 2.0,
            ..part(
                "time",
                "half the time step; remainder at order 1".into(),
                vec![Setting::number(Knob::SafetyFactor, 0.5 * step.safety_factor)],
            )
        },
        Motion::Relaxed(_) if case.problem.obstacles.is_empty() => part(
            "time",
            "the equilibrium of the same discretisation by Newton's method".into(),
            vec![Setting::word(Knob::Solver, "newton")],
        ),
        Motion::Static(settings) if case.problem.by_newton() => {
            let (old, new) = (settings.tolerance, 1e-4 * settings.tolerance);
            part("time", format!("solved to {new:.0e} instead of {old:.0e}"), tolerance(new))
        }
        Motion::Static(relaxation) | Motion::Relaxed(relaxation) => {
            let (old, new) = (relaxation.tolerance, 0.1 * relaxation.tolerance);
            part("time", format!("relaxed to {new:.0e} instead of {old:.0e}"), tolerance(new))
        }
        Motion::Newton(newton) => {
            let (old, new) = (newton.tolerance, 1e-4 * newton.tolerance);
            let how = format!("solved to {new:.0e} instead of {old:.0e}");
            part("time", how, tolerance(new.max(1e-12)))
        }
    }
}

fn incompressibility(case: &Case) -> Option<Part> {
    let problem = &case.problem;
    let mut laws = problem.regions.iter().map(|region| region.material.law);
    let projected = problem.recipe.volumetric_projection == VolumetricProjection::Patches
        && laws.any(|law| law.projected_fraction() > 0.0);
    projected.then(|| {
        part(
            "incompressibility",
            "J at each point instead of its projection: the locking that the projection avoids"
                .into(),
            vec![Setting::word(Knob::VolumetricProjection, "none")],
        )
    })
}
