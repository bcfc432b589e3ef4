//! `mtled case …`.

use super::common::{COULD_NOT_RUN, print_data};
use super::load::{diagnose, load};
use super::migrate::{MigrateArgs, migrate};
use crate::bundled::CASES;
use crate::run::prepare_to_run;
use crate::scene::schema;
use anyhow::{Result, bail};
use clap::Subcommand;
use std::path::{Path, PathBuf};

#[derive(Debug, Subcommand)]
pub enum CaseCommand {
    /// Report the mistakes in case files with file, line and key.
    Check {
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
    /// Update case files to the current names of keys and values.
    Migrate(MigrateArgs),
    /// List the bundled cases.
    List,
    /// Print a bundled case.
    Show { name: String },
    /// Print the JSON Schema of a case file.
    Schema,
}

pub fn case(command: &CaseCommand) -> Result<u8> {
    match command {
        CaseCommand::Check { files } => {
            let mut code = 0;
            for file in files {
                if !check(file)? {
                    code = COULD_NOT_RUN;
                }
            }
            return Ok(code);
        }
        CaseCommand::Migrate(arguments) => return migrate(arguments),
        CaseCommand::List => {
            print_data(&CASES.iter().map(|(name, _)| format!("{name}\n")).collect::<String>())?;
        }
        CaseCommand::Show { name } => match CASES.iter().find(|(bundled, _)| bundled == name) {
            Some((_, text)) => print_data(text)?,
            None => {
                bail!("there is no bundled case \"{name}\"; `mtled case list` prints their names")
            }
        },
        CaseCommand::Schema => print_data(&format!("{}\n", schema()))?,
    }
    Ok(0)
}

/// Whether a case file is free of mistakes; prints them otherwise. It is discretised, since
/// empty selections and poor supports show only then.
fn check(file: &Path) -> Result<bool> {
    let Some(case) = load(file) else { return Ok(false) };
    match prepare_to_run(&case.problem) {
        Ok(prepared) => {
            print_data(&format!("{}: no mistakes\n", file.display()))?;
            for warning in prepared.discretisation.warnings() {
                eprintln!("{}: warning: {warning}", file.display());
            }
            Ok(true)
        }
        Err(error) => {
            eprintln!("{}", diagnose(&case, &error));
            Ok(false)
        }
    }
}
