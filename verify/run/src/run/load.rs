//! Cases by their file or name, and errors of the solver as mistakes in them.

use super::memory::refuse_beyond_memory;
use anyhow::{Context, Result};
use mtled::error::Error;
use mtled::geometry::GeometryError;
use mtled_case::bundled::{CASES, no_such_case, unpack, unpack_label_maps_of};
use mtled_case::scene::{Case, Diagnostic, Override, one_error, parse_overridden, read_overridden};
use std::path::Path;

/// Reads a case file, or a bundled case by its name, with overrides. It fits into the memory.
pub fn load(case: &Path, overrides: &[Override]) -> Result<Case> {
    let case = read(case, overrides)?;
    ensure_fits(&case)?;
    Ok(case)
}

/// Refuses a case that needs more memory than is available, at a key of its file.
pub fn ensure_fits(case: &Case) -> Result<()> {
    match refuse_beyond_memory(case) {
        Ok(()) => Ok(()),
        Err(shortage) => {
            Err(one_error(vec![case.diagnostic("discretisation", shortage.to_string())]))
        }
    }
}

fn read(case: &Path, overrides: &[Override]) -> Result<Case> {
    let bundled = CASES.iter().find(|(name, _)| Path::new(name) == case);
    let absent = matches!(case.try_exists(), Ok(false));
    // A folder of that name is no case.
    match bundled.filter(|_| absent || case.is_dir()) {
        None if absent => {
            let file = case.display().to_string();
            let message = format!("cannot be read: {}", no_such_case(&file));
            Err(one_error(vec![Diagnostic::of_file(&file, message)]))
        }
        None => read_overridden(case, overrides).map_err(one_error),
        Some((name, text)) => {
            let folder = tempfile::tempdir().context("cannot make a folder for a bundled case")?;
            // An override may name any of the label maps.
            let cases = match overrides {
                [] => unpack_label_maps_of(text, folder.path())?,
                _ => unpack(folder.path())?,
            };
            parse_overridden(text, &format!("{name}.toml"), &cases, overrides).map_err(one_error)
        }
    }
}

/// An error of the solver, located at the key of the case file that causes it.
pub fn located(case: &Case, error: &Error) -> Diagnostic {
    let key = match error {
        Error::NothingHolds { .. } => "prescribe",
        Error::EmptySelection { name } => &format!("prescribe.{name}.where"),
        Error::BeyondData { name, .. } => &format!("prescribe.{name}.data"),
        Error::NoDisplacement { name, .. } => &format!("prescribe.{name}"),
        Error::ContradictingConditions { second, .. } => &format!("prescribe.{second}"),
        Error::DrivenIntoObstacle { condition, .. } => &format!("prescribe.{condition}"),
        Error::NodesInObstacle { name, .. }
        | Error::ObstacleInBody { name, .. }
        | Error::EmptyObstacle { name } => &format!("obstacle.{name}"),
        Error::EmptyInitialVelocity { index } => &format!("initial_velocity[{index}]"),
        Error::NoValue { what, index, .. } => &format!("{what}[{index}]"),
        Error::EmptyRegion { .. } => "probe",
        Error::EmptyTraction { name } => &format!("traction.{name}.where"),
        Error::EmptyBodyForce { index } | Error::SmallBodyForce { index, .. } => {
            &format!("body_force[{index}].where")
        }
        Error::EmptyPressure { name } => &format!("pressure.{name}.where"),
        Error::EmptySpring { name } => &format!("spring.{name}.where"),
        Error::ClosedCavity { name } => &format!("cavity.{name}.opening"),
        Error::EmptyCavity { name }
        | Error::OpenCavity { name, .. }
        | Error::NoCavity { name, .. } => &format!("cavity.{name}.where"),
        Error::DependentConstraints { .. } => "discretisation.enforcement",
        Error::NoQuadraturePoints | Error::UncoveredNode { .. } => "discretisation.grid",
        Error::DivergedCorrection { .. } | Error::TooFewPoints { .. } => "discretisation.grid",
        Error::ZeroEnergyModes { .. } => "discretisation.grid",
        Error::MasslessNode { .. } => "discretisation.mass",
        Error::SmallSupport { .. }
        | Error::SingularMomentMatrix { .. }
        | Error::LargeSupports { .. } => "discretisation.dilation",
        Error::UnstableStep { .. } => "time.fixed_step",
        Error::NoTimeStep { .. } | Error::NoDirection(_) | Error::MemoryToVary => "material",
        Error::TooMuchAddedMass { .. } | Error::UnscaledMass { .. } => "time.mass_scaling",
        Error::ProbeOutside { .. } => "probe",
        Error::PointWithoutRegion { .. } => "region",
        Error::Geometry(GeometryError::NoVolume) => "geometry.shape",
        Error::Geometry(_) => "discretisation",
        Error::NoEquilibrium { .. } | Error::NoEquilibriumToVary | Error::NoSensitivity { .. } => {
            "time.solver"
        }
        Error::NotUnloaded { .. } | Error::FoldedBody { .. } | Error::NoneUnloaded { .. } => {
            "geometry"
        }
        Error::HasRun { .. }
        | Error::StateOfAnother { .. }
        | Error::Diverged { .. }
        | Error::Inverted { .. }
        | Error::NotConverged { .. }
        | Error::Unstable { .. }
        | Error::NotHeld { .. }
        | Error::NeitherSolver { .. }
        | Error::FictitiousMass => "time",
        Error::Mistake(_) | Error::NoFrequencies | Error::TooManyFrequencies { .. } => {
            "discretisation"
        }
    };
    case.diagnostic(key, error.to_string() + &searched_elsewhere(case, error))
}

/// Where the body is, if a selection missed it.
fn searched_elsewhere(case: &Case, error: &Error) -> String {
    match error {
        Error::EmptySelection { .. }
        | Error::EmptyTraction { .. }
        | Error::EmptyPressure { .. }
        | Error::EmptySpring { .. }
        | Error::EmptyCavity { .. }
        | Error::EmptyBodyForce { .. }
        | Error::EmptyInitialVelocity { .. } => case.place(),
        _ => String::new(),
    }
}
