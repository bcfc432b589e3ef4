//! Cases named on the command line, and their mistakes.

use crate::run::refuse_beyond_memory;
use crate::scene::{Case, Diagnostic, read_case};
use mtled::error::Error;
use std::path::Path;

/// Reads a case that fits into the memory; prints what is wrong otherwise.
pub fn load(file: &Path) -> Option<Case> {
    match read_case(file) {
        Ok(case) => fits(&case).then_some(case),
        Err(mistakes) => {
            mistakes.iter().for_each(|mistake| eprintln!("{mistake}"));
            None
        }
    }
}

fn fits(case: &Case) -> bool {
    let refused = refuse_beyond_memory(&case.problem).err();
    if let Some(shortage) = &refused {
        eprintln!("{}", case.diagnostic("discretisation", shortage.to_string()));
    }
    refused.is_none()
}

/// An error of the solver, located at the key of the case file that causes it.
pub fn diagnose(case: &Case, error: &Error) -> Diagnostic {
    let key = match error {
        Error::EmptySelection { name } => &format!("prescribe.{name}.where"),
        Error::EmptyTraction { name } => &format!("traction.{name}.where"),
        Error::DependentConstraints { .. } => "discretisation.enforcement",
        Error::NoQuadraturePoints
        | Error::UncoveredNode { .. }
        | Error::DivergedCorrection { .. }
        | Error::TooFewPoints { .. }
        | Error::ZeroEnergyModes { .. } => "discretisation.grid",
        Error::MasslessNode { .. } => "discretisation.mass",
        Error::SmallSupport { .. } | Error::SingularMomentMatrix { .. } => {
            "discretisation.dilation"
        }
        Error::UnstableStep { .. } => "time.fixed_step",
        Error::TooMuchAddedMass { .. } | Error::UnscaledMass { .. } => "time.mass_scaling",
        Error::ProbeOutside { .. } => "probe",
        Error::PointWithoutRegion { .. } => "region",
        Error::Geometry(_) => "discretisation",
        Error::ContactInNewton | Error::NoEquilibrium { .. } => "time.solver",
        Error::Diverged { .. }
        | Error::Inverted { .. }
        | Error::NotConverged { .. }
        | Error::FictitiousMass => "time",
    };
    case.diagnostic(key, error.to_string())
}
