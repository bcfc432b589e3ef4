//! `mtled case …`.

use crate::bundled::CASES;
use crate::cli::{COULD_NOT_RUN, print_data};
use crate::run::refuse_beyond_memory;
use crate::scene::{Case, Diagnostic, read_case, schema};
use anyhow::bail;
use clap::Subcommand;
use std::path::{Path, PathBuf};

#[derive(Debug, Subcommand)]
pub enum CaseCommand {
    /// Report the mistakes in case files with file, line and key.
    Check {
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
    /// List the cases that the program carries.
    List,
    /// Print a case that the program carries.
    Show { name: String },
    /// Print the JSON Schema of a case file.
    Schema,
}

pub fn case(command: &CaseCommand) -> anyhow::Result<u8> {
    match command {
        CaseCommand::Check { files } => check(files),
        CaseCommand::List => {
            print_data(&CASES.iter().map(|(name, _)| format!("{name}\n")).collect::<String>())?;
            Ok(0)
        }
        CaseCommand::Show { name } => match CASES.iter().find(|(carried, _)| carried == name) {
            Some((_, text)) => {
                print_data(text)?;
                Ok(0)
            }
            None => bail!("there is no case \"{name}\"; `mtled case list` names them"),
        },
        CaseCommand::Schema => {
            print_data(&format!("{}\n", schema()))?;
            Ok(0)
        }
    }
}

fn check(files: &[PathBuf]) -> anyhow::Result<u8> {
    let mut code = 0;
    for file in files {
        match load(file) {
            Some(case) if !fits(&case) => code = COULD_NOT_RUN,
            Some(case) => {
                // What only a discretisation can show: empty selections, poor supports.
                match crate::run::prepare_to_run(&case.problem) {
                    Ok(prepared) => {
                        print_data(&format!("{}: no mistakes\n", file.display()))?;
                        for warning in prepared.discretisation.warnings() {
                            eprintln!("{}: warning: {warning}", file.display());
                        }
                    }
                    Err(error) => {
                        eprintln!("{}", diagnose(&case, &error));
                        code = COULD_NOT_RUN;
                    }
                }
            }
            None => code = COULD_NOT_RUN,
        }
    }
    Ok(code)
}

/// Reads a case and prints its mistakes if it has any.
pub fn load(file: &Path) -> Option<Case> {
    match read_case(file) {
        Ok(case) => Some(case),
        Err(mistakes) => {
            mistakes.iter().for_each(|mistake| eprintln!("{mistake}"));
            None
        }
    }
}

/// Whether the machine has the memory for a case; says so if not.
pub fn fits(case: &Case) -> bool {
    let refused = refuse_beyond_memory(&case.problem).err();
    if let Some(shortage) = &refused {
        eprintln!("{}", case.diagnostic("discretisation", shortage.to_string()));
    }
    refused.is_none()
}

/// A solver error at the key of the case file that causes it.
pub fn diagnose(case: &Case, error: &mtled::error::Error) -> Diagnostic {
    use mtled::error::Error;
    let key = match error {
        Error::EmptySelection { name } => format!("prescribe.{name}.where"),
        Error::EmptyTraction { name } => format!("traction.{name}.where"),
        Error::DependentConstraints { .. } => "discretisation.enforcement".to_string(),
        Error::NoQuadraturePoints
        | Error::UncoveredNode { .. }
        | Error::DivergedCorrection { .. }
        | Error::TooFewPoints { .. }
        | Error::ZeroEnergyModes { .. } => "discretisation.grid".to_string(),
        Error::MasslessNode { .. } => "discretisation.mass".to_string(),
        Error::SmallSupport { .. } | Error::SingularMomentMatrix { .. } => {
            "discretisation.dilation".to_string()
        }
        Error::UnstableStep { .. } => "time.fixed_step".to_string(),
        Error::TooMuchAddedMass { .. } => "time.mass_scaling".to_string(),
        Error::ProbeOutside { .. } => "probe".to_string(),
        Error::PointWithoutRegion { .. } => "region".to_string(),
        Error::Geometry(_) => "discretisation".to_string(),
        Error::ContactInNewton | Error::NoEquilibrium { .. } => "time.solver".to_string(),
        Error::Diverged { .. }
        | Error::Inverted { .. }
        | Error::NotConverged { .. }
        | Error::FictitiousMass => "time".to_string(),
    };
    case.diagnostic(&key, error.to_string())
}
