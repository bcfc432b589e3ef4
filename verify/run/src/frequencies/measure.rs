//! The lowest natural frequencies of the body of a case.

use crate::machine::cpu_seconds;
use crate::run::interrupted;
use mtled::Simulation;
use mtled::error::Error;
use mtled::frequencies::{MassKind, NaturalModes, body_at_rest};
use mtled::problem::{Cavity, Motion, Problem};
use mtled_case::scene::Case;

/// The natural frequencies of the body of a case.
#[derive(Debug)]
pub struct Found {
    /// The case.
    pub case: Case,
    /// The body without its loads and obstacles.
    pub simulation: Simulation,
    /// Rigid motions, frequencies and modes.
    pub modes: NaturalModes,
    /// The masses.
    pub masses: MassKind,
    /// What the case has and natural frequencies leave out, in words.
    pub left_out: Vec<&'static str>,
    /// Reasons to doubt the discretisation.
    pub doubts: Vec<String>,
    /// CPU time of the search without the set-up \[s\].
    pub cpu_s: f64,
}

/// Why there are none.
#[derive(Debug, thiserror::Error)]
pub enum Unfound {
    /// The case cannot be set up, or has not so many.
    #[error(transparent)]
    Solver(#[from] Error),
    /// The user.
    #[error("stopped")]
    Stopped,
}

/// Finds the `count` lowest ones. `notify` takes the number of those found so far.
pub fn find_modes(
    case: &Case,
    count: usize,
    masses: MassKind,
    notify: &dyn Fn(usize),
) -> Result<Found, Unfound> {
    let rest = body_at_rest(&case.problem);
    let simulation = Simulation::new(&rest)?;
    let cpu = cpu_seconds();
    let mut go_on = |found: usize| {
        notify(found);
        !interrupted()
    };
    let Simulation { discretisation, model, .. } = &simulation;
    let modes = NaturalModes::find(&rest, discretisation, model, (count, masses), &mut go_on)?;
    if modes.stopped {
        return Err(Unfound::Stopped);
    }
    let warnings = discretisation.warnings().into_iter().chain(model.warnings.clone());
    let doubts = warnings.map(|warning| warning.to_string()).collect();
    let left_out = left_out(&case.problem, masses);
    let (case, cpu_s) = (case.clone(), cpu_seconds() - cpu);
    Ok(Found { case, simulation, modes, masses, left_out, doubts, cpu_s })
}

/// What a problem has beside what natural frequencies depend on.
fn left_out(problem: &Problem, masses: MassKind) -> Vec<&'static str> {
    let loads = &problem.loads;
    let some_load =
        !loads.body_forces.is_empty() || !loads.tractions.is_empty() || !loads.pressures.is_empty();
    let is_filled =
        |cavity: &Cavity| cavity.fluid.as_ref().is_some_and(|fluid| fluid.inflow != 0.0);
    let scaled = matches!(&problem.motion, Motion::Dynamic { step, .. } if step.mass_scaling > 1.0);
    let damped = matches!(problem.motion, Motion::Dynamic { damping, .. } if damping > 0.0);
    let released = problem.conditions.iter().any(|condition| condition.release.is_some());
    let active = problem.regions.iter().any(|region| region.active.is_some());
    [
        (some_load, "loads are left out: the body is neither deformed nor stressed by them"),
        (loads.cavities.iter().any(is_filled), "inflows into cavities are left out"),
        (
            loads.cavities.iter().any(|cavity| cavity.fluid.is_some()),
            "fluids count with their stiffness, not with their mass",
        ),
        (!problem.obstacles.is_empty(), "obstacles and contact with them are left out"),
        (
            problem.has_memory(),
            "viscosity is left out: the stiffness is that against sudden strains",
        ),
        (active, "active tension is left out"),
        (damped, "damping is left out"),
        (scaled, "the masses are those of the body, without mass scaling"),
        (released, "conditions are those of t = 0, before any release"),
        (
            masses == MassKind::Lumped,
            "lumped masses make frequencies lower by about the square of the nodal spacing",
        ),
    ]
    .into_iter()
    .filter_map(|(has, text)| has.then_some(text))
    .collect()
}
